#include "core/sizing_near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "base/memory.h"
#include "base/parallel.h"

/* Samples are classed by size, so that large and small ones do not spoil each
 * other's bounds; each class is a tree: samples in the order of a k-d tree,
 * eight to a block, blocks eight to a group, groups eight to a group above,
 * up to one root. Eight lanes each, in
 * loops that compilers turn into vectors. Positions are single precision and
 * relative to an origin of the block or group, so that rounding is relative
 * to the distance itself, however wide the span of sizes is; SHY allows for
 * it where a bound must not be too high. */
#define LANES 8
#define MAX_LEVEL 12
#define MAX_CLASS 16     /* sizes within a factor of four; the last: others */
#define SHY 2e-6f

struct block {
  double origin[3];
  float p[3][LANES], h[LANES];
};

struct group {
  double origin[3];
  float mid[3][LANES], half[3][LANES], h_min[LANES], h_max[LANES];
};

struct tree {
  const struct block *block;
  const struct group *group[MAX_LEVEL]; /* the lowest level first */
  int n_level;
  float h_min, h_max;
};

struct vg_near {
  struct block *block;   /* of all trees, one after the other */
  struct group *group;
  struct tree tree[MAX_CLASS];
  int n_tree;
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

/* Keys that one thread orders alone. */
#define RANGE 8192

struct range {
  struct key *key;
  size_t n, unit;
};

/* As order_keys, the longer ranges halved round by round: range i becomes
 * 2 i and 2 i + 1. */
static void halve_body(void *context, size_t first, size_t end, int worker)
{
  struct range *range = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct range *r = range + 2 * i, *up = r + 1;
    size_t lane;

    *up = (struct range){ r->key, 0, LANES };
    while (r->unit > LANES && r->n <= r->unit) r->unit /= LANES;
    if (r->n <= RANGE) continue;
    lane = (r->n + r->unit - 1) / r->unit;
    up->unit = r->unit;
    up->n = r->n - lane / 2 * r->unit;
    r->n -= up->n;
    up->key = r->key + r->n;
    select_keys(r->key, r->n + up->n, r->n,
                longest_side(r->key, r->n + up->n));
  }
}

static void order_body(void *context, size_t first, size_t end, int worker)
{
  struct range *r = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    order_keys(r[i].key, r[i].n, r[i].unit);
}

/* Ranges are spread over the array for the next round, from the end. */
static int order_samples(struct key *key, size_t n, int threads)
{
  size_t unit = LANES, n_range = 1, most = 1;
  struct range *range;

  while (unit < n) unit *= LANES;
  while (most < n / (RANGE / 8)) most *= 2;
  range = vg_alloc(2 * most, sizeof *range);
  if (!range) return -1;
  range[0] = (struct range){ key, n, unit };
  while (n_range < most) {
    for (size_t i = n_range; i-- > 0;) range[2 * i] = range[i];
    vg_parallel_for(threads, n_range, 1, halve_body, range);
    n_range *= 2;
  }
  vg_parallel_for(threads, n_range, 1, order_body, range);
  free(range);
  return 0;
}

static int size_class(double h, double least)
{
  int c = 0;

  for (least *= 4; h > least && c < MAX_CLASS - 1; least *= 4) c++;
  return c;
}

/* Keys by class of size, the classes in order; count gets how many each. */
static void classify(size_t n, const double (*p)[3], const double *h,
                     struct key *key, size_t count[MAX_CLASS])
{
  double least = h[0];
  size_t at[MAX_CLASS];

  for (size_t i = 1; i < n; i++) least = h[i] < least ? h[i] : least;
  memset(count, 0, MAX_CLASS * sizeof *count);
  for (size_t i = 0; i < n; i++) count[size_class(h[i], least)]++;
  at[0] = 0;
  for (int c = 1; c < MAX_CLASS; c++) at[c] = at[c - 1] + count[c - 1];
  for (size_t i = 0; i < n; i++) {
    struct key *a = key + at[size_class(h[i], least)]++;

    a->at = (uint32_t)i;
    for (int k = 0; k < 3; k++) a->p[k] = (float)(p[i][k] - p[0][k]);
  }
}

/* The last block is padded by repeating its last sample. */
static void fill_blocks(struct block *block, size_t n, const double (*p)[3],
                        const double *h, const struct key *key)
{
  for (size_t i = 0; i < n || i % LANES; i++) {
    size_t from = key[i < n ? i : n - 1].at;
    struct block *b = block + i / LANES;

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

/* Groups level by level, over n blocks; bound[] shrinks to the bounds of the
 * level above. Returns the number of groups. */
static size_t fill_groups(struct tree *t, size_t n, struct group *group,
                          struct bound *bound)
{
  size_t at = 0;

  for (size_t i = 0; i < n; i++) bound_block(t->block + i, bound + i);
  do {
    size_t n_up = (n + LANES - 1) / LANES;

    t->group[t->n_level++] = group + at;
    for (size_t i = 0; i < n_up; i++) {
      size_t m = n - i * LANES < LANES ? n - i * LANES : LANES;
      struct bound all = bound[i * LANES];

      fill_group(bound + i * LANES, m, group + at + i);
      for (size_t j = 1; j < m; j++) join(&all, bound + i * LANES + j);
      bound[i] = all;
    }
    at += n_up;
    n = n_up;
  } while (n > 1);
  t->h_min = bound[0].h_min;
  t->h_max = bound[0].h_max;
  return at;
}

static int fill_trees(struct vg_near *t, const double (*p)[3],
                      const double *h, struct key *key,
                      const size_t count[MAX_CLASS], struct bound *bound,
                      int threads)
{
  struct block *block = t->block;
  struct group *group = t->group;

  for (int c = 0; c < MAX_CLASS; c++) {
    size_t n_block = (count[c] + LANES - 1) / LANES;

    if (!n_block) continue;
    if (order_samples(key, count[c], threads)) return -1;
    fill_blocks(block, count[c], p, h, key);
    t->tree[t->n_tree].block = block;
    group += fill_groups(t->tree + t->n_tree++, n_block, group, bound);
    block += n_block;
    key += count[c];
  }
  return 0;
}

vg_status vg_near_new(size_t n, const double (*p)[3], const double *h,
                      double slope, int threads, struct vg_near **out,
                      struct vg_error *err)
{
  struct vg_near *t = vg_calloc(1, sizeof *t);
  struct key *key = vg_alloc(n, sizeof *key);
  size_t count[MAX_CLASS], n_block = n / LANES + MAX_CLASS;
  struct bound *bound = vg_alloc(n_block, sizeof *bound);

  if (!t || !key || !bound || n > UINT32_MAX / 2) goto refused;
  t->slope = (float)slope;
  t->offset = (float)(slope * VG_NEAR_PLATEAU < VG_NEAR_OFFSET
                        ? slope * VG_NEAR_PLATEAU : VG_NEAR_OFFSET);
  t->block = vg_alloc(n_block, sizeof *t->block);
  /* a seventh of the blocks, and what is not full on each level */
  t->group = vg_alloc(n_block / 7 + MAX_CLASS * MAX_LEVEL,
                      sizeof *t->group);
  if (!t->block || !t->group) goto refused;
  classify(n, p, h, key, count);
  if (fill_trees(t, p, h, key, count, bound, threads)) goto refused;
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
  const struct tree *tree;
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

static void visit_block(struct search *q, const struct block *b)
{
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
  q->hint = (uint32_t)(b - q->t->block);
}

/* Nearest child first, so that the rest is seldom entered. */
static void descend_above(struct search *q, int level, size_t at)
{
  const struct vg_near *t = q->t;
  const struct group *g = q->tree->group[level] + at;
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
    if (level) descend_above(q, level - 1, at * LANES + (size_t)first);
    else visit_block(q, q->tree->block + at * LANES + first);
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
  visit_block(&q, t->block + *hint);
  for (int c = 0; c < t->n_tree; c++) {
    q.tree = t->tree + c;
    if (q.tree->h_min * (1 - q.sloppy) > q.best) break;
    descend_above(&q, q.tree->n_level - 1, 0);
  }
  *hint = q.hint;
  return (double)q.best;
}

static void visit_block_below(struct search *q, const struct block *b)
{
  float d[LANES];

  distances(q, b->origin, b->p, NULL, d);
  for (int j = 0; j < LANES; j++) {
    float left = b->h[j] * (1 + q->t->offset) - q->t->slope * d[j];

    left = left < b->h[j] ? left : b->h[j];
    q->best = left > q->best ? left : q->best;
  }
}

static void descend_below(struct search *q, int level, size_t at)
{
  const struct vg_near *t = q->t;
  const struct group *g = q->tree->group[level] + at;
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
    if (level) descend_below(q, level - 1, at * LANES + (size_t)first);
    else visit_block_below(q, q->tree->block + at * LANES + first);
  }
}

double vg_near_below(const struct vg_near *t, const double x[3],
                     double above, double sloppy)
{
  struct search q = { .t = t, .best = (float)above, .sloppy = (float)sloppy,
                      .mid = { x[0], x[1], x[2] } };

  for (int c = t->n_tree - 1; c >= 0; c--) {
    q.tree = t->tree + c;
    if (q.tree->h_max <= q.best) break;
    descend_below(&q, q.tree->n_level - 1, 0);
  }
  return (double)q.best;
}
