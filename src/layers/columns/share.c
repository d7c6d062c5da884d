/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sharing one copy of the layers between the ranks of a node. */
#include "layers/columns/share.h"

#include <assert.h>
#include <string.h>

struct array {
  void **at;
  size_t bytes;
};

enum { N_ARRAY = 13 };

/* Lists all arrays; the counts in *l must be set. */
static void list_arrays(struct vg_layers *l, struct array a[N_ARRAY])
{
  struct vg_columns *c = &l->columns;
  struct vg_front *f = &l->front;
  const struct array list[N_ARRAY] = {
    { (void **)&c->column, c->n_column * sizeof *c->column },
    { (void **)&c->face, c->n_face * sizeof *c->face },
    { (void **)&c->face_tri, c->n_face * sizeof *c->face_tri },
    { (void **)&c->border, c->n_border * sizeof *c->border },
    { (void **)&c->border_patch, c->n_border * sizeof *c->border_patch },
    { (void **)&c->law, c->n_law * sizeof *c->law },
    { (void **)&c->path, c->n_path * sizeof *c->path },
    { (void **)&c->is_twin, c->n_twin },
    { (void **)&f->x, f->n_point * sizeof *f->x },
    { (void **)&f->id, f->n_point * sizeof *f->id },
    { (void **)&f->face, f->n_face * sizeof *f->face },
    { (void **)&f->patch, f->n_face * sizeof *f->patch },
    { (void **)&f->face_id, f->n_face * sizeof *f->face_id }
  };

  memcpy(a, list, sizeof list);
}

void vg_layers_show(const struct vg_layers *layers,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user)
{
  assert(layers && look);

  struct vg_layers view = *layers;
  struct array a[N_ARRAY];

  list_arrays(&view, a);
  for (int i = 0; i < N_ARRAY; i++) look(user, a[i].bytes, *a[i].at);
}

/* Lists the struct with its counts, then its arrays. */
static void list_parts(struct vg_layers *l, struct vg_bytes part[1 + N_ARRAY])
{
  struct array a[N_ARRAY];

  list_arrays(l, a);
  part[0] = (struct vg_bytes){ sizeof *l, (unsigned char *)l };
  for (int i = 0; i < N_ARRAY; i++)
    part[1 + i] = (struct vg_bytes){ a[i].bytes, *a[i].at };
}

vg_status vg_layers_share(struct vg_comm *c, struct vg_layers *layers,
                          struct vg_error *err)
{
  struct vg_bytes part[1 + N_ARRAY];
  struct vg_layers view;
  struct array a[N_ARRAY];
  struct vg_shmem common;
  unsigned char *at;
  vg_status st;

  if (vg_comm_node_size(c) == 1) return VG_OK;
  list_parts(layers, part);
  st = vg_comm_node_memory(c, 1 + N_ARRAY, part, 1, &common, err);
  if (st < 0) return st;
  at = (unsigned char *)(uintptr_t)common.data;
  memcpy(&view, at, sizeof view);
  at += vg_shmem_padded(sizeof view);
  list_arrays(&view, a);
  for (int i = 0; i < N_ARRAY; i++) {
    *a[i].at = a[i].bytes ? at : NULL;
    at += vg_shmem_padded(a[i].bytes);
  }
  view.common = common;
  vg_layers_release(layers);
  *layers = view;
  return st;
}
