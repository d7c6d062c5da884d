/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_walk_lanes.h: searches in the hierarchy of samples
 * (core/sizing/sizing_bvh_parts.h). Private to sizing_walk.c and
 * sizing_walk_wide.c, which include it with these macros:
 *   WIDTH         4 or 8: number of lanes of a vector
 *   TARGET        attributes of the functions
 *   ABOVE, BELOW  names of vg_bvh_above and vg_bvh_below for this width
 *
 * Vectors are those of gcc and clang. Only sqrt and min need intrinsics. Every
 * operation rounds as its scalar form does, and the order of the search does
 * not depend on the width, so that all machines agree. */
#include <assert.h>
#include <math.h>
#include <string.h>

#if WIDTH == 8
#include <immintrin.h>
#elif defined __SSE2__ && !defined VG_PORTABLE
#include <emmintrin.h>
#define SSE
#endif

#include "core/sizing/sizing_bvh_parts.h"

#define LANES VG_BVH_LANES
#define PARTS (LANES / WIDTH)
#define SHY (2 * VG_BVH_MARGIN)

typedef float lanes __attribute__((vector_size(4 * WIDTH)));
typedef int32_t masks __attribute__((vector_size(4 * WIDTH)));

struct search {
  const struct vg_bvh *t;
  const struct vg_bvh_tree *tree;
  double mid[3];
  float half[3], best, enough, by;
  uint32_t hint;
};

static inline TARGET lanes load(const float *p)
{
  lanes v;

  memcpy(&v, p, sizeof v);
  return v;
}

static inline TARGET void store(float *p, lanes v)
{
  memcpy(p, &v, sizeof v);
}

static inline TARGET lanes lanes_abs(lanes v)
{
  return (lanes)((masks)v & 0x7fffffff);
}

static inline TARGET lanes lanes_max0(lanes v)
{
  return (lanes)((masks)v & (masks)(v > 0));
}

static inline TARGET lanes lanes_choose(masks m, lanes a, lanes b)
{
  return (lanes)(((masks)a & m) | ((masks)b & ~m));
}

static inline TARGET lanes lanes_sqrt(lanes v)
{
#if WIDTH == 8
  return (lanes)_mm256_sqrt_ps((__m256)v);
#elif defined SSE
  return (lanes)_mm_sqrt_ps((__m128)v);
#else
  for (int j = 0; j < WIDTH; j++) v[j] = sqrtf(v[j]);
  return v;
#endif
}

static inline TARGET lanes lanes_min(lanes a, lanes b)
{
#if WIDTH == 8
  return (lanes)_mm256_min_ps((__m256)a, (__m256)b);
#elif defined SSE
  return (lanes)_mm_min_ps((__m128)a, (__m128)b);
#else
  return lanes_choose((masks)(a < b), a, b);
#endif
}

static inline TARGET float least_lane(lanes v)
{
#if WIDTH == 8
  v = lanes_min(v, __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3));
  v = lanes_min(v, __builtin_shufflevector(v, v, 2, 3, 0, 1, 6, 7, 4, 5));
  v = lanes_min(v, __builtin_shufflevector(v, v, 1, 0, 3, 2, 5, 4, 7, 6));
#else
  v = lanes_min(v, __builtin_shufflevector(v, v, 2, 3, 0, 1));
  v = lanes_min(v, __builtin_shufflevector(v, v, 1, 0, 3, 2));
#endif
  return v[0];
}

static inline TARGET float least_of(const lanes v[PARTS])
{
  lanes least = v[0];

  for (int j = 1; j < PARTS; j++) least = lanes_min(least, v[j]);
  return least_lane(least);
}

/* Numbers of the children in part j. */
static inline TARGET masks children(int j)
{
#if WIDTH == 8
  const masks first = { 0, 1, 2, 3, 4, 5, 6, 7 };
#else
  const masks first = { 0, 1, 2, 3 };
#endif

  return first + WIDTH * j;
}

/* Distances between a box x +- reach and WIDTH boxes mid +- half (NULL:
 * points). Lanes of axis k are `step` floats after those of axis k - 1. */
static inline TARGET lanes distances(const float x[3], const float reach[3],
                                     const float *mid, const float *half,
                                     size_t step)
{
  lanes sum = { 0 };

  for (size_t k = 0; k < 3; k++) {
    lanes a = lanes_abs(x[k] - load(mid + k * step)) - reach[k];

    if (half) a -= load(half + k * step);
    a = lanes_max0(a);
    sum += a * a;
  }
  return lanes_sqrt(sum);
}

/* Values of sizes h at distance d, from above and from below. */
static inline TARGET lanes grown(const struct vg_bvh *t, lanes h, lanes d)
{
  lanes v = h * (1 - t->offset) + t->slope * d;

  return lanes_choose((masks)(v > h), v, h);
}

static inline TARGET lanes fallen(const struct vg_bvh *t, lanes h, lanes d)
{
  lanes v = lanes_min(h * (1 + t->offset) - t->slope * d,
                      h * t->rise - t->steep * d);

  return lanes_choose((masks)(v < h), v, h);
}

static inline TARGET void relative(const struct search *q,
                                   const double origin[3], float x[3])
{
  for (int k = 0; k < 3; k++) x[k] = (float)(q->mid[k] - origin[k]);
}

static TARGET void visit_above(struct search *q, const struct vg_bvh_block *b)
{
  lanes v[PARTS];
  float x[3], least;

  relative(q, b->origin, x);
  for (int j = 0; j < PARTS; j++) {
    lanes d = distances(x, q->half, b->p[0] + WIDTH * j, NULL, LANES);

    v[j] = grown(q->t, load(b->h + WIDTH * j), d);
  }
  least = least_of(v);
  if (!(least < q->best)) return;
  q->best = least;
  q->hint = (uint32_t)(b - q->t->block);
}

/* Bounds of the children of a group. They allow for rounding, so that the
 * result is the best of all samples, regardless of the start of the search.
 * The last bits of each bound hold the index of the child. */
static inline TARGET void bounds_above(const struct search *q,
                                       const struct vg_bvh_group *g,
                                       lanes bound[PARTS])
{
  float x[3];

  relative(q, g->origin, x);
  for (int j = 0; j < PARTS; j++) {
    lanes d = distances(x, q->half, g->mid[0] + WIDTH * j,
                        g->half[0] + WIDTH * j, LANES);

    d = grown(q->t, load(g->h_min + WIDTH * j), d) * (1 - SHY);
    bound[j] = (lanes)(((masks)d & ~7) | children(j));
  }
}

/* Return the child with the smallest bound, and set that bound to INFINITY.
 * Returns LANES if no bound is below `best`. */
static inline TARGET unsigned take_least(lanes bound[PARTS], float best)
{
  float least = least_of(bound);
  const lanes none = INFINITY - (lanes){ 0 };
  uint32_t bits;

  if (!(least < best)) return LANES;
  for (int j = 0; j < PARTS; j++)
    bound[j] = lanes_choose((masks)(bound[j] == least), none, bound[j]);
  memcpy(&bits, &least, sizeof bits);
  return bits & 7;
}

/* The nearest child comes first, so that others are seldom entered. The depth
 * of recursion is that of the hierarchy: 8^12 samples at most. */
static TARGET void descend_above(struct search *q, int level, size_t at)
{
  lanes bound[PARTS];
  unsigned j;

  bounds_above(q, q->tree->group[level] + at, bound);
  while ((j = take_least(bound, q->best)) < LANES) {
    if (level) descend_above(q, level - 1, at * LANES + j);
    else visit_above(q, q->tree->block + at * LANES + j);
  }
}

static TARGET void above_all(struct search *q, const struct vg_bvh_reach *r)
{
  const struct vg_bvh *t = q->t;

  for (int c = 0; c < t->n_tree; c++) {
    q->tree = t->tree + c;
    if (q->tree->h_min > q->best) break;
    if (!r) descend_above(q, q->tree->n_level - 1, 0);
    else if (r->level[c] >= 0) descend_above(q, r->level[c], r->start[c]);
  }
}

static TARGET void set_box(struct search *q, const double lo[3],
                           const double hi[3])
{
  for (int k = 0; k < 3; k++) {
    q->half[k] = (float)(0.5 * (hi[k] - lo[k]));
    q->mid[k] = 0.5 * (lo[k] + hi[k]);
  }
}

/* Descend to the lowest group of a tree with all samples below q->best. Returns
 * its level, or -1 if no sample has such a value. */
static TARGET int find_start(const struct search *q, uint32_t *start)
{
  int level = q->tree->n_level - 1;

  *start = 0;
  for (;;) {
    lanes bound[PARTS];
    unsigned j;

    bounds_above(q, q->tree->group[level] + *start, bound);
    j = take_least(bound, q->best);
    if (j == LANES) return -1;
    if (!level || least_of(bound) < q->best) return level;
    *start = *start * LANES + j;
    level--;
  }
}

/* No value in the box exceeds that at its centre by more than the growth to its
 * corners. */
static TARGET void know_start(const struct vg_bvh *t, struct vg_bvh_reach *r,
                              uint32_t hint)
{
  struct search q = { .t = t,
                      .best = VG_BVH_NEVER,
                      .mid = { r->mid[0], r->mid[1], r->mid[2] } };

  visit_above(&q, t->block + hint);
  above_all(&q, NULL);
  for (int k = 0; k < 3; k++) q.half[k] = (float)r->half * (1 + SHY);
  q.best = (q.best + t->slope * 1.7321f * (float)r->half) * (1 + SHY);
  for (int c = 0; c < t->n_tree; c++) {
    q.tree = t->tree + c;
    r->level[c] = (int8_t)find_start(&q, r->start + c);
  }
  r->has_start = 1;
}

TARGET double ABOVE(const struct vg_bvh *t, const double lo[3],
                    const double hi[3], double below,
                    struct vg_bvh_reach *reach, uint32_t *hint)
{
  assert(hint && lo[0] <= hi[0] && lo[1] <= hi[1] && lo[2] <= hi[2]);

  const float start = below < 0.1 * (double)VG_BVH_NEVER ? (float)below
                                                         : 0.1f * VG_BVH_NEVER;
  struct search q = { .t = t, .best = start, .hint = *hint };

  if (reach && !reach->has_start) know_start(t, reach, *hint);
  set_box(&q, lo, hi);
  visit_above(&q, t->block + *hint);
  above_all(&q, reach);
  *hint = q.hint;
  return q.best < start ? (double)q.best : below;
}

/* --- from below ----------------------------------------------------------- */

static TARGET void visit_below(struct search *q, const struct vg_bvh_block *b)
{
  float x[3], v[LANES];

  relative(q, b->origin, x);
  for (int j = 0; j < LANES; j += WIDTH) {
    lanes d = distances(x, q->half, b->p[0] + j, NULL, LANES);

    store(v + j, fallen(q->t, load(b->h + j), d));
  }
  for (int j = 0; j < LANES; j++) {
    if (!(v[j] > q->best)) continue;
    q->best = v[j];
    q->by = b->h[j];
  }
}

/* Only values above the best one so far, which is positive, matter. Signs are
 * inverted, so that the best bound is the smallest. */
static TARGET void descend_below(struct search *q, int level, size_t at)
{
  const struct vg_bvh_group *g = q->tree->group[level] + at;
  const lanes none = INFINITY - (lanes){ 0 };
  lanes bound[PARTS];
  float x[3];
  unsigned i;

  relative(q, g->origin, x);
  for (int j = 0; j < PARTS; j++) {
    lanes h = load(g->h_max + WIDTH * j);
    lanes d = distances(x, q->half, g->mid[0] + WIDTH * j,
                        g->half[0] + WIDTH * j, LANES);

    d = fallen(q->t, h, d) + h * SHY;
    bound[j] = lanes_choose((masks)(d > 0),
                            -(lanes)(((masks)d & ~7) | children(j)), none);
  }
  while (q->best < q->enough && (i = take_least(bound, -q->best)) < LANES) {
    if (level) descend_below(q, level - 1, at * LANES + i);
    else visit_below(q, q->tree->block + at * LANES + i);
  }
}

static TARGET void know_reach(const struct vg_bvh *t, struct vg_bvh_reach *r)
{
  for (int c = 0; c < t->n_tree; c++) {
    struct search q = { .t = t,
                        .tree = t->tree + c,
                        .best = r->trifle,
                        .enough = INFINITY,
                        .mid = { r->mid[0], r->mid[1], r->mid[2] } };

    descend_below(&q, q.tree->n_level - 1, 0);
    r->most[c] = q.best;
  }
  r->is_known = 1;
}

TARGET double BELOW(const struct vg_bvh *t, const double x[3], double above,
                    double enough, struct vg_bvh_reach *reach, double *by)
{
  assert(by);

  struct search q = { .t = t,
                      .best = (float)above,
                      .enough = (float)enough,
                      .mid = { x[0], x[1], x[2] } };
  float more = 0;

  if (reach) {
    double d2 = 0;

    if (!reach->is_known) know_reach(t, reach);
    for (int k = 0; k < 3; k++)
      d2 += (x[k] - reach->mid[k]) * (x[k] - reach->mid[k]);
    more = t->steep * (float)sqrt(d2);
  }
  for (int c = t->n_tree - 1; c >= 0; c--) {
    q.tree = t->tree + c;
    if (q.tree->h_max <= q.best || q.best >= q.enough) break;
    if (reach && (reach->most[c] + more) * (1 + SHY) <= q.best) continue;
    descend_below(&q, q.tree->n_level - 1, 0);
  }
  *by = (double)q.by;
  return (double)q.best;
}
