/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Periodic patches in the files of a mesh. Declared in run/stages/output.h. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/periodic/periodic_cfg.h"
#include "io/mesh/su2.h"
#include "io/mesh/ugrid.h"
#include "io/slices/slices.h"
#include "run/stages/output.h"

/* Sends the pairs of rank 0 to all. Collective. */
static vg_status share_pairs(const struct vg_pairs *from, struct vg_comm *comm,
                             struct vg_periodic **pair, size_t *n,
                             struct vg_error *err)
{
  struct vg_bytes b = { 0, NULL };
  vg_status st = VG_OK;

  if (!vg_comm_rank(comm)) {
    b.n = from->n * sizeof *from->pair;
    b.data = vg_alloc(from->n, sizeof *from->pair);
    if (b.data) memcpy(b.data, from->pair, b.n);
    else st = vg_fail_memory(err, "the periodic patches");
  }
  st = vg_comm_agree(comm, st, err);
  if (st >= 0) st = vg_comm_bcast(comm, 0, &b, err);
  *pair = (struct vg_periodic *)(void *)b.data;
  *n = b.n / sizeof **pair;
  return st;
}

void vg_output_links_release(struct vg_output_links *l)
{
  for (size_t i = 0; l->match && i < l->links.n; i++)
    vg_periodic_match_release(&l->match[i]);
  free(l->match);
  free(l->pair);
  vg_mesh_release(&l->boundary);
}

vg_status vg_output_links_find(const struct vg_pairs *pairs,
                               struct vg_comm *comm,
                               const struct vg_slices *mesh, int threads,
                               struct vg_output_links *l, struct vg_error *err)
{
  vg_status st;

  VG_TRY(share_pairs(pairs, comm, &l->pair, &l->links.n, err));
  VG_TRY(vg_slices_boundary(comm, mesh, threads, &l->boundary, err));
  l->match = vg_calloc(l->links.n, sizeof *l->match);
  if (!l->match) st = vg_fail_memory(err, "the periodic patches");
  for (size_t i = 0; i < l->links.n && st >= 0; i++)
    st = vg_periodic_match(&l->boundary, &l->pair[i],
                           VG_PERIODIC_EXACT *
                             vg_periodic_extent(&l->boundary, &l->pair[i]),
                           &l->match[i], err);
  l->links.n_point = l->boundary.n_point;
  l->links.pair = l->pair;
  l->links.match = l->match;
  st = vg_comm_agree(comm, st, err);
done:
  return st;
}

vg_status vg_outputs_periodic(struct vg_outputs *o,
                              const struct vg_output_links *l,
                              struct vg_error *err)
{
  struct vg_ugrid_kind kind;
  int needs = 0;
  char *path;
  vg_status st;

  for (size_t i = 0; i < o->n_item; i++)
    needs |= vg_ugrid_kind(o->item[i], &kind) || !strcmp(o->item[i], "su2") ||
             !strcmp(o->item[i], VG_SU2_ZONES);
  if (!needs || !l->links.n || o->is_guest) return VG_OK;
  st = vg_outputs_new(o, VG_PERIODIC_SUFFIX, &path, err);
  if (st >= 0)
    st = vg_periodic_cfg_write(path, &l->boundary, l->links.n, l->pair, err);
  free(path);
  return st;
}
