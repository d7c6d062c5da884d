/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Periodic patches of the finished mesh. Declared in run/stages/run.h. */
#include "io/slices/slices.h"
#include "run/periodic/periodic_pairs.h"
#include "run/stages/run.h"

static const char differ[] = "this is an error of Vanguard; please report it "
                             "with the project files";

vg_status vg_run_verify_front(const struct vg_run *r,
                              const struct vg_problem *p,
                              const struct vg_mesh *front, struct vg_error *err)
{
  double distance;
  vg_status st = VG_OK;

  if (!p->read.settings.n_periodic) return VG_OK;
  if (!r->rank)
    st = vg_pairs_verify(&p->boundary.pairs, front, differ, &distance, err);
  return vg_comm_agree(r->comm, st, err);
}

vg_status vg_run_verify_periodic(struct vg_run *r, const struct vg_problem *p,
                                 struct vg_error *err)
{
  struct vg_mesh m = VG_MESH_INIT;
  vg_status st;

  if (!p->read.settings.n_periodic) return VG_OK;
  VG_TRY(vg_slices_boundary(r->comm, &r->slices, r->threads, &m, err));
  if (!r->rank)
    st = vg_pairs_verify(&p->boundary.pairs, &m, differ, &r->periodic_distance,
                         err);
  st = vg_comm_agree(r->comm, st, err);
done:
  vg_mesh_release(&m);
  return st;
}
