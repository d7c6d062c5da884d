#include "core/sizing_near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "base/memory.h"

/* Samples in the order of a k-d tree, eight to a block; blocks eight to a
 * group, groups eight to a group above, up to one root. Eight lanes each, in
 * loops that compilers turn into vectors. Positions are single precision and
 * relative to an origin of the block or group, so that rounding is relative
 * to the distance itself, however wide the span of sizes is; SHY allows for
 * it where a bound must not be too high. */
#define LANES 8
#define MAX_LEVEL 12
#define SHY 2e-6f

struct block {
  double origin[3];
  float p[3][LANES], h[LANES];
};

struct group {
  double origin[3];
  float mid[3][LANES], half[3][LANES], h_min[LANES], h_max[LANES];
};

struct vg_near {
  struct block *block;   /* [n_block] */
  struct group *group;   /* all levels, the lowest first */
  size_t n_block, start[MAX_LEVEL];
  int n_level;
  float slope, offset;
};

/* Order of the samples: medians of the longest side, again and again. */

struct key {
  float p[3];
  uint32_t at;
};

static int key_less(const struct key *a, const struct key *b, int axis)
{
  if (a->p[axis] != b->p[axis]) return a->p[axis] < b->p[axis];
  return a->at < b->at;
}

/* Median of first, middle and last. */
static struct key choose_pivot(const struct key *a, size_t n, int axis)
{
  const struct key *x = a, *y = a + n / 2, *z = a + n - 1, *swap;

  if (key_less(y, x, axis)) {
    swap = x;
    x = y;
    y = swap;
  }
  if (key_less(z, y, axis)) y = key_less(z, x, axis) ? x : z;
  return *y;
}

/* Partition: the m least of n keys come first. Every other pivot is half way
 * between the extremes, which bounds the rounds for any input. */
static void select_keys(struct key *a, size_t n, size_t m, int axis)
{
  for (int round = 0; n > 1 && m > 0 && m < n; round++) {
    struct key pivot = choose_pivot(a, n, axis);
    size_t i = 0, j = n;

    if (round % 4 == 3) {
      float lo = a[0].p[axis], hi = lo;

      for (size_t k = 1; k < n; k++) {
        lo = a[k].p[axis] < lo ? a[k].p[axis] : lo;
        hi = a[k].p[axis] > hi ? a[k].p[axis] : hi;
      }
      pivot.p[axis] = 0.5f * lo + 0.5f * hi;
    }
    for (;;) {
      while (i < j && key_less(a + i, &pivot, axis)) i++;
      while (i < j && !key_less(a + j - 1, &pivot, axis)) j--;
      if (i >= j) break;
      struct key swap = a[i];

      a[i++] = a[--j];
      a[j] = swap;
    }
    if (!i) { /* the pivot is the least: put it first */
      for (size_t k = 1; k < n; k++)
        if (key_less(a + k, a + i, axis)) i = k;
      pivot = a[i];
      a[i] = a[0];
      a[0] = pivot;
      i = 1;
    }
    if (m < i) {
      n = i;
    } else {
      a += i;
      m -= i;
      n -= i;
    }
  }
}

static int longest_side(const struct key *a, size_t n)
{
  float best = -1;
  int axis = 0;

  for (int k = 0; k < 3; k++) {
    float lo = a[0].p[k], hi = lo;

    for (size_t i = 1; i < n; i++) {
      lo = a[i].p[k] < lo ? a[i].p[k] : lo;
      hi = a[i].p[k] > hi ? a[i].p[k] : hi;
    }
    if (hi - lo <= best) continue;
    best = hi - lo;
    axis = k;
  }
  return axis;
}

/* Order n keys into runs of `unit` for the lanes of one node, each of them
 * in order within; unit is 8^level. */
static void order_keys(struct key *a, size_t n, size_t unit)
{
  size_t lane = (n + unit - 1) / unit, m = lane / 2 * unit;

  while (unit > LANES && lane == 1) {
    unit /= LANES;
    lane = (n + unit - 1) / unit;
    m = lane / 2 * unit;
  }
  if (lane <= 1) return;
  select_keys(a, n, m, longest_side(a, n));
  order_keys(a, m, unit);
  order_keys(a + m, n - m, unit);
}

static void order_samples(size_t n, const double (*p)[3], struct key *key)
{
  size_t unit = LANES;

  for (size_t i = 0; i < n; i++) {
    key[i].at = (uint32_t)i;
    for (int k = 0; k < 3; k++) key[i].p[k] = (float)(p[i][k] - p[0][k]);
  }
  while (unit < n) unit *= LANES;
  order_keys(key, n, unit);
}

/* The last block is padded by repeating its last sample. */
static void fill_blocks(struct vg_near *t, size_t n, const double (*p)[3],
                        const double *h, const struct key *key)
{
  for (size_t i = 0; i < t->n_block * LANES; i++) {
    size_t from = key[i < n ? i : n - 1].at;
    struct block *b = t->block + i / LANES;

    b->h[i % LANES] = (float)h[from];
    for (int k = 0; k < 3; k++) {
      if (!(i % LANES)) b->origin[k] = p[from][k];
      b->p[k][i % LANES] = (float)(p[from][k] - b->origin[k]);
    }
  }
}

/* Box and sizes of what one lane of a group holds. */
struct bound {
  double lo[3], hi[3];
  float h_min, h_max;
};

static void bound_block(const struct block *b, struct bound *out)
{
  out->h_min = out->h_max = b->h[0];
  for (int k = 0; k < 3; k++) out->lo[k] = out->hi[k] = b->origin[k];
  for (int i = 0; i < LANES; i++) {
    for (int k = 0; k < 3; k++) {
      double v = b->origin[k] + (double)b->p[k][i];

      if (v < out->lo[k]) out->lo[k] = v;
      if (v > out->hi[k]) out->hi[k] = v;
    }
    if (b->h[i] < out->h_min) out->h_min = b->h[i];
    if (b->h[i] > out->h_max) out->h_max = b->h[i];
  }
}

static void join(struct bound *a, const struct bound *b)
{
  for (int k = 0; k < 3; k++) {
    if (b->lo[k] < a->lo[k]) a->lo[k] = b->lo[k];
    if (b->hi[k] > a->hi[k]) a->hi[k] = b->hi[k];
  }
  if (b->h_min < a->h_min) a->h_min = b->h_min;
  if (b->h_max > a->h_max) a->h_max = b->h_max;
}

/* Group of n <= LANES bounds; an empty lane is never entered. */
static void fill_group(const struct bound *from, size_t n, struct group *g)
{
  memset(g, 0, sizeof *g);
  for (int k = 0; k < 3; k++)
    g->origin[k] = 0.5 * (from[0].lo[k] + from[0].hi[k]);
  for (size_t j = 0; j < LANES; j++) {
    g->h_min[j] = j < n ? from[j].h_min : INFINITY;
    g->h_max[j] = j < n ? from[j].h_max : -INFINITY;
    for (int k = 0; k < 3 && j < n; k++) {
      double half = 0.5 * (from[j].hi[k] - from[j].lo[k]);
      double mid = from[j].lo[k] + half - g->origin[k];

      g->mid[k][j] = (float)mid;
      g->half[k][j] = (float)((half + fabs(mid) * (double)SHY) * 1.000001);
    }
  }
}

/* Groups level by level; bound[] shrinks to the bounds of the level above. */
static void fill_groups(struct vg_near *t, struct bound *bound)
{
  size_t n = t->n_block, at = 0;

  for (size_t i = 0; i < n; i++) bound_block(t->block + i, bound + i);
  for (int level = 0; level < t->n_level; level++) {
    size_t n_up = (n + LANES - 1) / LANES;

    t->start[level] = at;
    for (size_t i = 0; i < n_up; i++) {
      size_t m = n - i * LANES < LANES ? n - i * LANES : LANES;
      struct bound all = bound[i * LANES];

      fill_group(bound + i * LANES, m, t->group + at + i);
      for (size_t j = 1; j < m; j++) join(&all, bound + i * LANES + j);
      bound[i] = all;
    }
    at += n_up;
    n = n_up;
  }
}

vg_status vg_near_new(size_t n, const double (*p)[3], const double *h,
                      double slope, struct vg_near **out,
                      struct vg_error *err)
{
  struct vg_near *t = vg_calloc(1, sizeof *t);
  struct key *key = vg_alloc(n, sizeof *key);
  struct bound *bound = vg_alloc(n / LANES + 1, sizeof *bound);
  size_t n_group = 0, m;

  if (!t || !key || !bound) goto refused;
  if (n > UINT32_MAX / 2) goto refused;
  t->slope = (float)slope;
  t->offset = (float)(slope * VG_NEAR_PLATEAU < VG_NEAR_OFFSET
                        ? slope * VG_NEAR_PLATEAU : VG_NEAR_OFFSET);
  m = t->n_block = (n + LANES - 1) / LANES;
  do {
    m = (m + LANES - 1) / LANES;
    n_group += m;
    t->n_level++;
  } while (m > 1);
  t->block = vg_alloc(t->n_block, sizeof *t->block);
  t->group = vg_alloc(n_group, sizeof *t->group);
  if (!t->block || !t->group) goto refused;
  order_samples(n, p, key);
  fill_blocks(t, n, p, h, key);
  fill_groups(t, bound);
  free(bound);
  free(key);
  *out = t;
  return VG_OK;
refused:
  free(bound);
  free(key);
  vg_near_free(t);
  return vg_fail_memory(err, "the sizes on the surface");
}

void vg_near_free(struct vg_near *t)
{
  if (!t) return;
  free(t->block);
  free(t->group);
  free(t);
}

/* Searches. Recursion is as deep as the hierarchy: 8^12 samples at most. */

struct search {
  const struct vg_near *t;
  double mid[3];
  float half[3], best, sloppy; /* sloppy: relative error allowed */
  uint32_t hint;
};

/* Four lanes at once, in the vectors of gcc and clang; sqrt alone needs help.
 * Every operation rounds as its scalar form does, so machines agree. */
typedef float lanes __attribute__((vector_size(16)));
typedef int32_t masks __attribute__((vector_size(16)));

static inline lanes load(const float *p)
{
  lanes v;

  memcpy(&v, p, sizeof v);
  return v;
}

static inline void store(float *p, lanes v)
{
  memcpy(p, &v, sizeof v);
}

static inline lanes lanes_abs(lanes v)
{
  return (lanes)((masks)v & 0x7fffffff);
}

static inline lanes lanes_max0(lanes v)
{
  return (lanes)((masks)v & (masks)(v > 0));
}

static inline lanes lanes_max(lanes a, lanes b)
{
  masks m = (masks)(a > b);

  return (lanes)(((masks)a & m) | ((masks)b & ~m));
}

static inline lanes lanes_sqrt(lanes v)
{
#ifdef __SSE2__
  return (lanes)_mm_sqrt_ps((__m128)v);
#else
  for (int j = 0; j < 4; j++) v[j] = sqrtf(v[j]);
  return v;
#endif
}

/* Distances between the box of the search and eight boxes (half NULL: points)
 * around mid, relative to an origin. */
static inline void distances(const struct search *q, const double origin[3],
                             const float mid[3][LANES],
                             const float (*half)[LANES], float d[LANES])
{
  lanes x[3], h[3];

  for (int k = 0; k < 3; k++) {
    x[k] = (float)(q->mid[k] - origin[k]) - (lanes){ 0 };
    h[k] = q->half[k] - (lanes){ 0 };
  }
  for (int j = 0; j < LANES; j += 4) {
    lanes sum = { 0 };

    for (int k = 0; k < 3; k++) {
      lanes a = lanes_abs(x[k] - load(mid[k] + j)) - h[k];

      if (half) a -= load(half[k] + j);
      a = lanes_max0(a);
      sum += a * a;
    }
    store(d + j, lanes_sqrt(sum));
  }
}

static void visit_block(struct search *q, uint32_t at)
{
  const struct block *b = q->t->block + at;
  const float keep = 1 - q->t->offset, slope = q->t->slope;
  float v[LANES], best = q->best;

  distances(q, b->origin, b->p, NULL, v);
  for (int j = 0; j < LANES; j += 4) {
    lanes h = load(b->h + j);

    store(v + j, lanes_max(h * keep + slope * load(v + j), h));
  }
  for (int j = 0; j < LANES; j++) best = v[j] < best ? v[j] : best;
  if (!(best < q->best)) return;
  q->best = best;
  q->hint = at;
}

/* Nearest child first, so that the rest is seldom entered. */
static void descend_above(struct search *q, int level, uint32_t at)
{
  const struct vg_near *t = q->t;
  const struct group *g = t->group + t->start[level] + at;
  const float keep = 1 - t->offset, slope = t->slope;
  float bound[LANES];

  distances(q, g->origin, g->mid, g->half, bound);
  for (int j = 0; j < LANES; j += 4) {
    lanes h = load(g->h_min + j);

    store(bound + j, lanes_max(h * keep + slope * load(bound + j), h) *
                     (1 - SHY));
  }
  for (;;) {
    float least = q->best * (1 - q->sloppy);
    int first = LANES;

    for (int j = 0; j < LANES; j++)
      if (bound[j] < least) {
        least = bound[j];
        first = j;
      }
    if (first == LANES) return;
    bound[first] = INFINITY;
    if (level) descend_above(q, level - 1, at * LANES + (uint32_t)first);
    else visit_block(q, at * LANES + (uint32_t)first);
  }
}

double vg_near_above(const struct vg_near *t, const double lo[3],
                     const double hi[3], double below, double sloppy,
                     uint32_t *hint)
{
  struct search q = { .t = t, .best = (float)below, .hint = *hint,
                      .sloppy = (float)sloppy };

  for (int k = 0; k < 3; k++) {
    q.half[k] = (float)(0.5 * (hi[k] - lo[k]));
    q.mid[k] = 0.5 * (lo[k] + hi[k]);
  }
  visit_block(&q, *hint);
  descend_above(&q, t->n_level - 1, 0);
  *hint = q.hint;
  return (double)q.best;
}

static void visit_block_below(struct search *q, uint32_t at)
{
  const struct block *b = q->t->block + at;
  float d[LANES];

  distances(q, b->origin, b->p, NULL, d);
  for (int j = 0; j < LANES; j++) {
    float left = b->h[j] * (1 + q->t->offset) - q->t->slope * d[j];

    left = left < b->h[j] ? left : b->h[j];
    q->best = left > q->best ? left : q->best;
  }
}

static void descend_below(struct search *q, int level, uint32_t at)
{
  const struct vg_near *t = q->t;
  const struct group *g = t->group + t->start[level] + at;
  const float keep = 1 + t->offset, slope = t->slope;
  float bound[LANES];

  distances(q, g->origin, g->mid, g->half, bound);
  for (int j = 0; j < LANES; j++) {
    float left = g->h_max[j] * keep - slope * bound[j];

    bound[j] = left < g->h_max[j] ? left : g->h_max[j];
  }
  for (;;) {
    float most = q->best * (1 + q->sloppy);
    int first = LANES;

    for (int j = 0; j < LANES; j++)
      if (bound[j] > most) {
        most = bound[j];
        first = j;
      }
    if (first == LANES) return;
    bound[first] = -INFINITY;
    if (level) descend_below(q, level - 1, at * LANES + (uint32_t)first);
    else visit_block_below(q, at * LANES + (uint32_t)first);
  }
}

double vg_near_below(const struct vg_near *t, const double x[3],
                     double above, double sloppy)
{
  struct search q = { .t = t, .best = (float)above, .sloppy = (float)sloppy,
                      .mid = { x[0], x[1], x[2] } };

  descend_below(&q, t->n_level - 1, 0);
  return (double)q.best;
}
