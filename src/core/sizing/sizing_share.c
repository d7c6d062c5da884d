/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* One sizing field shared by the ranks of a node. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/sizing/sizing_octree.h"

/* The scalar members, the tree, its smallest spacings, the leaves, their
 * tensors, the bounds of these. */
enum { PARTS = 6 };

static struct vg_bytes part(size_t n, const void *data)
{
  return (struct vg_bytes){ n, (unsigned char *)(uintptr_t)data };
}

static void list_parts(const struct vg_sizing *s, struct vg_bytes p[PARTS])
{
  const struct vg_octree *t = &s->octree;

  p[0] = part(sizeof *s, s);
  p[1] = part(t->n_split * sizeof *t->child, t->child);
  p[2] = part(t->n_split * sizeof *t->least, t->least);
  p[3] = part(t->n_leaf * sizeof *t->leaf, t->leaf);
  p[4] = part(t->n_tensor * sizeof *t->tensor, t->tensor);
  p[5] = part(t->is_stretched ? t->n_split * sizeof *t->bounds : 0, t->bounds);
}

void vg_sizing_show(const struct vg_sizing *s,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user)
{
  struct vg_bytes p[PARTS];

  list_parts(s, p);
  look(user, sizeof s->octree.lo, s->octree.lo);
  look(user, sizeof s->octree.side, &s->octree.side);
  look(user, sizeof s->growth, &s->growth);
  look(user, sizeof s->cap, &s->cap);
  for (int k = 1; k < PARTS - 1; k++)
    if (k < 4 || p[k].n) look(user, p[k].n, p[k].data);
}

/* Takes over the shared memory. Returns NULL if memory is refused. */
static struct vg_sizing *view(const struct vg_shmem *common)
{
  struct vg_sizing *s = vg_alloc(1, sizeof *s);
  unsigned char *at = (unsigned char *)(uintptr_t)common->data;
  struct vg_bytes p[PARTS];

  if (!s) return NULL;
  memcpy(s, at, sizeof *s);
  s->common = *common;
  list_parts(s, p);
  at += vg_shmem_padded(p[0].n);
  s->octree.child = (void *)at;
  at += vg_shmem_padded(p[1].n);
  s->octree.least = (void *)at;
  at += vg_shmem_padded(p[2].n);
  s->octree.leaf = (void *)at;
  at += vg_shmem_padded(p[3].n);
  s->octree.tensor = (void *)at;
  at += vg_shmem_padded(p[4].n);
  s->octree.bounds = p[5].n ? (void *)at : NULL;
  return s;
}

vg_status vg_sizing_share(struct vg_comm *c, struct vg_sizing **s,
                          struct vg_error *err)
{
  struct vg_bytes p[PARTS];
  struct vg_shmem common;
  struct vg_sizing *got;
  vg_status st;

  if (vg_comm_node_size(c) == 1) return VG_OK;
  if (!vg_comm_node_rank(c)) list_parts(*s, p);
  st = vg_comm_node_shmem(c, PARTS, p, &common, err);
  if (st < 0) return st;
  got = view(&common);
  if (!got) {
    vg_shmem_release(&common);
    return vg_fail_memory(err, "the sizing field");
  }
  vg_sizing_free(*s);
  *s = got;
  return VG_OK;
}

size_t vg_sizing_shmem(const struct vg_sizing *s)
{
  return vg_shared_bytes(&s->common);
}
