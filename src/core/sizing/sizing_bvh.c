/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_bvh_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

#define LANES VG_BVH_LANES

/* Order of the samples: recursive medians along the longest side. */

struct key {
  float p[3];
  uint32_t at;
};

static int key_less(const struct key *a, const struct key *b, int axis)
{
  if (a->p[axis] != b->p[axis]) return a->p[axis] < b->p[axis];
  return a->at < b->at;
}

/* Median of the first, middle and last key. */
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

/* Partition: move the m smallest of n keys to the front. Every fourth pivot is
 * half way between the extremes, which bounds the number of rounds for any
 * input. */
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
    if (!i) { /* the pivot is the smallest key: move it to the front */
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

/* Order n keys into runs of `unit` keys, one for each lane of a node, with
 * each run ordered in the same way. unit is 8^level. */
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

/* Number of keys that one thread orders alone, and of blocks or groups that it
 * fills. */
#define RANGE 8192
#define GRAIN 256

struct range {
  struct key *key;
  size_t n, unit;
};

/* As order_keys, with the longer ranges halved round by round: range i becomes
 * ranges 2 i and 2 i + 1. */
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
    select_keys(r->key, r->n + up->n, r->n, longest_side(r->key, r->n + up->n));
  }
}

static void order_body(void *context, size_t first, size_t end, int worker)
{
  struct range *r = context;

  (void)worker;
  for (size_t i = first; i < end; i++) order_keys(r[i].key, r[i].n, r[i].unit);
}

/* For the next round, the ranges are spread over the array, beginning at its
 * end. */
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

  for (least *= 4; h > least && c < VG_BVH_CLASSES - 1; least *= 4) c++;
  return c;
}

/* Sort the keys by size class, in the order of the classes. count: number of
 * keys in each class. */
static void classify(size_t n, const double (*p)[3], const double *h,
                     struct key *key, size_t count[VG_BVH_CLASSES])
{
  double least = h[0];
  size_t at[VG_BVH_CLASSES];

  for (size_t i = 1; i < n; i++) least = h[i] < least ? h[i] : least;
  memset(count, 0, VG_BVH_CLASSES * sizeof *count);
  for (size_t i = 0; i < n; i++) count[size_class(h[i], least)]++;
  at[0] = 0;
  for (int c = 1; c < VG_BVH_CLASSES; c++) at[c] = at[c - 1] + count[c - 1];
  for (size_t i = 0; i < n; i++) {
    struct key *a = key + at[size_class(h[i], least)]++;

    a->at = (uint32_t)i;
    for (int k = 0; k < 3; k++) a->p[k] = (float)(p[i][k] - p[0][k]);
  }
}

/* Box and sizes of the contents of one lane of a group. */
struct bound {
  double lo[3], hi[3];
  float h_min, h_max;
};

static void bound_block(const struct vg_bvh_block *b, struct bound *out)
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

/* Fill a group with n <= LANES bounds. Searches never enter an empty lane. */
static void fill_group(const struct bound *from, size_t n,
                       struct vg_bvh_group *g)
{
  memset(g, 0, sizeof *g);
  for (int k = 0; k < 3; k++)
    g->origin[k] = 0.5 * (from[0].lo[k] + from[0].hi[k]);
  for (size_t j = 0; j < LANES; j++) {
    g->h_min[j] = j < n ? from[j].h_min : VG_BVH_NEVER;
    g->h_max[j] = j < n ? from[j].h_max : -INFINITY;
    for (int k = 0; k < 3 && j < n; k++) {
      double half = 0.5 * (from[j].hi[k] - from[j].lo[k]);
      double mid = from[j].lo[k] + half - g->origin[k];

      g->mid[k][j] = (float)mid;
      half += fabs(mid) * (double)VG_BVH_MARGIN;
      g->half[k][j] = (float)(half * 1.000001);
    }
  }
}

struct filling {
  const double (*p)[3], *h;
  const struct key *key;
  size_t n;
  struct vg_bvh_block *block;
  struct vg_bvh_group *group;
  struct bound *bound, *up; /* bounds of the input and of the output */
};

/* The last block is padded with copies of its last sample. */
static void block_body(void *context, size_t first, size_t end, int worker)
{
  const struct filling *f = context;

  (void)worker;
  for (size_t i = first * LANES; i < end * LANES; i++) {
    size_t from = f->key[i < f->n ? i : f->n - 1].at, lane;
    struct vg_bvh_block *b = f->block + i / LANES;

    lane = i % LANES;
    b->h[lane] = (float)f->h[from];
    for (int k = 0; k < 3; k++) {
      if (!lane) b->origin[k] = f->p[from][k];
      b->p[k][lane] = (float)(f->p[from][k] - b->origin[k]);
    }
  }
  for (size_t i = first; i < end; i++) bound_block(f->block + i, f->up + i);
}

static void group_body(void *context, size_t first, size_t end, int worker)
{
  const struct filling *f = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    const struct bound *from = f->bound + i * LANES;
    size_t n = f->n - i * LANES;

    if (n > LANES) n = LANES;
    fill_group(from, n, f->group + i);
    f->up[i] = from[0];
    for (size_t j = 1; j < n; j++) join(f->up + i, from + j);
  }
}

/* Build the tree of f->n samples: its blocks, and its groups level by level.
 * Advances *f past them. */
static void fill_tree(struct filling *f, struct vg_bvh_tree *t, int threads)
{
  struct bound *bound = f->up;
  size_t n = (f->n + LANES - 1) / LANES;

  t->block = f->block;
  vg_parallel_for(threads, n, GRAIN, block_body, f);
  f->key += f->n;
  f->block += n;
  do {
    f->bound = f->up;
    f->up += n;
    f->n = n;
    n = (n + LANES - 1) / LANES;
    t->group[t->n_level++] = f->group;
    vg_parallel_for(threads, n, GRAIN, group_body, f);
    f->group += n;
  } while (n > 1);
  t->h_min = f->up->h_min;
  t->h_max = f->up->h_max;
  f->up = bound;
}

static int fill_trees(struct vg_bvh *t, const double (*p)[3], const double *h,
                      struct key *key, const size_t count[VG_BVH_CLASSES],
                      struct bound *bound, int threads)
{
  struct filling f = { .p = p,
                       .h = h,
                       .key = key,
                       .block = t->block,
                       .group = t->group,
                       .up = bound };

  for (int c = 0; c < VG_BVH_CLASSES; c++) {
    if (!count[c]) continue;
    if (order_samples(key, count[c], threads)) return -1;
    key += count[c];
    f.n = count[c];
    fill_tree(&f, t->tree + t->n_tree++, threads);
  }
  return 0;
}

vg_status vg_bvh_new(size_t n, const double (*p)[3], const double *h,
                     double slope, int threads, struct vg_bvh **out,
                     struct vg_error *err)
{
  assert(n > 0 && p && h && slope > 0 && threads >= 0);

  struct vg_bvh *t = vg_calloc(1, sizeof *t);
  struct key *key = vg_alloc(n, sizeof *key);
  size_t count[VG_BVH_CLASSES], n_block = n / LANES + VG_BVH_CLASSES;
  size_t n_group = n_block / 7 + VG_BVH_CLASSES * VG_BVH_LEVELS;
  struct bound *bound = vg_alloc(n_block + n_group, sizeof *bound);

  if (!t || !key || !bound || n > UINT32_MAX / 2) goto refused;
  t->slope = (float)slope;
  t->offset = (float)vg_bvh_offset(slope);
  t->steep = (float)vg_bvh_steep(slope);
  t->rise = (float)vg_bvh_rise(slope);
  t->block = vg_alloc(n_block, sizeof *t->block);
  /* a seventh of the blocks, and one partly filled group per level */
  t->group = vg_alloc(n_group, sizeof *t->group);
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
  vg_bvh_free(t);
  return vg_fail_memory(err, "the spacings on the surface");
}

void vg_bvh_free(struct vg_bvh *t)
{
  if (!t) return;
  free(t->block);
  free(t->group);
  free(t);
}
