/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Balls of very different sizes, in one hashed grid per size. The size of a
 * ball is that of its bounding box. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/union_find.h"
#include "partition/repair/repair_parts.h"

/* Grid cells per unit length. A ball of a level is smaller than a cell of its
 * grid, so that it meets at most 8 cells. */
static double share(int level)
{
  return ldexp(0.5, -level);
}

static int level_of(const struct vg_spot *s)
{
  int e;

  frexp(fmax(s->half[0], fmax(s->half[1], s->half[2])), &e);
  return e;
}

struct vg_spot vg_spot_of(const double at[3], double radius, const double *m)
{
  struct vg_spot s = { { at[0], at[1], at[2] }, radius, { 0 }, { 0 } };
  double inverse[6];

  assert(radius >= 0);
  if (m) memcpy(s.m, m, sizeof s.m);
  else vg_tensor_uniform(1, s.m);
  vg_tensor_invert(s.m, inverse);
  s.half[0] = radius * sqrt(inverse[0]);
  s.half[1] = radius * sqrt(inverse[3]);
  s.half[2] = radius * sqrt(inverse[5]);
  return s;
}

static int64_t grid(double x, double share)
{
  return (int64_t)floor(x * share);
}

static uint64_t hash(int level, int64_t i, int64_t j, int64_t k)
{
  uint64_t h = vg_hash_add((uint64_t)level, (uint64_t)i);

  return vg_hash_add(vg_hash_add(h, (uint64_t)j), (uint64_t)k);
}

/* Slots of the grid cells of a level that a ball meets: [8]; returns their
 * number. The ball is at most as large as those of the level. */
static int slots(const struct vg_spot_grid *b, const struct vg_spot *s,
                 int level, uint64_t *slot)
{
  int64_t lo[3], hi[3];
  double m = share(level);
  int n = 0;

  for (int a = 0; a < 3; a++) {
    lo[a] = grid(s->at[a] - s->half[a], m);
    hi[a] = grid(s->at[a] + s->half[a], m);
  }
  for (int64_t i = lo[0]; i <= hi[0]; i++)
    for (int64_t j = lo[1]; j <= hi[1]; j++)
      for (int64_t k = lo[2]; k <= hi[2] && n < 8; k++)
        slot[n++] = hash(level, i, j, k) >> b->shift;
  return n;
}

static void list_levels(struct vg_spot_grid *b)
{
  for (size_t i = 0; i < b->n; i++) {
    int e = level_of(&b->spot[i]), k = 0;

    while (k < b->n_level && b->level[k] != e) k++;
    if (k < b->n_level || k == VG_LEVEL_MAX) continue;
    b->level[k] = e;
    b->share[b->n_level++] = share(e);
  }
}

static vg_status fill_grid(struct vg_spot_grid *b, struct vg_error *err)
{
  uint64_t slot[8], size = 64;

  b->shift = 58;
  for (; size < 8 * b->n; size *= 2) b->shift--;
  b->first = vg_calloc(size + 2, sizeof *b->first);
  b->ball = vg_alloc(8 * b->n, sizeof *b->ball);
  if (!b->first || !b->ball) return vg_fail_memory(err, "repairs");
  for (int put = 0; put < 2; put++) {
    for (size_t i = 0; i < b->n; i++) {
      int n = slots(b, &b->spot[i], level_of(&b->spot[i]), slot);

      for (int k = 0; k < n; k++)
        if (put) b->ball[b->first[slot[k] + 1]++] = (uint32_t)i;
        else b->first[slot[k] + 2]++;
    }
    for (uint64_t k = 0; !put && k < size; k++)
      b->first[k + 2] += b->first[k + 1];
  }
  return VG_OK;
}

uint32_t vg_spot_grid_at(const struct vg_spot_grid *b, const double x[3])
{
  for (int l = 0; l < b->n_level; l++) {
    double m = b->share[l];
    uint64_t s = hash(b->level[l], grid(x[0], m), grid(x[1], m),
                      grid(x[2], m)) >>
                 b->shift;

    for (uint32_t k = b->first[s]; k < b->first[s + 1]; k++) {
      const struct vg_spot *t = &b->spot[b->ball[k]];

      if (b->cluster[b->ball[k]] != VG_NO_CLUSTER &&
          vg_spot_distance2(t, x) <= t->radius * t->radius)
        return b->cluster[b->ball[k]];
    }
  }
  return VG_NO_CLUSTER;
}

/* --- clusters ------------------------------------------------------------ */

struct forest {
  uint32_t *up, *size; /* [n] */
  uint32_t *near;      /* Roots of the balls that overlap a ball. */
  size_t n_near, cap_near;
};

/* Do the balls overlap on the line between their centres? Balls that overlap
 * elsewhere only, in metrics with different axes, remain separate: a point in
 * both belongs to the first one that vg_spot_grid_at finds. */
static int overlaps(const struct vg_spot *a, const struct vg_spot *b)
{
  double in_a = sqrt(vg_spot_distance2(a, b->at));
  double in_b = sqrt(vg_spot_distance2(b, a->at));

  return in_a * in_b <= a->radius * in_b + b->radius * in_a;
}

/* Pairs of overlapping balls, the later ball first. */
struct pairs {
  size_t n, cap;
  uint64_t *at;
};

/* Finds the overlapping balls of the same level and of higher levels. */
static vg_status add_pairs(const struct vg_spot_grid *b, uint32_t i,
                           struct pairs *p, struct vg_error *err)
{
  const struct vg_spot *s = &b->spot[i];
  uint64_t slot[8];
  int own = level_of(s);

  for (int l = 0; l < b->n_level; l++) {
    int n = b->level[l] < own ? 0 : slots(b, s, b->level[l], slot);

    for (int k = 0; k < n; k++)
      for (uint32_t m = b->first[slot[k]]; m < b->first[slot[k] + 1]; m++) {
        uint32_t j = b->ball[m];
        uint32_t low = i < j ? i : j, high = i < j ? j : i;

        if (i == j || !overlaps(s, &b->spot[j])) continue;
        if (vg_reserve(&p->at, &p->cap, p->n + 1, sizeof *p->at))
          return vg_fail_memory(err, "repairs");
        p->at[p->n++] = (uint64_t)high << 32 | low;
      }
  }
  return VG_OK;
}

static int by_value(const void *a, const void *b)
{
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

  return x < y ? -1 : x > y;
}

/* Joins ball i to the clusters of the earlier balls that it overlaps, unless
 * the cluster would become too large. pair: [n] those of ball i. */
static void join(const struct vg_spot_grid *b, struct forest *f, uint32_t i,
                 size_t n, const uint64_t *pair, size_t most)
{
  size_t size = 1;

  f->n_near = 0;
  for (size_t k = 0; k < n; k++) {
    uint32_t j = (uint32_t)pair[k], r;
    size_t m = 0;

    if (b->cluster[j] == VG_NO_CLUSTER) continue;
    r = vg_root_of(f->up, j);
    while (m < f->n_near && f->near[m] != r) m++;
    if (m < f->n_near) continue;
    f->near[f->n_near++] = r;
    size += f->size[r];
    if (size > most) return;
  }
  for (size_t m = 0; m < f->n_near; m++) f->up[f->near[m]] = i;
  f->size[i] = (uint32_t)size;
  b->cluster[i] = 0;
}

static void number(struct vg_spot_grid *b, const struct forest *f)
{
  /* size is not needed any more; it now holds the numbers of roots */
  for (size_t i = 0; i < b->n; i++) f->size[i] = VG_NO_CLUSTER;
  for (size_t i = 0; i < b->n; i++) {
    uint32_t r;

    if (b->cluster[i] == VG_NO_CLUSTER) continue;
    r = vg_root_of(f->up, (uint32_t)i);
    if (f->size[r] == VG_NO_CLUSTER) f->size[r] = (uint32_t)b->n_cluster++;
    b->cluster[i] = f->size[r];
  }
}

static vg_status join_all(struct vg_spot_grid *b, struct forest *f,
                          struct pairs *p, size_t most, struct vg_error *err)
{
  size_t first = 0, end;

  for (uint32_t i = 0; i < b->n; i++) {
    vg_status st = add_pairs(b, i, p, err);

    if (st < 0) return st;
    f->up[i] = i;
    f->size[i] = 1;
    b->cluster[i] = VG_NO_CLUSTER;
  }
  if (p->n) qsort(p->at, p->n, sizeof *p->at, by_value);
  for (uint32_t i = 0; i < b->n; i++, first = end) {
    for (end = first; end < p->n && p->at[end] >> 32 == i; end++) {
    }
    if (vg_reserve(&f->near, &f->cap_near, end - first + 1, sizeof *f->near))
      return vg_fail_memory(err, "repairs");
    join(b, f, i, end - first, p->at + first, most);
  }
  number(b, f);
  return VG_OK;
}

vg_status vg_spot_grid_new(size_t n, const struct vg_spot *spot, size_t most,
                           struct vg_spot_grid *out, struct vg_error *err)
{
  struct vg_spot_grid b = { .n = n, .spot = spot };
  struct forest f = { 0 };
  struct pairs p = { 0 };
  vg_status st;

  assert((spot || !n) && most > 0);
  b.cluster = vg_alloc(n, sizeof *b.cluster);
  f.up = vg_alloc(n, sizeof *f.up);
  f.size = vg_alloc(n, sizeof *f.size);
  st = b.cluster && f.up && f.size ? VG_OK : vg_fail_memory(err, "repairs");
  if (st == VG_OK) {
    list_levels(&b);
    st = fill_grid(&b, err);
  }
  if (st == VG_OK) st = join_all(&b, &f, &p, most, err);
  free(f.up);
  free(f.size);
  free(f.near);
  free(p.at);
  if (st == VG_OK) *out = b;
  else vg_spot_grid_release(&b);
  return st;
}

/* R9: a ball is redundant if an earlier ball has at least this share of its
 * radius, and the distance between their centres is below the square root of
 * COVER_DEPTH2 times the earlier ball's radius. */
#define COVER_RADIUS 0.8
#define COVER_DEPTH2 0.2

/* Is the centre of ball i deep in an earlier remaining ball that is not much
 * smaller? */
static int is_covered(const struct vg_spot_grid *b, uint32_t i)
{
  const struct vg_spot *s = &b->spot[i];

  for (int l = 0; l < b->n_level; l++) {
    double m = b->share[l];
    uint64_t at = hash(b->level[l], grid(s->at[0], m), grid(s->at[1], m),
                       grid(s->at[2], m)) >>
                  b->shift;

    for (uint32_t k = b->first[at]; k < b->first[at + 1]; k++) {
      const struct vg_spot *t = &b->spot[b->ball[k]];

      if (b->cluster[b->ball[k]] != VG_NO_CLUSTER && b->ball[k] < i &&
          t->radius > COVER_RADIUS * s->radius &&
          vg_spot_distance2(t, s->at) < COVER_DEPTH2 * t->radius * t->radius)
        return 1;
    }
  }
  return 0;
}

vg_status vg_spots_thin(size_t *n, struct vg_spot *spot, struct vg_error *err)
{
  struct vg_spot_grid b = { .n = *n, .spot = spot };
  vg_status st = VG_OK;

  b.cluster = vg_alloc(*n, sizeof *b.cluster);
  if (!b.cluster) return vg_fail_memory(err, "repairs");
  memset(b.cluster, 0xff, *n * sizeof *b.cluster);
  list_levels(&b);
  st = fill_grid(&b, err);
  for (uint32_t i = 0; st == VG_OK && i < b.n; i++)
    if (!is_covered(&b, i)) b.cluster[i] = 0;
  *n = 0;
  for (size_t i = 0; st == VG_OK && i < b.n; i++)
    if (b.cluster[i] != VG_NO_CLUSTER) spot[(*n)++] = spot[i];
  vg_spot_grid_release(&b);
  return st;
}

void vg_spot_grid_release(struct vg_spot_grid *b)
{
  free(b->cluster);
  free(b->first);
  free(b->ball);
  memset(b, 0, sizeof *b);
}
