/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* One pass of swaps: the first half of a sweep of the optimisation. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/optimise/optimise_parts.h"

static int prepare(struct vg_optimiser *o)
{
  const struct vg_tets *t = o->t;

  o->star = vg_alloc(t->n_point, sizeof *o->star);
  o->failed = vg_calloc(t->n_point, 1);
  o->failed_cell = vg_calloc(t->n_cell, 1);
  o->cap_star = o->cap_failed = t->n_point;
  o->cap_failed_cell = o->cap_q = t->n_cell;
  return o->star && o->failed && o->failed_cell ? 0 : -1;
}

vg_status vg_optimise_swaps(struct vg_tets *t, float below,
                            struct vg_metrics *metrics, float **q,
                            struct vg_optimise_report *report,
                            struct vg_error *err)
{
  assert(q && (*q || !t->n_cell) && report);

  struct vg_optimiser *o = vg_calloc(1, sizeof *o);
  size_t n = t->n_cell;
  vg_status st = VG_OK;

  memset(report, 0, sizeof *report);
  if (!o) return vg_fail_memory(err, "optimisation");
  o->t = t;
  o->q = *q;
  o->metrics = metrics;
  o->report = report;
  if (prepare(o) < 0) st = vg_fail_memory(err, "optimisation");
  for (uint32_t c = 0; st == VG_OK && c < n; c++)
    if (!(t->flag[c] & (VG_DEAD | VG_OUTSIDE)) && o->q[c] < below)
      vg_swap(o, c);
  *q = o->q;
  VG_CHECK("a pass of swaps", vg_tets_defects(t));
  if (st == VG_OK && o->refused) st = vg_fail_memory(err, "optimisation");
  free(o->star);
  free(o->failed);
  free(o->failed_cell);
  free(o);
  return st;
}
