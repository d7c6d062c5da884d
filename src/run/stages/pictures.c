/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/stages/pictures.h"

#include <assert.h>

#include "run/common/progress.h"

vg_status vg_run_pictures_plan(struct vg_run_pictures *r, struct vg_comm *comm,
                               const struct vg_mesh *surface,
                               const struct vg_columns *columns,
                               struct vg_error *err)
{
  double t = vg_display_now();
  vg_status st;

  assert(!r->cuts);
  if (!r->is_on) return VG_OK;
  st = vg_cut_plan(surface, columns, r->axis > 0, &r->plan, err);
  for (size_t i = 0; i < r->plan.n && r->axis; i++) {
    r->plan.cut[i].axis = r->axis;
    r->plan.cut[i].at = r->at;
  }
  if (st >= 0) st = vg_cuts_new(r->plan.n, r->plan.cut, &r->cuts, err);
  r->time += vg_display_now() - t;
  return vg_comm_agree(comm, st, err);
}

vg_status vg_run_pictures_put(void *pictures, const struct vg_slice *slice,
                              struct vg_error *err)
{
  struct vg_run_pictures *r = pictures;
  double t = vg_display_now();
  vg_status st;

  if (!r->is_on) return VG_OK;
  st = vg_cuts_put(r->cuts, slice, err);
  __atomic_fetch_add(&r->put_time, (uint64_t)(1e9 * (vg_display_now() - t)),
                     __ATOMIC_RELAXED);
  return st;
}

vg_status vg_run_pictures_gather(struct vg_run_pictures *r,
                                 struct vg_comm *comm,
                                 const struct vg_slices *field, uint64_t before,
                                 int threads,
                                 const struct vg_mesh_report *report,
                                 struct vg_error *err)
{
  uint64_t id[VG_RUN_WORST];
  double t = vg_display_now();
  size_t n = report->n_worst < VG_RUN_WORST ? report->n_worst : VG_RUN_WORST;
  vg_status st;

  if (!r->is_on) return VG_OK;
  for (size_t i = 0; i < n; i++) id[i] = report->worst[i].cell - before;
  VG_TRY(vg_cuts_gather(r->cuts, comm, err));
  st = vg_around_find(comm, field, threads, n, id, r->worst, err);
done:
  r->time += vg_display_now() - t + 1e-9 * (double)r->put_time / threads;
  return st;
}

void vg_run_pictures_release(struct vg_run_pictures *r)
{
  vg_cuts_free(r->cuts);
  r->cuts = NULL;
  vg_around_release(r->worst, VG_RUN_WORST);
}
