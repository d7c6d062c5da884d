/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/optimise/optimise.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "core/optimise/optimise_ball.h"

/* Shapes as defined by vg_shape, with the dihedral angles that they correspond
 * to, in degrees. Cells below `aim` (angles below 25 or above 155) are
 * improved one by one. Sweeps swap cells below `fair` (30, 150). The first
 * sweep moves the points of cells below `good` (45, 135), the next ones only
 * those of cells below `fair`. Below `desperate` (15, 165), points are removed
 * or inserted; `worst` is 10 or 170 degrees. */
static const struct vg_shape_levels euclidean = {
  VG_SHAPE_TARGET, 0.25F, VG_SHAPE_GOOD, /* K24 */
  0.067, 0.03F                           /* K25 */
};

/* In a metric: cubes of the mean ratios 0.6, 0.77, 1, 0.4, 0.2. */
static const struct vg_shape_levels in_metric = {
  VG_METRIC_TARGET, 0.45F, 1, 0.064, 0.008F /* K43 */
};

static void set_metrics(struct vg_optimiser *o, struct vg_metrics *metrics)
{
  o->metrics = metrics;
  o->level = metrics ? &in_metric : &euclidean;
}

/* Number of rounds over bad cells. They end early if a round improves at most
 * one percent of its cells. */
enum { ROUNDS = 8, CLASSES = 8 }; /* K26 */

enum {
  SHAPES = 64, /* Number of cells whose shapes are computed together. */
  AHEAD = 2    /* The cells of a ball are fetched this many points ahead. */
};

static vg_status start(struct vg_optimiser *o, struct vg_tets *t,
                       struct vg_error *err)
{
  o->t = t;
  o->budget = vg_split_budget(t);
  o->star = vg_alloc(t->n_point, sizeof *o->star);
  o->cap_star = t->n_point;
  if (o->star) memset(o->star, 0xff, t->n_point * sizeof *o->star);
  o->failed = vg_calloc(t->n_point, sizeof *o->failed);
  o->cap_failed = t->n_point;
  if (!o->star || !o->failed ||
      vg_reserve(&o->q, &o->cap_q, t->cap_cell, sizeof *o->q) ||
      vg_reserve(&o->failed_cell, &o->cap_failed_cell, t->cap_cell,
                 sizeof *o->failed_cell))
    return vg_fail_memory(err, "optimisation");
  for (uint32_t c = 0; o->metrics && c < t->n_cell; c++)
    o->q[c] = (float)vg_metrics_shape(o->metrics, t, t->cell[c].v);
  for (uint32_t c = 0, n; !o->metrics && c < t->n_cell; c += n) {
    n = t->n_cell - c < SHAPES ? (uint32_t)t->n_cell - c : SHAPES;
    vg_ball_cells(t, c, n, o->q + c);
  }
  for (uint32_t c = 0; c < t->n_cell; c++) {
    o->failed_cell[c] = 0;
    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE)) {
      o->q[c] = 1;
      continue;
    }
    for (int i = 0; i < 4; i++) o->star[t->cell[c].v[i]] = c;
  }
  return VG_OK;
}

static int is_live(const struct vg_tets *t, uint32_t c)
{
  return !(t->flag[c] & (VG_DEAD | VG_OUTSIDE));
}

static int is_in_region(const struct vg_optimiser *o, uint32_t c)
{
  const struct vg_tets *t = o->t;
  const uint32_t *v = t->cell[c].v;

  return vg_region_has_cell(o->region, o->sizing, t->x[v[0]], t->x[v[1]],
                            t->x[v[2]], t->x[v[3]]);
}

/* A flat cell between the front and the region: if its neighbours became
 * final, only this cell could fill the slit between them. */
static int makes_slit(const struct vg_optimiser *o, uint32_t c)
{
  const struct vg_tets *t = o->t;

  if (o->q[c] >= o->level->desperate || !(t->flag[c] & VG_FIXED_FACES))
    return 0;
  for (int i = 0; i < 4; i++)
    if (!(t->flag[c] >> i & 1) && t->cell[c].link[i] != VG_NONE &&
        is_in_region(o, t->cell[c].link[i] >> 2))
      return 1;
  return 0;
}

/* Is cell c one that should be improved? A negative answer, which would be
 * computed repeatedly for bad cells at the border, is stored until the cell
 * changes. */
static int concerns(const struct vg_optimiser *o, uint32_t c)
{
  if (!o->region) return 1;
  if (o->failed_cell[c] & VG_NOT_IN_REGION) return 0;
  if (is_in_region(o, c) || makes_slit(o, c)) return 1;
  o->failed_cell[c] |= VG_NOT_IN_REGION;
  return 0;
}

/* least[p]: shape of the worst cell around p that should be improved, if it is
 * below the limit. */
static void worst_around(const struct vg_optimiser *o, float limit,
                         float *least)
{
  const struct vg_tets *t = o->t;

  for (size_t p = 0; p < t->n_point; p++) least[p] = 2;
  for (uint32_t c = 0; c < t->n_cell; c++)
    if (is_live(t, c) && o->q[c] < limit && concerns(o, c))
      for (int i = 0; i < 4; i++)
        if (o->q[c] < least[t->cell[c].v[i]]) least[t->cell[c].v[i]] = o->q[c];
}

/* Fetch the cells around point p, which are scattered in memory. */
static void prefetch_ball(const struct vg_tets *t, const struct vg_balls *b,
                          uint32_t p)
{
  if (p >= t->n_point) return;
  for (uint32_t k = b->first[p]; k < b->first[p + 1]; k++)
    __builtin_prefetch(&t->cell[b->link[k] >> 2]);
}

/* Smooth the points with a cell below `limit` that should be improved. The list
 * of all balls pays for itself if most points are smoothed. */
static vg_status smooth_all(struct vg_optimiser *o, float limit,
                            struct vg_error *err)
{
  struct vg_tets *t = o->t;
  struct vg_balls balls = { NULL, NULL, NULL };
  float *least = vg_alloc(t->n_point, sizeof *least);
  int all = limit >= o->level->good, bad = !least;

  if (all && !bad) bad = vg_balls_init(t, &balls);
  if (!bad) worst_around(o, limit, least);
  for (uint32_t p = (uint32_t)o->n_fixed; !bad && p < t->n_point; p++) {
    if (!(least[p] < limit)) continue;
    if (all) {
      prefetch_ball(t, &balls, p + AHEAD);
      vg_smooth_within(o, &balls, p, o->level->aim);
    } else {
      vg_smooth(o, p, o->level->aim);
    }
  }
  vg_balls_release(&balls);
  free(least);
  return bad ? vg_fail_memory(err, "optimisation") : VG_OK;
}

/* Swaps come first, since smoothing a sliver spoils its neighbours. Points
 * without a cell below `limit` are not moved; in a uniform sizing field these
 * are nearly all points. The points of a region are not smoothed either: they
 * are on the lattice that the adjacent voids will continue, and moving them
 * would degrade these voids more than it improves the region. */
static vg_status sweep(struct vg_optimiser *o, float limit,
                       struct vg_error *err)
{
  const struct vg_tets *t = o->t;

  for (uint32_t c = 0; c < t->n_cell; c++)
    if (is_live(t, c) && o->q[c] < o->level->fair && concerns(o, c))
      vg_swap(o, c);
  return o->region ? VG_OK : smooth_all(o, limit, err);
}

/* A cell for which all steps failed is flagged VG_TRIED until it changes. */
static int needs_improvement(const struct vg_optimiser *o, uint32_t c)
{
  return is_live(o->t, c) && o->q[c] < o->level->aim &&
         !(o->t->flag[c] & VG_TRIED) && concerns(o, c);
}

/* List the cells to improve: a few classes of shape, the worst class first,
 * and within a class in memory order, which keeps neighbours together. */
static vg_status list_bad(const struct vg_optimiser *o, size_t *n,
                          struct vg_key **list, struct vg_error *err)
{
  size_t k = 0, n_cell = o->t->n_cell;

  *n = 0;
  for (uint32_t c = 0; c < n_cell; c++) *n += (size_t)needs_improvement(o, c);
  *list = vg_alloc(*n, sizeof **list);
  if (!*list) return vg_fail_memory(err, "optimisation");
  for (uint32_t c = 0; c < n_cell; c++)
    if (needs_improvement(o, c)) {
      double q = o->q[c] > 0 ? o->q[c] : 0;

      (*list)[k].key = q < o->level->desperate
                       ? (uint64_t)(CLASSES * q / o->level->desperate)
                       : CLASSES;
      (*list)[k++].index = c;
    }
  return vg_sort_keys(*n, *list, err);
}

/* Improve one bad cell by the cheapest step that helps. */
static int improve_cell(struct vg_optimiser *o, uint32_t c)
{
  int better = 0;

  if (vg_swap(o, c)) return 1;
  for (int i = 0; i < 4 && o->q[c] < o->level->aim; i++)
    better |= vg_smooth(o, o->t->cell[c].v[i], o->level->aim);
  if (better || o->q[c] >= o->level->desperate) return better;
  return vg_collapse(o, c) || vg_split(o, c, o->level->aim);
}

static vg_status improve_bad(struct vg_optimiser *o, int *again,
                             struct vg_error *err)
{
  struct vg_key *list = NULL;
  size_t n, n_better = 0;
  vg_status st = list_bad(o, &n, &list, err);

  for (size_t k = 0; st == VG_OK && k < n; k++) {
    uint32_t c = list[k].index;

    if (!needs_improvement(o, c)) continue;
    if (improve_cell(o, c)) n_better++;
    else o->t->flag[c] |= VG_TRIED;
  }
  free(list);
  *again = n_better > n / 100;
  return st;
}

/* Number of bad cells that were skipped because the budget was spent. */
static size_t count_left(const struct vg_optimiser *o)
{
  size_t n = 0;

  if (o->spent <= o->budget) return 0;
  for (uint32_t c = 0; c < o->t->n_cell; c++)
    n += is_live(o->t, c) && o->q[c] < o->level->desperate && concerns(o, c) &&
         !(o->failed_cell[c] & VG_FAILED_SPLIT);
  return n;
}

static vg_status optimise(struct vg_optimiser *o, struct vg_tets *t, int sweeps,
                          struct vg_error *err)
{
  int again = 1;
  vg_status st = start(o, t, err);

  for (int k = 0; st == VG_OK && k < sweeps; k++) {
    st = sweep(o, k && !o->metrics ? o->level->fair : o->level->good, err);
    if (st == VG_OK && o->metrics) st = vg_even_lengths(o, err);
  }
  for (int k = 0; st == VG_OK && k < ROUNDS && again; k++)
    st = improve_bad(o, &again, err);
  if (st == VG_OK && o->metrics && sweeps > 0) st = vg_even_lengths(o, err);
  if (st == VG_OK) o->report->n_left = count_left(o);
  for (size_t c = 0; c < t->n_cell; c++) t->flag[c] &= (uint8_t)~VG_TRIED;
  if (st == VG_OK && o->refused) st = vg_fail_memory(err, "optimisation");
  VG_CHECK("optimisation", vg_tets_defects(t));
  free(o->q);
  free(o->star);
  free(o->failed);
  free(o->failed_cell);
  free(o);
  return st;
}

vg_status vg_optimise(struct vg_tets *t, size_t n_fixed, int sweeps,
                      const struct vg_region *region,
                      const struct vg_sizing *sizing,
                      struct vg_optimise_report *report, struct vg_error *err)
{
  assert(n_fixed <= t->n_point && sweeps >= 0);
  assert((!region || sizing) && report);

  struct vg_optimiser *o = vg_calloc(1, sizeof *o);
  struct vg_metrics metrics = { .sizing = sizing };
  int is_stretched = sizing && vg_sizing_is_stretched(sizing);
  vg_status st;

  memset(report, 0, sizeof *report);
  if (!o || (is_stretched && vg_metrics_add(&metrics, t, 0, t->n_point))) {
    free(o);
    return vg_fail_memory(err, "optimisation");
  }
  o->n_fixed = o->n_keep = n_fixed;
  o->region = region;
  o->sizing = sizing;
  o->report = report;
  set_metrics(o, is_stretched ? &metrics : NULL);
  st = optimise(o, t, sweeps, err);
  vg_metrics_release(&metrics);
  return st;
}

vg_status vg_optimise_bad(struct vg_tets *t, size_t n_fixed, size_t n_keep,
                          struct vg_metrics *metrics,
                          struct vg_optimise_report *report,
                          struct vg_error *err)
{
  assert(n_fixed <= n_keep && n_keep <= t->n_point && report);

  struct vg_optimiser *o = vg_calloc(1, sizeof *o);

  memset(report, 0, sizeof *report);
  if (!o) return vg_fail_memory(err, "optimisation");
  o->n_fixed = n_fixed;
  o->n_keep = n_keep;
  o->report = report;
  set_metrics(o, metrics);
  return optimise(o, t, 0, err);
}
