#include "core/sizing_near.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Samples sorted along Morton's curve, eight to a block; blocks eight to a
 * group, groups eight to a group above, up to one root. Eight lanes each, so
 * that the compiler makes vectors of the loops. Boxes are single precision
 * and relative to `origin`; bounds from them carry `slack` for its rounding,
 * values come from the samples in double precision. */
#define LANES 8
#define MAX_LEVEL 12

struct block {
  double x[LANES], y[LANES], z[LANES], h[LANES];
};

struct group {
  float lo[3][LANES], hi[3][LANES], h_min[LANES], h_max[LANES];
};

struct vg_near {
  struct block *block;   /* [n_block] */
  struct group *group;   /* all levels, the lowest first */
  size_t n_block, start[MAX_LEVEL];
  int n_level;
  double origin[3], slope, offset;
  float slack;
};

static float float_down(double v)
{
  float f = (float)v;

  return f > v ? nextafterf(f, -INFINITY) : f;
}

static float float_up(double v)
{
  float f = (float)v;

  return f < v ? nextafterf(f, INFINITY) : f;
}

/* Every third bit of the result is one of the low 21 bits of v. */
static uint64_t spread(uint64_t v)
{
  v &= 0x1fffff;
  v = (v | v << 32) & 0x1f00000000ffffull;
  v = (v | v << 16) & 0x1f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

struct key {
  uint64_t code;
  uint32_t at;
};

/* Stable radix sort, least byte first; the result is in `a`. */
static void sort_keys(struct key *a, struct key *b, size_t n)
{
  for (int shift = 0; shift < 64; shift += 8) {
    size_t count[257] = { 0 };
    struct key *swap = a;

    for (size_t i = 0; i < n; i++) count[(a[i].code >> shift & 255) + 1]++;
    for (int k = 0; k < 256; k++) count[k + 1] += count[k];
    for (size_t i = 0; i < n; i++)
      b[count[a[i].code >> shift & 255]++] = a[i];
    a = b;
    b = swap;
  }
}

/* Order of the samples along the curve within their own bounding cube. */
static void order_samples(struct vg_near *t, size_t n, const double (*p)[3],
                          struct key *key)
{
  double lo[3], side = 0;

  for (int k = 0; k < 3; k++) {
    double hi = lo[k] = p[0][k];

    for (size_t i = 1; i < n; i++) {
      if (p[i][k] < lo[k]) lo[k] = p[i][k];
      if (p[i][k] > hi) hi = p[i][k];
    }
    t->origin[k] = 0.5 * (lo[k] + hi);
    if (hi - lo[k] > side) side = hi - lo[k];
  }
  t->slack = (float)(side * t->slope * 1e-6);
  side = side > 0 ? 2097151 / side : 0;
  for (size_t i = 0; i < n; i++) {
    key[i].at = (uint32_t)i;
    key[i].code = spread((uint64_t)((p[i][0] - lo[0]) * side)) |
                  spread((uint64_t)((p[i][1] - lo[1]) * side)) << 1 |
                  spread((uint64_t)((p[i][2] - lo[2]) * side)) << 2;
  }
  sort_keys(key, key + n, n);
}

/* The last block is padded by repeating its last sample. */
static void fill_blocks(struct vg_near *t, size_t n, const double (*p)[3],
                        const double *h, const struct key *key)
{
  for (size_t i = 0; i < t->n_block * LANES; i++) {
    size_t from = key[i < n ? i : n - 1].at;
    struct block *b = t->block + i / LANES;

    b->x[i % LANES] = p[from][0];
    b->y[i % LANES] = p[from][1];
    b->z[i % LANES] = p[from][2];
    b->h[i % LANES] = h[from];
  }
}

/* An empty lane is never entered: it bounds nothing. */
static void clear_lane(struct group *g, int j)
{
  for (int k = 0; k < 3; k++) g->lo[k][j] = g->hi[k][j] = 0;
  g->h_min[j] = INFINITY;
  g->h_max[j] = -INFINITY;
}

static void bound_block(const struct vg_near *t, const struct block *b,
                        struct group *g, int j)
{
  for (int i = 0; i < LANES; i++) {
    double q[3] = { b->x[i], b->y[i], b->z[i] };

    for (int k = 0; k < 3; k++) {
      float lo = float_down(q[k] - t->origin[k]);
      float hi = float_up(q[k] - t->origin[k]);

      if (!i || lo < g->lo[k][j]) g->lo[k][j] = lo;
      if (!i || hi > g->hi[k][j]) g->hi[k][j] = hi;
    }
    if (b->h[i] < g->h_min[j]) g->h_min[j] = float_down(b->h[i]);
    if (b->h[i] > g->h_max[j]) g->h_max[j] = float_up(b->h[i]);
  }
}

static void bound_group(const struct group *from, struct group *g, int j)
{
  int first = 1;

  for (int i = 0; i < LANES; i++) {
    if (from->h_min[i] > from->h_max[i]) continue;
    for (int k = 0; k < 3; k++) {
      if (first || from->lo[k][i] < g->lo[k][j]) g->lo[k][j] = from->lo[k][i];
      if (first || from->hi[k][i] > g->hi[k][j]) g->hi[k][j] = from->hi[k][i];
    }
    if (from->h_min[i] < g->h_min[j]) g->h_min[j] = from->h_min[i];
    if (from->h_max[i] > g->h_max[j]) g->h_max[j] = from->h_max[i];
    first = 0;
  }
}

static void fill_groups(struct vg_near *t)
{
  size_t n = t->n_block, at = 0;

  for (int level = 0; level < t->n_level; level++) {
    size_t n_up = (n + LANES - 1) / LANES;

    t->start[level] = at;
    for (size_t i = 0; i < n_up * LANES; i++) {
      struct group *g = t->group + at + i / LANES;

      clear_lane(g, (int)(i % LANES));
      if (i >= n) continue;
      if (level) bound_group(t->group + t->start[level - 1] + i, g,
                             (int)(i % LANES));
      else bound_block(t, t->block + i, g, (int)(i % LANES));
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
  struct key *key = vg_alloc(n, 2 * sizeof *key);
  size_t n_group = 0, m;

  if (!t || !key) goto refused;
  if (n > UINT32_MAX / 2) goto refused;
  t->slope = slope;
  t->offset = slope * VG_NEAR_PLATEAU < VG_NEAR_OFFSET
                ? slope * VG_NEAR_PLATEAU : VG_NEAR_OFFSET;
  m = t->n_block = (n + LANES - 1) / LANES;
  do {
    m = (m + LANES - 1) / LANES;
    n_group += m;
    t->n_level++;
  } while (m > 1);
  t->block = vg_alloc(t->n_block, sizeof *t->block);
  t->group = vg_alloc(n_group, sizeof *t->group);
  if (!t->block || !t->group) goto refused;
  order_samples(t, n, p, key);
  fill_blocks(t, n, p, h, key);
  fill_groups(t);
  free(key);
  *out = t;
  return VG_OK;
refused:
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
  double lo[3], hi[3], best;
  float flo[3], fhi[3];
  uint32_t hint;
};

static void start_search(struct search *q, const struct vg_near *t,
                         const double lo[3], const double hi[3], double best)
{
  q->t = t;
  q->best = best;
  q->hint = 0;
  for (int k = 0; k < 3; k++) {
    q->lo[k] = lo[k];
    q->hi[k] = hi[k];
    q->flo[k] = float_down(lo[k] - t->origin[k]);
    q->fhi[k] = float_up(hi[k] - t->origin[k]);
  }
}

/* Squared distances between the box of the search and eight boxes. */
static void group_distance(const struct search *q, const struct group *g,
                           float d[LANES])
{
  for (int j = 0; j < LANES; j++) d[j] = 0;
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < LANES; j++) {
      float a = g->lo[k][j] - q->fhi[k], b = q->flo[k] - g->hi[k][j];
      float c = a > b ? a : b;

      c = c > 0 ? c : 0;
      d[j] += c * c;
    }
  for (int j = 0; j < LANES; j++) d[j] = sqrtf(d[j]);
}

static void visit_block(struct search *q, uint32_t at)
{
  const struct block *b = q->t->block + at;
  const double keep = 1 - q->t->offset, slope = q->t->slope;
  double v[LANES];

  for (int j = 0; j < LANES; j++) {
    double x = b->x[j] - q->hi[0], y = b->y[j] - q->hi[1];
    double z = b->z[j] - q->hi[2];
    double x0 = q->lo[0] - b->x[j], y0 = q->lo[1] - b->y[j];
    double z0 = q->lo[2] - b->z[j], grown;

    x = x > x0 ? x : x0;
    y = y > y0 ? y : y0;
    z = z > z0 ? z : z0;
    x = x > 0 ? x : 0;
    y = y > 0 ? y : 0;
    z = z > 0 ? z : 0;
    grown = b->h[j] * keep + slope * sqrt(x * x + y * y + z * z);
    v[j] = grown > b->h[j] ? grown : b->h[j];
  }
  for (int j = 0; j < LANES; j++)
    if (v[j] < q->best) {
      q->best = v[j];
      q->hint = at;
    }
}

/* Nearest child first, so that the rest is seldom entered. */
static void descend_above(struct search *q, int level, uint32_t at)
{
  const struct vg_near *t = q->t;
  const struct group *g = t->group + t->start[level] + at;
  const float keep = (float)(1 - t->offset - 1e-6), slope = (float)t->slope;
  float bound[LANES];

  group_distance(q, g, bound);
  for (int j = 0; j < LANES; j++) {
    float grown = g->h_min[j] * keep + slope * bound[j] - t->slack;

    bound[j] = grown > g->h_min[j] ? grown : g->h_min[j];
  }
  for (;;) {
    int first = 0;

    for (int j = 1; j < LANES; j++)
      if (bound[j] < bound[first]) first = j;
    if (!(bound[first] < q->best * 0.999)) return;
    bound[first] = INFINITY;
    if (level) descend_above(q, level - 1, at * LANES + (uint32_t)first);
    else visit_block(q, at * LANES + (uint32_t)first);
  }
}

double vg_near_above(const struct vg_near *t, const double lo[3],
                     const double hi[3], double below, uint32_t *hint)
{
  struct search q;

  start_search(&q, t, lo, hi, below);
  q.hint = *hint;
  visit_block(&q, *hint);
  descend_above(&q, t->n_level - 1, 0);
  *hint = q.hint;
  return q.best;
}

static void visit_block_below(struct search *q, uint32_t at)
{
  const struct block *b = q->t->block + at;

  for (int j = 0; j < LANES; j++) {
    double x = b->x[j] - q->lo[0], y = b->y[j] - q->lo[1];
    double z = b->z[j] - q->lo[2];
    double v = b->h[j] * (1 + q->t->offset) -
               q->t->slope * sqrt(x * x + y * y + z * z);

    if (v > b->h[j]) v = b->h[j];
    if (v > q->best) q->best = v;
  }
}

static void descend_below(struct search *q, int level, uint32_t at)
{
  const struct vg_near *t = q->t;
  const struct group *g = t->group + t->start[level] + at;
  const float keep = (float)(1 + t->offset + 1e-6), slope = (float)t->slope;
  float bound[LANES];

  group_distance(q, g, bound);
  for (int j = 0; j < LANES; j++) {
    float left = g->h_max[j] * keep - slope * bound[j] + t->slack;

    bound[j] = left < g->h_max[j] ? left : g->h_max[j];
  }
  for (;;) {
    int first = 0;

    for (int j = 1; j < LANES; j++)
      if (bound[j] > bound[first]) first = j;
    if (!(bound[first] > q->best)) return;
    bound[first] = -INFINITY;
    if (level) descend_below(q, level - 1, at * LANES + (uint32_t)first);
    else visit_block_below(q, at * LANES + (uint32_t)first);
  }
}

double vg_near_below(const struct vg_near *t, const double x[3],
                     double above)
{
  struct search q;

  start_search(&q, t, x, x, above);
  descend_below(&q, t->n_level - 1, 0);
  return q.best;
}
