/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Points and cells of a front in a metric (core/metric). */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "core/fill/fill_parts.h"
#include "core/geometry/hilbert.h"
#include "core/metric/metric_points.h"
#include "core/metric/metric_seeds.h"

/* Least distance of a seed from other points, in the metric (K7). */
static const double seed_distance = 0.8;

enum { STOP_STEP = 1 << 12 };

/* Insert one seed, if its surroundings are coarse enough. */
static vg_status insert_seed(struct vg_filling *g, struct vg_metrics *metrics,
                             struct vg_inserter *s, const double x[3],
                             uint32_t *at, struct vg_error *err)
{
  struct vg_tets *t = &g->t;
  uint32_t c = vg_tets_locate(t, *at, x);
  struct vg_point_metric m;
  vg_status st;

  if (c == VG_NONE) return VG_BLOCKED;
  *at = c;
  if (t->flag[c] & VG_OUTSIDE) return VG_BLOCKED;
  vg_metric_at(g->sizing, x, &m);
  st = vg_metrics_insert(metrics, s, x, &m, c, seed_distance, seed_distance,
                         err);
  if (st == VG_OK) *at = s->last;
  return st;
}

static vg_status insert_seeds(struct vg_filling *g, struct vg_metrics *metrics,
                              struct vg_metric_seeds *seed,
                              struct vg_error *err)
{
  uint32_t *order = vg_alloc(seed->n, sizeof *order), at = 0;
  struct vg_inserter s;
  vg_status st = vg_inserter_init(&s, &g->t, err);

  if (st == VG_OK && !order) st = vg_fail_memory(err, "ordering points");
  if (st == VG_OK)
    st = vg_insertion_order(seed->n, (const double(*)[3])seed->x, order, err);
  while (g->t.flag[at] & (VG_OUTSIDE | VG_DEAD)) at++;
  for (size_t i = 0; st >= 0 && i < seed->n; i++) {
    st = insert_seed(g, metrics, &s, seed->x[order[i]], &at, err);
    g->report->n_inserted += st == VG_OK;
    if (st >= 0 && i % STOP_STEP == 0) st = vg_stopped(&g->options->stop, err);
  }
  g->report->n_placed += seed->n;
  vg_inserter_release(&s);
  free(order);
  free(seed->x);
  return st < 0 ? st : VG_OK;
}

vg_status vg_stretched_populate(struct vg_filling *g, struct vg_error *err)
{
  struct vg_metric_advance_report r = { 0 };
  struct vg_metrics metrics = { .sizing = g->sizing };
  struct vg_metric_seeds seed = { 0 };
  double t0 = vg_clock();
  vg_status st;

  st = vg_metric_seeds(g->front->n_point, (const double(*)[3])g->t.x, g->sizing,
                       g->region, &seed, err);

  if (st == VG_OK && vg_metrics_add(&metrics, &g->t, 0, g->t.n_point))
    st = vg_fail_memory(err, "the metrics of points");
  if (st == VG_OK) st = insert_seeds(g, &metrics, &seed, err);
  g->report->time_place += vg_clock() - t0;
  t0 = vg_clock();
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
