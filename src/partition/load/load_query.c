/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: each axis is divided into bins at the faces of octants, of all
 * octants if they are few, else of a sample, so that bins are narrow where
 * octants are small. Each bin stores the number of cells below it, the density
 * of cells on planes across it, and the largest target edge length. An octant
 * that covers many bins is added in constant time, as a difference between the
 * first and the last of them. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "partition/load/load.h"

/* Number of octants whose faces become bounds of bins: all of a small load, up
 * to SAMPLE of a large one. Two bounds nearer than this share of half an octant
 * are merged (coordinates have single precision). */
enum { SAMPLE = 256, FEW = 32, ONE_OF = 8 };
#define ONE_EDGE 0.01

struct axis {
  size_t n;             /* bins */
  double *edge, *below; /* [n + 1] Bounds; cells below each. */
  double *dense;        /* [n] Cells times target edge per length. */
  float *most;          /* [n] Largest target edge length. */
  size_t *first;        /* [2 n + 1] Number of bounds before each slot of
                           equal width. */
  double scale;         /* Slots per length. */
};

struct vg_load_index {
  struct axis axis[3];
};

static void release_axis(struct axis *a)
{
  free(a->edge);
  free(a->below);
  free(a->dense);
  free(a->most);
  free(a->first);
}

static void release_index(struct vg_load_index *index)
{
  for (int k = 0; index && k < 3; k++) release_axis(&index->axis[k]);
  free(index);
}

void vg_load_release(struct vg_load *l)
{
  free(l->octant);
  release_index(l->index);
  memset(l, 0, sizeof *l);
}

/* Range of an octant's cells along an axis. */
static void reach_of(const struct vg_load *l, const struct vg_load_octant *c,
                     int k, double *lo, double *hi)
{
  *lo = (double)c->at[k] - (double)c->half;
  *hi = (double)c->at[k] + (double)c->half;
  if (!l->is_block) return;
  if (*lo < l->from[k]) *lo = fmin(l->from[k], *hi);
  if (*hi > l->to[k]) *hi = fmax(l->to[k], *lo);
}

/* --- bins ---------------------------------------------------------------- */

struct mark {
  double x, near;
};

static int by_place(const void *a, const void *b)
{
  const struct mark *s = a, *t = b;

  return (s->x > t->x) - (s->x < t->x);
}

/* Finds the ends of the sample's octants and of the load, sorted, without
 * duplicates. */
static size_t find_edges(const struct vg_load *l, int k, double *edge,
                         struct mark *mark)
{
  const size_t few = FEW + l->n / ONE_OF;
  const size_t step = 1 + (l->n - 1) / (few < SAMPLE ? few : SAMPLE);
  double lo = INFINITY, hi = -INFINITY, from, to;
  size_t n = 0, m = 0;

  for (size_t i = 0; i < l->n; i++) {
    const double near = ONE_EDGE * (double)l->octant[i].half;

    reach_of(l, &l->octant[i], k, &from, &to);
    lo = fmin(lo, from);
    hi = fmax(hi, to);
    if (i % step) continue;
    mark[m++] = (struct mark){ from, near };
    mark[m++] = (struct mark){ to, near };
  }
  qsort(mark, m, sizeof *mark, by_place);
  edge[n++] = lo;
  for (size_t i = 0; i < m; i++)
    if (mark[i].x - edge[n - 1] > mark[i].near && hi - mark[i].x > mark[i].near)
      edge[n++] = mark[i].x;
  edge[n] = hi;
  return n;
}

static size_t slot_of(const struct axis *a, double x)
{
  const double s = (x - a->edge[0]) * a->scale;

  return s > 0 ? s < (double)(2 * a->n) ? (size_t)s : 2 * a->n - 1 : 0;
}

static void fill_slots(struct axis *a)
{
  const double extent = a->edge[a->n] - a->edge[0];
  size_t s = 0;

  a->scale = extent > 0 ? (double)(2 * a->n) / extent : 0;
  for (size_t i = 0; i <= a->n; i++) {
    const size_t at = slot_of(a, a->edge[i]);

    while (s <= at) a->first[s++] = i;
  }
  while (s <= 2 * a->n) a->first[s++] = a->n + 1;
}

/* The bin that contains x: edge[bin] <= x, the first or last one if outside. */
static size_t bin_of(const struct axis *a, double x)
{
  const size_t s = slot_of(a, x);
  size_t lo = a->first[s], hi = a->first[s + 1];

  while (lo < hi) {
    const size_t m = lo + (hi - lo) / 2;

    if (a->edge[m] <= x) lo = m + 1;
    else hi = m;
  }
  return lo ? lo <= a->n ? lo - 1 : a->n - 1 : 0;
}

/* --- contents of the bins ------------------------------------------------ */

struct sums {
  double *cells, *weight; /* [n] Complete sums: of cells, and of cells times
                             h. */
  double *rate[2];        /* [n + 1] Both per length, as differences. */
  float *most;            /* [levels][n] Maximum over runs of 2^level bins. */
  int levels;
};

static int log2_of(size_t n)
{
  int k = 0;

  while (n >>= 1) k++;
  return k;
}

static void most_over(struct sums *s, size_t n, size_t from, size_t to, float h)
{
  const int k = log2_of(to - from);
  float *row = s->most + (size_t)k * n;
  const size_t other = to - ((size_t)1 << k);

  if (row[from] < h) row[from] = h;
  if (row[other] < h) row[other] = h;
}

static void add_cells(struct sums *s, size_t bin, double cells, double h)
{
  s->cells[bin] += cells;
  s->weight[bin] += cells * h;
}

/* across: that of the axis. */
static void add_octant(const struct axis *a, struct sums *s, double lo,
                       double hi, const struct vg_load_octant *c, float across)
{
  const double near = 2 * ONE_EDGE * (double)c->half;
  const double h = (double)across, cells = (double)c->cells;
  size_t f = bin_of(a, lo), g = bin_of(a, hi);
  double rate;

  /* an end close to a bound is moved onto it and adds nothing to the bin
   * beyond */
  if (g > f && a->edge[f + 1] - lo <= near) lo = a->edge[++f];
  if (g > f && hi - a->edge[g] <= near) hi = a->edge[g--];
  most_over(s, a->n, f, g + 1, across);
  if (f == g) {
    add_cells(s, f, cells, h);
    return;
  }
  rate = cells / (hi - lo);
  add_cells(s, f, rate * (a->edge[f + 1] - lo), h);
  add_cells(s, g, rate * (hi - a->edge[g]), h);
  s->rate[0][f + 1] += rate;
  s->rate[0][g] -= rate;
  s->rate[1][f + 1] += rate * h;
  s->rate[1][g] -= rate * h;
}

static void conclude(struct axis *a, struct sums *s)
{
  double rate[2] = { 0, 0 };

  for (int k = s->levels - 1; k > 0; k--)
    for (size_t i = 0; i + ((size_t)1 << k) <= a->n; i++) {
      const float h = s->most[(size_t)k * a->n + i];
      float *low = s->most + (size_t)(k - 1) * a->n + i;

      if (low[0] < h) low[0] = h;
      if (low[(size_t)1 << (k - 1)] < h) low[(size_t)1 << (k - 1)] = h;
    }
  a->below[0] = 0;
  for (size_t i = 0; i < a->n; i++) {
    const double width = a->edge[i + 1] - a->edge[i];

    rate[0] += s->rate[0][i];
    rate[1] += s->rate[1][i];
    a->below[i + 1] = a->below[i] + s->cells[i] + fmax(rate[0], 0) * width;
    a->dense[i] = width > 0 ? s->weight[i] / width + fmax(rate[1], 0) : 0;
    a->most[i] = s->most[i];
  }
}

static int fill_bins(const struct vg_load *l, int k, struct axis *a)
{
  struct sums s = { .levels = log2_of(a->n) + 1 };
  double *sum = vg_calloc(4 * (a->n + 1), sizeof *sum);
  int bad = -1;

  s.most = vg_calloc((size_t)s.levels * a->n, sizeof *s.most);
  if (sum && s.most) {
    s.cells = sum;
    s.weight = sum + a->n + 1;
    s.rate[0] = sum + 2 * (a->n + 1);
    s.rate[1] = sum + 3 * (a->n + 1);
    for (size_t i = 0; i < l->n; i++) {
      double lo, hi;

      reach_of(l, &l->octant[i], k, &lo, &hi);
      add_octant(a, &s, lo, hi, &l->octant[i], l->octant[i].across[k]);
    }
    conclude(a, &s);
    bad = 0;
  }
  free(sum);
  free(s.most);
  return bad;
}

static int make_axis(const struct vg_load *l, int k, struct axis *a)
{
  const size_t most = 2 * SAMPLE + 2;
  struct mark *mark = vg_alloc(most, sizeof *mark);
  int bad = -1;

  a->edge = vg_alloc(most, sizeof *a->edge);
  if (mark && a->edge) {
    a->n = find_edges(l, k, a->edge, mark);
    a->below = vg_alloc(a->n + 1, sizeof *a->below);
    a->dense = vg_alloc(a->n, sizeof *a->dense);
    a->most = vg_alloc(a->n, sizeof *a->most);
    a->first = vg_alloc(2 * a->n + 1, sizeof *a->first);
    bad = !a->below || !a->dense || !a->most || !a->first;
  }
  free(mark);
  if (bad) return -1;
  fill_slots(a);
  return fill_bins(l, k, a);
}

struct index_job {
  const struct vg_load *l;
  struct vg_load_index *index;
  int bad[3];
};

static void index_part(void *context, size_t first, size_t end, int worker)
{
  struct index_job *job = context;

  (void)worker;
  for (size_t k = first; k < end; k++)
    job->bad[k] = make_axis(job->l, (int)k, &job->index->axis[k]);
}

vg_status vg_load_index(struct vg_load *l, int threads, struct vg_error *err)
{
  struct index_job job = { .l = l };

  assert(threads >= 0);
  release_index(l->index);
  l->index = NULL;
  if (!l->n) return VG_OK;
  job.index = vg_calloc(1, sizeof *job.index);
  if (job.index)
    vg_parallel_for(l->n < 4096 ? 1 : threads, 3, 1, index_part, &job);
  if (!job.index || job.bad[0] || job.bad[1] || job.bad[2]) {
    release_index(job.index);
    return vg_fail_memory(err, "the load estimate");
  }
  l->index = job.index;
  return VG_OK;
}

/* --- queries ------------------------------------------------------------- */

double vg_load_quantile(const struct vg_load *l, int axis, double part)
{
  const struct axis *a;
  size_t lo = 0, hi;
  double target, within;

  assert(axis >= 0 && axis < 3 && part >= 0 && part <= 1);
  if (!l->index) return 0;
  a = &l->index->axis[axis];
  if (!(part > 0)) return a->edge[0];
  if (!(part < 1)) return a->edge[a->n];
  target = part * a->below[a->n];
  hi = a->n - 1;
  while (lo < hi) { /* first bin that ends at the target or later */
    const size_t m = lo + (hi - lo) / 2;

    if (a->below[m + 1] < target) lo = m + 1;
    else hi = m;
  }
  within = a->below[lo + 1] - a->below[lo];
  within = within > 0 ? (target - a->below[lo]) / within : 0;
  return a->edge[lo] + within * (a->edge[lo + 1] - a->edge[lo]);
}

/* Finds the bins at x, two if x is a bound. Returns their number. */
static int bins_at(const struct vg_load *l, int axis, double x, size_t bin[2])
{
  const struct axis *a;

  if (!l->index) return 0;
  a = &l->index->axis[axis];
  if (!(x >= a->edge[0] && x <= a->edge[a->n])) return 0;
  bin[0] = bin_of(a, x);
  bin[1] = bin[0] - 1;
  return 1 + (bin[0] > 0 && !(x > a->edge[bin[0]]));
}

double vg_load_zone(const struct vg_load *l, int axis, double at, double width)
{
  assert(axis >= 0 && axis < 3 && width >= 0);

  size_t bin[2];
  const int n = bins_at(l, axis, at, bin);
  double sum = 0;

  for (int i = 0; i < n; i++) sum += l->index->axis[axis].dense[bin[i]];
  return n ? 2 * width * sum / n : 0;
}

double vg_load_coarsest(const struct vg_load *l, int axis, double at)
{
  assert(axis >= 0 && axis < 3);

  size_t bin[2];
  const int n = bins_at(l, axis, at, bin);
  double most = 0;

  for (int i = 0; i < n; i++)
    most = fmax(most, (double)l->index->axis[axis].most[bin[i]]);
  return most;
}

double vg_load_within(const struct vg_load *l, const double lo[3],
                      const double hi[3])
{
  double sum = 0;

  for (size_t i = 0; i < l->n; i++) {
    double part = (double)l->octant[i].cells;

    for (int k = 0; k < 3 && part > 0; k++) {
      double from, to;

      reach_of(l, &l->octant[i], k, &from, &to);
      part *= to > from
              ? fmax(fmin(to, hi[k]) - fmax(from, lo[k]), 0) / (to - from)
              : 0;
    }
    sum += part;
  }
  return sum;
}
