/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Dropped cells: those of zones whose changes cross the front. Their home rank
 * finds this after the executing rank has kept the cells. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/cut/node.h"

vg_status vg_partition_note_drop(struct vg_partition *p,
                                 const struct vg_change *c,
                                 struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(p && c && c->serial);
  pthread_mutex_lock(&p->lock);
  if (vg_reserve(&p->drop, &p->cap_drop, p->n_drop + 1, sizeof *p->drop)) {
    st = vg_fail_memory(err, "cutting a front");
  } else {
    p->drop[p->n_drop++] = c->serial;
    p->report.n_crossing++;
    p->report.n_blocked++;
    p->report.n_zone_cell -= c->made.n_cell;
  }
  pthread_mutex_unlock(&p->lock);
  return st;
}

/* Removes the pieces with this serial and appends their paths to `path`. */
static void drop(struct vg_partition *p, uint32_t serial, vg_path *path,
                 size_t *n_path)
{
  size_t left = 0;

  for (size_t k = 0; k < p->n_piece; k++) {
    if (p->piece[k].serial != serial) {
      p->piece[left++] = p->piece[k];
      continue;
    }
    memcpy(path[(*n_path)++], p->piece[k].path, sizeof *path);
    vg_piece_release(&p->piece[k]);
  }
  p->n_piece = left;
}

/* Sets the cell count of the task to 0. */
static void forget_span(struct vg_spans *s, const char *path)
{
  for (size_t i = 0; i < s->n; i++)
    if (!strcmp(s->span[i].path, path)) s->span[i].n_cell = 0;
}

vg_status vg_partition_forget_spans(struct vg_partition *p,
                                    struct vg_comm *comm, size_t n_path,
                                    vg_path *path, struct vg_spans *spans,
                                    struct vg_error *err)
{
  struct vg_bytes mine = { n_path * sizeof *path, (unsigned char *)path };
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the trace of tasks");

  assert(path || !n_path);
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (int r = 0; spans && r < p->size; r++)
    for (size_t at = 0; at < all[r].n; at += sizeof *path)
      forget_span(spans, (const char *)all[r].data + at);
done:
  vg_bytes_release(all, p->size);
  return st;
}

vg_status vg_partition_drop(struct vg_partition *p, struct vg_comm *comm,
                            struct vg_spans *spans, struct vg_error *err)
{
  struct vg_bytes mine = { p->n_drop * sizeof *p->drop,
                           (unsigned char *)p->drop };
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  vg_path *path = NULL;
  size_t n = 0, n_path = 0;
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the cells of a task");

  assert(p->size == vg_comm_size(comm) && (p->drop || !p->n_drop));
  VG_TRY(vg_comm_agree(comm, st, err));
  VG_TRY(vg_comm_allgather(comm, &mine, all, err));
  for (int r = 0; r < p->size; r++) n += all[r].n / sizeof *p->drop;
  if (!n) goto done;
  path = vg_calloc(n, sizeof *path);
  if (!path) st = vg_fail_memory(err, "the cells of a task");
  VG_TRY(vg_comm_agree(comm, st, err));
  for (int r = 0; r < p->size; r++) {
    const uint32_t *serial = (const uint32_t *)(const void *)all[r].data;

    for (size_t k = 0; k < all[r].n / sizeof *serial; k++)
      drop(p, serial[k], path, &n_path);
  }
  p->n_drop = 0;
  st = vg_partition_forget_spans(p, comm, n_path, path, spans, err);
done:
  free(path);
  vg_bytes_release(all, p->size);
  return st;
}
