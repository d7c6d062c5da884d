/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Points and cells of a front in a metric (core/metric). */
#include <assert.h>

#include "base/clock.h"
#include "base/memory.h"
#include "core/fill/fill_parts.h"
#include "core/metric/metric_points.h"

vg_status vg_stretched_populate(struct vg_filling *g, struct vg_error *err)
{
  struct vg_metric_advance_report r = { 0 };
  struct vg_metrics metrics = { .sizing = g->sizing };
  double t0 = vg_clock();
  vg_status st;

  st = vg_metrics_add(&metrics, &g->t, 0, g->t.n_point)
       ? vg_fail_memory(err, "the metrics of points")
       : VG_OK;
  if (st == VG_OK)
    st = vg_metric_advance(&g->t, &metrics, g->region, g->options->point_limit,
                           &g->options->stop, &r, err);
  g->report->n_placed += r.n_inserted + r.n_refused;
  g->report->n_inserted += r.n_inserted;
  g->report->n_refused += r.n_refused;
  g->report->time_insert += vg_clock() - t0;
  vg_metrics_release(&metrics);
  return st;
}
