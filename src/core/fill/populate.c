/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Insertion of points into the cells of a front, and improvement of the cells.
 */
#include "core/fill/fill_parts.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "core/delaunay/insert.h"
#include "core/fill/place.h"
#include "core/geometry/hilbert.h"
#include "core/optimise/optimise.h"

/* Least distance of a new point from any other, relative to the spacing, and
 * least height over a front face, relative to its mean edge. Other points
 * would make worse cells than those of the coarser mesh without them. */
static const double least_distance = 0.5; /* K6 */
static const double least_height = 0.3;
/* Cells within this many spacings of a region's cells are optimised, too: a
 * bad cell there would leave a notch in the front. */
static const double margin = 0.3; /* K8 */
/* Seeds keep a larger distance, because the front determines the points near
 * it. */
static const double seed_distance = 0.8; /* K7 */

enum { STOP_STEP = 1 << 15 };

/* Insert a point at x. *at in: a cell near it; out: a cell near the next one.
 */
static vg_status insert_one(struct vg_filling *g, struct vg_inserter *s,
                            const double x[3], double nearest, uint32_t *at,
                            struct vg_error *err)
{
  struct vg_tets *t = &g->t;
  uint32_t p = (uint32_t)t->n_point, c;
  vg_status st;

  c = vg_tets_locate(t, *at, x);
  if (c == VG_NONE) return VG_BLOCKED;
  *at = c; /* the next point is close to this one, whether this one is
              inserted or not */
  if (t->flag[c] & VG_OUTSIDE) return VG_BLOCKED;
  if (vg_tets_reserve_points(t, 1))
    return vg_fail_memory(err, "the points of the mesh");
  memcpy(t->x[p], x, sizeof *t->x);
  t->n_point++;
  st = vg_insert(s, p, c, least_height, nearest, err);
  if (st == VG_OK) *at = s->last;
  else t->n_point--;
  return st;
}

static vg_status insert_all(struct vg_filling *g,
                            const struct vg_placed *placed,
                            const uint32_t *order, double nearest,
                            struct vg_error *err)
{
  struct vg_inserter s;
  uint32_t at = 0;
  vg_status st = vg_inserter_init(&s, &g->t, err);

  while (g->t.flag[at] & (VG_OUTSIDE | VG_DEAD)) at++;
  if (st == VG_OK && vg_tets_reserve_points(&g->t, placed->n))
    st = vg_fail_memory(err, "the points of the mesh");
  for (size_t i = 0; st >= 0 && i < placed->n; i++) {
    const double *x = placed->x[order[i]];
    double h = placed->h ? (double)placed->h[order[i]]
                         : vg_sizing_at(g->sizing, x);

    st = insert_one(g, &s, x, nearest * h, &at, err);
    g->report->n_inserted += st == VG_OK;
    g->report->n_refused += st == VG_BLOCKED;
    if (st >= 0 && i % STOP_STEP == 0) st = vg_stopped(&g->options->stop, err);
  }
  vg_inserter_release(&s);
  return st < 0 ? st : VG_OK;
}

static vg_status insert_placed(struct vg_filling *g,
                               const struct vg_placed *placed, double nearest,
                               struct vg_error *err)
{
  uint32_t *order = vg_alloc(placed->n, sizeof *order);
  double t0 = vg_clock();
  vg_status st;

  if (!order) {
    st = vg_fail_memory(err, "ordering points");
    goto done;
  }
  VG_TRY(
    vg_insertion_order(placed->n, (const double(*)[3])placed->x, order, err));
  st = insert_all(g, placed, order, nearest, err);
done:
  free(order);
  g->report->n_placed += placed->n;
  g->report->time_insert += vg_clock() - t0;
  return st;
}

vg_status vg_filling_populate(struct vg_filling *g, struct vg_error *err)
{
  struct vg_placed placed = { 0 };
  double t0;
  vg_status st;

  assert(g->t.n_point >= g->front->n_point);
  if (vg_sizing_is_stretched(g->sizing)) return vg_stretched_populate(g, err);
  VG_TRY(vg_place_seeds(g->front->n_point, (const double(*)[3])g->t.x,
                        g->sizing, g->region, &placed, err));
  st = insert_placed(g, &placed, seed_distance, err);
  vg_placed_release(&placed);
  if (st != VG_OK) goto done;
  t0 = vg_clock();
  VG_TRY(vg_place(&g->t, g->sizing, g->region, g->options->point_limit, &placed,
                  err));
  g->report->n_list_cut += placed.n_cut;
  g->report->time_place += vg_clock() - t0;
  st = insert_placed(g, &placed, least_distance, err);
done:
  vg_placed_release(&placed);
  return st;
}

vg_status vg_filling_improve(struct vg_filling *g, struct vg_error *err)
{
  struct vg_optimise_report r = { 0 };
  struct vg_region near = { 0 };
  double t0 = vg_clock();
  vg_status st = VG_OK;

  assert(g->t.n_point >= g->front->n_point);
  VG_TRY(vg_tets_compact(&g->t, g->front->n_point, err));
  VG_TRY(vg_stopped(&g->options->stop, err));
  if (g->region) near = *g->region;
  near.reach += margin;
  if (g->options->sweeps > 0) {
    st = vg_optimise(&g->t, g->front->n_point, g->options->sweeps,
                     g->region ? &near : NULL, g->sizing, &r, err);
    g->report->n_smoothed += r.n_smoothed;
    g->report->n_flip += r.n_flip;
    g->report->n_collapse += r.n_collapse;
    g->report->n_split += r.n_split;
    g->report->n_left += r.n_left;
  }
  g->report->time_optimise += vg_clock() - t0;
done:
  return st;
}
