/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/metric/metric_points.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/buckets.h"
#include "base/memory.h"

/* Side of the cubic pattern, as for isotropic points (K9). */
static const double lattice = 1.083;
/* Least height over a face of the surface, relative to its mean edge. */
static const double least_height = 0.3;

enum {
  N_BUCKET = 8192,
  BUCKET_ZERO = 4096,
  STOP_STEP = 1 << 12,
  NEAR_MAX = 64
};

struct advance {
  struct vg_tets *t;
  struct vg_metrics *metrics;
  const struct vg_region *region;
  struct vg_inserter s;
  struct vg_buckets queue; /* Faces of the surface, then points. */
  size_t n_face;
  uint32_t *face; /* [n_face][3] Corners of faces of the surface. */
  uint32_t *star; /* [points] A cell of each point, or VG_NONE. */
  size_t cap_star;
  struct vg_metric_advance_report *report;
};

/* Four buckets per doubling of the mean size. */
static int bucket_of(double root)
{
  int e;
  double m = frexp(1 / root, &e); /* h^3 */

  return 2 * e + (m >= 0.7071067811865476) + BUCKET_ZERO;
}

static int push_point(struct advance *a, uint32_t p)
{
  size_t n = a->n_face + p + 1;

  if (vg_buckets_reserve(&a->queue, n)) return -1;
  vg_buckets_push(&a->queue, bucket_of(a->metrics->at[p].root),
                  (uint32_t)a->n_face + p);
  return 0;
}

static int is_wanted(const struct advance *a, const double x[3])
{
  return !a->region ||
         vg_region_near(a->region, a->metrics->sizing, x, VG_BAND_PLACE);
}

/* --- proposals ------------------------------------------------------------ */

/* Do the given points exclude the position x with stretch t? */
static int is_excluded(const struct advance *a, int n, const uint32_t *point,
                       const double x[3], const double t[6])
{
  for (int i = 0; i < n; i++) {
    double d[3];

    vg_sub(a->t->x[point[i]], x, d);
    vg_tensor_apply(t, d, d);
    if (vg_dot(d, d) < VG_METRIC_EXCLUSION * VG_METRIC_EXCLUSION) return 1;
  }
  return 0;
}

/* Points that share an edge with a point. */
struct near {
  int n;
  uint32_t point[NEAR_MAX];
};

static void add_near(struct near *near, uint32_t p)
{
  for (int k = 0; k < near->n; k++)
    if (near->point[k] == p) return;
  if (near->n < NEAR_MAX) near->point[near->n++] = p;
}

/* The neighbours of p, which exclude most of the positions that it proposes,
 * before these are located. */
static void find_near(const struct advance *a, uint32_t p, struct near *near)
{
  const struct vg_tets *t = a->t;
  uint32_t ball[NEAR_MAX];
  int n = 1;

  near->n = 0;
  ball[0] = a->star[p];
  t->flag[ball[0]] |= VG_MARK;
  for (int k = 0; k < n; k++) {
    const struct vg_cell *cell = &t->cell[ball[k]];

    for (int i = 0; i < 4; i++) {
      uint32_t other = cell->link[i] >> 2;

      if (cell->v[i] == p) continue;
      add_near(near, cell->v[i]);
      if (cell->link[i] == VG_NONE || t->flag[ball[k]] >> i & 1 ||
          t->flag[other] & VG_MARK || n == NEAR_MAX)
        continue;
      t->flag[other] |= VG_MARK;
      ball[n++] = other;
    }
  }
  for (int k = 0; k < n; k++) t->flag[ball[k]] &= (uint8_t)~VG_MARK;
}

/* Insert x with stretch t into its cell. Returns -1 if memory is refused. */
static int insert(struct advance *a, const double x[3], const double t[6],
                  uint32_t cell, struct vg_error *err)
{
  uint32_t p = (uint32_t)a->t->n_point;
  struct vg_point_metric m;
  vg_status st;

  if (vg_reserve(&a->star, &a->cap_star, p + 1, sizeof *a->star)) return -1;
  vg_metric_of_stretch(t, &m);
  a->s.star = a->star;
  st = vg_metrics_insert(a->metrics, &a->s, x, &m, cell, least_height,
                         VG_METRIC_EXCLUSION, err);
  if (st != VG_OK) {
    a->report->n_refused++;
    return st < 0 ? -1 : 0;
  }
  if (push_point(a, p)) return -1;
  a->report->n_inserted++;
  return 0;
}

/* Propose the point at `unit`, in units of the metric, from c, where the size
 * tensor is h. The displacement is the mean of those by the sizes at both of
 * its ends. near: points that may exclude it. */
static int propose(struct advance *a, const double c[3], const double h[6],
                   const double unit[3], const struct near *near,
                   uint32_t start, struct vg_error *err)
{
  double d[3], far[3], x[3], t[6], there[6];
  uint32_t cell;

  vg_tensor_apply(h, unit, d);
  for (int k = 0; k < 3; k++) x[k] = c[k] + d[k];
  vg_sizing_tensor_at(a->metrics->sizing, x, there);
  vg_tensor_apply(there, unit, far);
  for (int k = 0; k < 3; k++) x[k] = c[k] + 0.5 * (d[k] + far[k]);
  if (!is_wanted(a, x)) return 0;
  a->report->n_proposed++;
  vg_sizing_tensor_at(a->metrics->sizing, x, there);
  vg_tensor_invert(there, t);
  if (is_excluded(a, near->n, near->point, x, t)) return 0;
  cell = vg_tets_locate(a->t, start, x);
  if (cell == VG_NONE || a->t->flag[cell] & VG_OUTSIDE ||
      is_excluded(a, 4, a->t->cell[cell].v, x, t))
    return 0;
  return insert(a, x, t, cell, err);
}

/* Sizes along two axes that differ by less than this factor count as equal. */
static const double like = 1.3; /* K47 */

/* Replace b and c by the axes across the unit vector a that follow the axis of
 * space that is most oblique to a. */
static void follow_space(const double a[3], double b[3], double c[3])
{
  int k = 0;

  for (int i = 1; i < 3; i++)
    if (fabs(a[i]) < fabs(a[k])) k = i;
  for (int i = 0; i < 3; i++) b[i] = (i == k) - a[k] * a[i];
  vg_unit(b);
  vg_cross(a, b, c);
}

/* Size tensor h of a metric, and the axes of the pattern: those of the metric,
 * whose layers the pattern follows where they turn. The pattern has all
 * symmetries of a cube, so that the order and the signs of axes do not matter.
 * Axes of like sizes would turn at random, and follow those of space. */
static void find_axes(const double m[6], double h[6], double axis[3][3])
{
  double size[3];
  int low, high;

  vg_tensor_eigen(m, size, axis);
  for (int k = 0; k < 3; k++) size[k] = 1 / sqrt(size[k]);
  vg_tensor_from_eigen(size, (const double(*)[3])axis, h);
  high = size[0] < like * size[1];
  low = size[1] < like * size[2];
  if (high && low)
    for (int k = 0; k < 9; k++) axis[k / 3][k % 3] = k % 4 == 0;
  else if (high) follow_space(axis[2], axis[0], axis[1]);
  else if (low) follow_space(axis[0], axis[1], axis[2]);
}

/* Most positions that a point proposes are so near to a neighbour, in the
 * metric of the point, that the metrics at the positions themselves do not make
 * them possible: nearer than this factor of the least distance. */
static const double surely = 0.85; /* K56 */

/* Positions of the neighbours of p relative to it, in units of its metric with
 * size tensor h. */
static void place_near(const struct advance *a, uint32_t p, const double h[6],
                       const struct near *near, double (*unit)[3])
{
  double t[6];

  vg_tensor_invert(h, t);
  for (int i = 0; i < near->n; i++) {
    vg_sub(a->t->x[near->point[i]], a->t->x[p], unit[i]);
    vg_tensor_apply(t, unit[i], unit[i]);
  }
}

static int is_surely_excluded(int n, const double (*near)[3],
                              const double unit[3])
{
  const double least = surely * VG_METRIC_EXCLUSION;

  for (int i = 0; i < n; i++)
    if (vg_distance2(near[i], unit) < least * least) return 1;
  return 0;
}

static int grow_point(struct advance *a, uint32_t p, struct vg_error *err)
{
  static const double sign[8][3] = { { 1, 1, 1 },  { -1, -1, -1 },
                                     { 1, 1, -1 }, { -1, -1, 1 },
                                     { 1, -1, 1 }, { -1, 1, -1 },
                                     { -1, 1, 1 }, { 1, -1, -1 } };
  double c[3], h[6], axis[3][3], around[NEAR_MAX][3];
  struct near near;

  memcpy(c, a->t->x[p], sizeof c);
  find_axes(a->metrics->at[p].m, h, axis);
  find_near(a, p, &near);
  place_near(a, p, h, &near, around);
  for (int i = 0; i < 8; i++) {
    double unit[3];

    for (int k = 0; k < 3; k++)
      unit[k] = 0.5 * lattice *
                (sign[i][0] * axis[0][k] + sign[i][1] * axis[1][k] +
                 sign[i][2] * axis[2][k]);
    if (is_surely_excluded(near.n, (const double(*)[3])around, unit)) continue;
    if (propose(a, c, h, unit, &near, a->star[p], err)) return -1;
  }
  return 0;
}

/* Propose the apex over a face. */
static int grow_face(struct advance *a, size_t face, struct vg_error *err)
{
  const uint32_t *v = &a->face[3 * face];
  const double(*x)[3] = (const double(*)[3])a->t->x;
  double c[3], h[6], unit[3];
  const struct near corners = { 3, { v[0], v[1], v[2] } };

  if (!vg_metric_apex(a->metrics->sizing, x[v[0]], x[v[1]], x[v[2]], c, h,
                      unit))
    return 0;
  return propose(a, c, h, unit, &corners, a->star[v[0]], err);
}

/* --- the front ------------------------------------------------------------ */

static int start_faces(struct advance *a)
{
  const struct vg_tets *t = a->t;
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++)
    if (!(t->flag[c] & (VG_OUTSIDE | VG_DEAD)))
      n += (size_t)__builtin_popcount(t->flag[c] & VG_FIXED_FACES);
  a->face = vg_alloc(3 * n, sizeof *a->face);
  if (!a->face) return -1;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (uint32_t i = 0; i < 4; i++) {
      if (t->flag[c] & (VG_OUTSIDE | VG_DEAD) || !(t->flag[c] >> i & 1))
        continue;
      for (int k = 0; k < 3; k++)
        a->face[3 * a->n_face + (size_t)k] = t->cell[c].v[vg_face[i][k]];
      a->n_face++;
    }
  return vg_buckets_reserve(&a->queue, n);
}

static double finest_root(const struct advance *a, const uint32_t v[3])
{
  double root = 0;

  for (int k = 0; k < 3; k++) root = fmax(root, a->metrics->at[v[k]].root);
  return root;
}

/* Faces are pushed first, so that they come before points of equal size. */
static int start(struct advance *a)
{
  const struct vg_tets *t = a->t;

  if (vg_reserve(&a->star, &a->cap_star, t->n_point, sizeof *a->star) ||
      vg_buckets_init(&a->queue, N_BUCKET) || start_faces(a))
    return -1;
  for (uint32_t i = 0; i < a->n_face; i++)
    vg_buckets_push(&a->queue, bucket_of(finest_root(a, &a->face[3 * i])), i);
  for (size_t p = 0; p < t->n_point; p++) a->star[p] = VG_NONE;
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int k = 0; k < 4 && !(t->flag[c] & (VG_OUTSIDE | VG_DEAD)); k++)
      a->star[t->cell[c].v[k]] = c;
  for (uint32_t p = 0; p < t->n_point; p++)
    if (a->star[p] != VG_NONE && push_point(a, p)) return -1;
  return 0;
}

static vg_status run(struct advance *a, size_t limit,
                     const struct vg_stop *stop, struct vg_error *err)
{
  uint32_t item;

  if (start(a)) return vg_fail_memory(err, "placing points");
  for (size_t k = 0; (item = vg_buckets_pop(&a->queue)) != VG_BUCKETS_NONE;
       k++) {
    int bad = item < a->n_face ? grow_face(a, item, err)
                               : grow_point(a, item - (uint32_t)a->n_face, err);

    if (bad) return vg_fail_memory(err, "placing points");
    if (limit && a->report->n_inserted > limit)
      return vg_fail(err, VG_ERR_UNSUPPORTED,
                     "more than %zu field points are needed; use a coarser "
                     "spacing or raise the limit",
                     limit);
    if (k % STOP_STEP == 0) {
      vg_status st = vg_stopped(stop, err);

      if (st != VG_OK) return st;
    }
  }
  return VG_OK;
}

vg_status vg_metric_advance(struct vg_tets *t, struct vg_metrics *metrics,
                            const struct vg_region *region, size_t limit,
                            const struct vg_stop *stop,
                            struct vg_metric_advance_report *report,
                            struct vg_error *err)
{
  struct advance a = {
    .t = t, .metrics = metrics, .region = region, .report = report
  };
  vg_status st = vg_inserter_init(&a.s, t, err);

  if (st == VG_OK) st = run(&a, limit, stop, err);
  vg_inserter_release(&a.s);
  vg_buckets_release(&a.queue);
  free(a.face);
  free(a.star);
  return st;
}
