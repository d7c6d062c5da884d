/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sizing/sizing_source.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing_cone.h"
#include "core/sizing/sizing_shape.h"
#include "core/sizing/sizing_tensor.h"

/* --- checks --------------------------------------------------------------- */

static int is_finite3(const double p[3])
{
  return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

static int has_axis(enum vg_source_kind kind)
{
  return kind == VG_SOURCE_VGRID_LINE || kind == VG_SOURCE_LINE ||
         kind == VG_SOURCE_CYLINDER || kind == VG_SOURCE_MACHCONE;
}

static int is_vgrid(enum vg_source_kind kind)
{
  return kind == VG_SOURCE_VGRID_NODE || kind == VG_SOURCE_VGRID_LINE;
}

/* Defect of a source and how to correct it, or NULL. */
static const char *defect(const struct vg_source *s)
{
  double d[3];

  if (s->kind < VG_SOURCE_VGRID_NODE || s->kind > VG_SOURCE_MACHCONE)
    return "its kind is unknown; use one of the documented kinds";
  if (!is_finite3(s->p0)) return "point 1 is not finite; give numbers";
  if ((has_axis(s->kind) || s->kind == VG_SOURCE_TRIANGLE ||
       s->kind == VG_SOURCE_BOX) &&
      !is_finite3(s->p1))
    return "point 2 is not finite; give numbers";
  if (s->kind == VG_SOURCE_TRIANGLE && !is_finite3(s->p2))
    return "point 3 is not finite; give numbers";
  if (!isfinite(s->h0) || s->h0 <= 0)
    return "its spacing is not positive; give a length above zero";
  if (has_axis(s->kind) && (!isfinite(s->h1) || s->h1 <= 0))
    return "its spacing at point 2 is not positive; give a length above zero";
  if (is_vgrid(s->kind))
    return !isfinite(s->an) || s->an <= 0
           ? "its intensity an is not positive; 1 is usual"
           : NULL;
  if (!isfinite(s->r0) || s->r0 < 0)
    return "its radius is negative or not finite; give zero or more";
  if (s->growth != 0 && !(isfinite(s->growth) && s->growth > 1))
    return "its growth rate is not above 1; use 0 for the global rate";
  if (s->kind == VG_SOURCE_MACHCONE) return vg_mach_cone_defect(s);
  if (s->kind != VG_SOURCE_CYLINDER) return NULL;
  if (!isfinite(s->r1) || s->r1 < 0)
    return "its second radius is negative or not finite; give zero or more";
  vg_sub(s->p1, s->p0, d);
  return vg_dot(d, d) > 0 ? NULL : "its axis has no length; use a sphere";
}

vg_status vg_source_check(size_t n, const struct vg_source *source,
                          struct vg_error *err)
{
  for (size_t i = 0; i < n; i++) {
    const struct vg_source *s = source + i;
    const char *what = defect(s);

    if (!what) what = vg_source_stretch_defect(s);
    if (!what) continue;
    return vg_fail(err, VG_ERR_INPUT, "source %zu%s%.32s%s at (%g, %g, %g): %s",
                   i + 1, s->group[0] ? " (" : "", s->group,
                   s->group[0] ? ")" : "", s->p0[0], s->p0[1], s->p0[2], what);
  }
  return VG_OK;
}

/* Arctangent and logarithm of our own: those of libm differ between systems in
 * the last bit, and the meshes would, too. Both are accurate to a few ulp. */

/* atan(z) / z for z >= 0, finite at 0. Two halvings of the angle bring z below
 * 0.2, where eleven terms of the series reach rounding accuracy. */
static double atan_ratio(double z)
{
  double w = z, sum = 0, y;

  if (z > 1) return (1.57079632679489661923 - atan_ratio(1 / z) / z) / z;
  for (int k = 0; k < 2; k++) w = w / (1 + sqrt(1 + w * w));
  y = -w * w;
  for (int k = 12; k >= 0; k--) sum = sum * y + 1.0 / (2 * k + 1);
  return z > 0 ? 4 * w * sum / z : 1;
}

/* 2 atanh(z) for |z| <= 0.18. */
static double log_series(double z)
{
  double y = z * z, sum = 0;

  for (int k = 12; k >= 0; k--) sum = sum * y + 1.0 / (2 * k + 1);
  return 2 * z * sum;
}

/* log(a / b), without cancellation if a and b are close. */
static double log_ratio(double a, double b)
{
  double z = (a - b) / (a + b), m;
  int e;

  if (z > -0.17 && z < 0.17) return log_series(z);
  m = frexp(a / b, &e);
  if (m < 0.70710678118654752440) {
    m *= 2;
    e--;
  }
  return log_series((m - 1) / (m + 1)) + e * 0.69314718055994530942;
}

/* --- VGRID's inverse-square mean ------------------------------------------ */

/* Kernel 1/r^2 averaged over a segment: plain in *weight, and times the linear
 * spacing in *size. It is averaged, not integrated over length: with an
 * integral, the mesh would depend on the unit of length as soon as there are
 * both nodes and lines (formats.md 1.7 leaves this open). Returns 0 on the
 * segment itself, with the spacing there in *size.
 *
 * With foot t = c and squared distance q |d|^2 from the axis,
 *   int dt / ((t-c)^2 + q)   = angle / sqrt(q),
 *   int t dt / ((t-c)^2 + q) = c times that + log(r1^2 / r0^2) / 2,
 * where angle is the angle that the segment subtends at x. */
static int line_kernel(const struct vg_source *s, const double x[3],
                       double *weight, double *size)
{
  double d[3], u[3], v[3], len2, c, q, r0, r1, cosine, j;

  vg_sub(s->p1, s->p0, d);
  vg_sub(x, s->p0, u);
  len2 = vg_dot(d, d);
  c = vg_dot(u, d) / len2;
  for (int k = 0; k < 3; k++) v[k] = u[k] - c * d[k];
  q = vg_dot(v, v) / len2;
  if (q <= 1e-24 && c >= 0 && c <= 1) {
    *size = s->h0 + c * (s->h1 - s->h0);
    return 0;
  }
  r0 = c * c + q;
  r1 = (1 - c) * (1 - c) + q;
  cosine = q + c * (c - 1);
  if (cosine > 0) j = atan_ratio(sqrt(q) / cosine) / cosine;
  else
    j = (3.14159265358979323846 -
         (cosine < 0 ? atan_ratio(sqrt(q) / -cosine) * (sqrt(q) / -cosine)
                     : 1.57079632679489661923)) /
        sqrt(q);
  *weight = j / len2;
  *size = ((s->h0 + c * (s->h1 - s->h0)) * j +
           0.5 * (s->h1 - s->h0) * log_ratio(r1, r0)) /
          len2;
  return 1;
}

double vg_source_mean(size_t n, const struct vg_source *source,
                      const double x[3])
{
  double top = 0, bottom = 0;

  if (!n) return INFINITY;
  for (size_t i = 0; i < n; i++) {
    const struct vg_source *s = source + i;
    double d[3], w, h;

    if (s->kind == VG_SOURCE_VGRID_LINE) {
      if (!line_kernel(s, x, &w, &h)) return h;
    } else {
      vg_sub(x, s->p0, d);
      w = vg_dot(d, d);
      if (w <= 0) return s->h0;
      w = 1 / w;
      h = s->h0 * w;
    }
    top += s->an * h;
    bottom += s->an * w;
  }
  return top / bottom;
}

/* The tensor `across` I + (along - across) u u'. */
static void axial(double across, double along, const double u[3], double h[6])
{
  int n = 0;

  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++)
      h[n++] = (i == j ? across : 0) + (along - across) * u[i] * u[j];
}

void vg_source_mean_tensor(size_t n, const struct vg_source *source,
                           const double x[3], double h[6])
{
  double bottom = 0, top[6] = { 0 };

  for (size_t i = 0; i < n; i++) {
    const struct vg_source *s = source + i;
    double w = 1, across = s->h0, along = s->sp0, one[6];
    int is_off = 1;

    if (s->kind == VG_SOURCE_VGRID_LINE) {
      struct vg_source other = *s;

      other.h0 = s->sp0;
      other.h1 = s->sp1;
      is_off = line_kernel(s, x, &w, &across);
      line_kernel(&other, x, &w, &along);
    } else if (vg_distance2(x, s->p0) > 0) {
      w = 1 / vg_distance2(x, s->p0);
      across *= w;
      along *= w;
    } else {
      is_off = 0;
    }
    axial(across, along, s->p, one);
    if (!is_off) {
      memcpy(h, one, sizeof one);
      return;
    }
    bottom += s->an * w;
    for (int k = 0; k < 6; k++) top[k] += s->an * one[k];
  }
  for (int k = 0; k < 6; k++) h[k] = top[k] / bottom;
}

/* Spacing of one bounded source at x. */
static double bounded_at(const struct vg_bounded *b, const double x[3])
{
  const struct vg_source *s = &b->law;
  double d = 0, t = 0, way[3];

  switch (s->kind) {
  case VG_SOURCE_VGRID_LINE:
  case VG_SOURCE_LINE:
    d = vg_segment_distance(s->p0, s->p1, x, &t) - s->r0;
    break;
  case VG_SOURCE_TRIANGLE: d = vg_triangle_distance(s, x, way) - s->r0; break;
  case VG_SOURCE_BOX: d = vg_box_distance(s->p0, s->p1, x); break;
  case VG_SOURCE_CYLINDER: d = vg_cone_distance(s, x, &t); break;
  case VG_SOURCE_MACHCONE: d = vg_mach_cone_way(s, x, &t, way); break;
  case VG_SOURCE_VGRID_NODE:
  case VG_SOURCE_POINT:
  case VG_SOURCE_SPHERE:
    d = vg_segment_distance(s->p0, s->p0, x, &t) - s->r0;
    break;
  }
  return s->h0 + t * (s->h1 - s->h0) + b->slope * vg_greater(d, 0);
}

/* Extent of a box from its centre along a direction, which need not be
 * normalised. */
static double reach_along(const double way[3], const double half[3])
{
  double sum = 0, len = sqrt(vg_dot(way, way));

  for (int k = 0; k < 3; k++) sum += fabs(way[k]) * half[k];
  return len > 0 ? sum / len : 0;
}

/* Lower bound of one bounded source in a box. Distances from convex shapes are
 * convex functions, so they are nowhere below their tangent plane at the
 * centre. */
static double bounded_floor(const struct vg_bounded *b, const double mid[3],
                            const double half[3])
{
  const struct vg_source *s = &b->law;
  double d, t = 0, h = s->h0, way[3], axis[3];
  int is_line = s->kind == VG_SOURCE_LINE || s->kind == VG_SOURCE_VGRID_LINE;

  if (s->kind == VG_SOURCE_BOX || s->kind == VG_SOURCE_CYLINDER ||
      s->kind == VG_SOURCE_MACHCONE)
    return bounded_at(b, mid) - b->steep * sqrt(vg_dot(half, half));
  if (s->kind == VG_SOURCE_TRIANGLE) d = vg_triangle_distance(s, mid, way);
  else d = vg_segment_way(s->p0, is_line ? s->p1 : s->p0, mid, &t, way);
  if (is_line) {
    double len;

    vg_sub(s->p1, s->p0, axis);
    len = sqrt(vg_dot(axis, axis));
    h += t * (s->h1 - s->h0);
    if (len > 0) h -= fabs(s->h1 - s->h0) / len * reach_along(axis, half);
  }
  d -= s->r0 + reach_along(way, half);
  return vg_greater(h, b->least) + b->slope * vg_greater(d, 0);
}

/* --- lists of sources ----------------------------------------------------- */

/* Box around the shape; for a slanted cone larger than necessary. */
static void bound_shape(const struct vg_source *s, double lo[3], double hi[3])
{
  double r = s->kind == VG_SOURCE_BOX ? 0 : s->r0;

  if (s->kind == VG_SOURCE_MACHCONE) {
    vg_mach_cone_bounds(s, lo, hi);
    return;
  }
  if (s->kind == VG_SOURCE_CYLINDER) r = vg_greater(s->r0, s->r1);
  for (int k = 0; k < 3; k++) {
    lo[k] = hi[k] = s->p0[k];
    if (has_axis(s->kind) || s->kind == VG_SOURCE_TRIANGLE ||
        s->kind == VG_SOURCE_BOX) {
      lo[k] = vg_lesser(lo[k], s->p1[k]);
      hi[k] = vg_greater(hi[k], s->p1[k]);
    }
    if (s->kind == VG_SOURCE_TRIANGLE) {
      lo[k] = vg_lesser(lo[k], s->p2[k]);
      hi[k] = vg_greater(hi[k], s->p2[k]);
    }
    lo[k] -= r;
    hi[k] += r;
  }
}

static void prepare_bounded(const struct vg_sizing_options *o,
                            const struct vg_source *s, struct vg_bounded *b)
{
  double d[3], along;

  b->law = *s;
  b->law.h0 *= o->scale;
  b->law.h1 = has_axis(s->kind) ? s->h1 * o->scale : b->law.h0;
  if (is_vgrid(s->kind)) b->law.r0 = b->law.r1 = 0;
  b->slope = !is_vgrid(s->kind) && s->growth > 0 ? o->scale * (s->growth - 1)
                                                 : o->growth - 1;
  b->least = vg_lesser(b->law.h0, b->law.h1);
  b->steep = b->slope;
  bound_shape(&b->law, b->lo, b->hi);
  if (s->kind == VG_SOURCE_BOX)
    for (int k = 0; k < 3; k++) {
      b->law.p0[k] = b->lo[k];
      b->law.p1[k] = b->hi[k];
    }
  if (!has_axis(s->kind)) return;
  vg_sub(s->p1, s->p0, d);
  along = vg_dot(d, d);
  if (along <= 0) {
    b->law.h0 = b->law.h1 = b->least;
    return;
  }
  if (s->kind == VG_SOURCE_MACHCONE) along = s->r0 * s->r0;
  along = (b->law.h1 - b->law.h0) * (b->law.h1 - b->law.h0) / along;
  b->steep = sqrt(b->slope * b->slope + along);
}

static void prepare_stretched(const struct vg_sizing_options *o,
                              const struct vg_source *s, struct vg_stretched *t)
{
  struct vg_bounded b;

  prepare_bounded(o, s, &b);
  t->law = b.law;
  t->slope = b.slope;
  memcpy(t->lo, b.lo, sizeof t->lo);
  memcpy(t->hi, b.hi, sizeof t->hi);
  vg_stretched_prepare(t);
}

/* A VGRID line of zero length is treated as a node with its mean spacing. The
 * axis of the size tensor goes to p, the spacings along it to sp0 and sp1. */
static void prepare_mean(const struct vg_sizing_options *o,
                         const struct vg_source *s, struct vg_source *m)
{
  double d[3], ratio[2];

  *m = *s;
  m->h0 *= o->scale;
  m->h1 *= o->scale;
  if (!vg_source_stretch(s, m->p, ratio)) memset(m->p, 0, sizeof m->p);
  m->sp0 = ratio[0] * m->h0;
  m->sp1 = ratio[1] * m->h1;
  if (m->kind != VG_SOURCE_VGRID_LINE) return;
  vg_sub(m->p1, m->p0, d);
  if (vg_dot(d, d) > 0) return;
  m->kind = VG_SOURCE_VGRID_NODE;
  m->h0 = 0.5 * (m->h0 + m->h1);
  m->sp0 = 0.5 * (m->sp0 + m->sp1);
}

#define REACH 0.25 /* H10: the fraction described below */

/* The mean varies next to a node over a fraction of the distance to the next
 * source, and next to a line over a fraction of its length. This takes
 * quadratic time, but so does the evaluation: every sample of the field
 * depends on all sources. */
static void find_reach(struct vg_source_set *set)
{
  for (size_t i = 0; i < set->n_mean; i++) {
    const struct vg_source *s = set->mean + i;
    double d = INFINITY, t;

    if (s->kind == VG_SOURCE_VGRID_LINE)
      d = vg_segment_distance(s->p0, s->p0, s->p1, &t);
    else
      for (size_t j = 0; j < set->n_mean; j++) {
        const struct vg_source *o = set->mean + j;
        int is_line = o->kind == VG_SOURCE_VGRID_LINE;

        if (j == i) continue;
        d = vg_lesser(d, vg_segment_distance(o->p0, is_line ? o->p1 : o->p0,
                                             s->p0, &t));
      }
    set->reach[i] = REACH * d;
  }
}

static void put_shape(const struct vg_sizing_options *o,
                      const struct vg_source *s, struct vg_source_set *set)
{
  struct vg_stretched *t = set->stretched + set->n_stretched;

  if (!vg_source_stretch(s, t->axis[0], t->ratio)) {
    prepare_bounded(o, s, set->bounded + set->n_bounded++);
    return;
  }
  prepare_stretched(o, s, t);
  set->n_stretched++;
}

vg_status vg_source_prepare(const struct vg_sizing_options *options, size_t n,
                            const struct vg_source *source, int cones,
                            struct vg_source_set *set, struct vg_error *err)
{
  vg_status st;

  if (!n) return VG_OK;
  set->bounded = vg_alloc(n, sizeof *set->bounded);
  set->mean = vg_alloc(n, sizeof *set->mean);
  set->reach = vg_alloc(n, sizeof *set->reach);
  set->stretched = vg_alloc(n, sizeof *set->stretched);
  if (!set->bounded || !set->mean || !set->reach || !set->stretched) {
    vg_source_release(set);
    return vg_fail_memory(err, "the sources");
  }
  for (size_t i = 0; i < n; i++)
    if (is_vgrid(source[i].kind))
      prepare_mean(options, source + i, set->mean + set->n_mean++);
    else put_shape(options, source + i, set);
  for (size_t i = 0; i < set->n_mean; i++)
    if (vg_dot(set->mean[i].p, set->mean[i].p) > 0) set->mean_is_stretched = 1;
  for (size_t i = 0; cones && i < n; i++)
    if (is_vgrid(source[i].kind)) put_shape(options, source + i, set);
  if (cones) find_reach(set);
  st = vg_stretched_groups_make(set->n_stretched, set->stretched, &set->groups,
                                err);
  if (st < 0) vg_source_release(set);
  return st;
}

void vg_source_release(struct vg_source_set *set)
{
  free(set->bounded);
  free(set->mean);
  free(set->reach);
  free(set->stretched);
  vg_stretched_groups_release(&set->groups);
  memset(set, 0, sizeof *set);
}

static int is_before(const double a[3], const double b[3])
{
  for (int k = 0; k < 3; k++)
    if (a[k] != b[k]) return a[k] < b[k];
  return 0;
}

static double note_fault(struct vg_map_fault *f, const double x[3],
                         const double *value, size_t n)
{
  while (atomic_flag_test_and_set(&f->busy)) {
  }
  if (!f->n++ || is_before(x, f->x)) {
    memcpy(f->x, x, sizeof f->x);
    memcpy(f->value, value, n * sizeof *value);
  }
  atomic_flag_clear(&f->busy);
  return INFINITY;
}

static double map_at(const struct vg_source_set *set, const double x[3])
{
  double h = set->map->at(set->map->user, x);

  return h > 0 ? h : note_fault(set->fault, x, &h, 1);
}

static double map_floor(const struct vg_source_set *set, const double lo[3],
                        const double hi[3])
{
  double h, x[3];

  if (set->map->least) return set->map->least(set->map->user, lo, hi);
  for (int k = 0; k < 3; k++) x[k] = 0.5 * (lo[k] + hi[k]);
  h = map_at(set, x);
  for (int i = 0; i < 8; i++) {
    for (int k = 0; k < 3; k++) x[k] = i >> k & 1 ? hi[k] : lo[k];
    h = vg_lesser(h, map_at(set, x));
  }
  return h;
}

double vg_source_at(const struct vg_source_set *set, const double x[3])
{
  double h = set->mean_is_stretched ? INFINITY
                                    : vg_source_mean(set->n_mean, set->mean, x);

  if (set->map) h = vg_lesser(h, map_at(set, x));
  for (size_t i = 0; i < set->n_bounded; i++) {
    const struct vg_bounded *b = set->bounded + i;

    if (b->least >= h ||
        b->least + b->slope * vg_box_distance(b->lo, b->hi, x) >= h)
      continue;
    h = vg_lesser(h, bounded_at(b, x));
  }
  return h;
}

static int is_metric(const double m[6])
{
  for (int k = 0; k < 6; k++)
    if (!isfinite(m[k])) return 0;
  return m[0] > 0 && m[0] * m[3] > m[1] * m[1] && vg_tensor_det(m) > 0;
}

static int is_zero(const double m[6])
{
  for (int k = 0; k < 6; k++)
    if (m[k] != 0) return 0;
  return 1;
}

/* Is a - b positive semidefinite? */
static int is_at_least(const double a[6], const double b[6])
{
  double d[6];

  for (int k = 0; k < 6; k++) d[k] = a[k] - b[k];
  return d[0] >= 0 && d[3] >= 0 && d[5] >= 0 && d[0] * d[3] >= d[1] * d[1] &&
         d[0] * d[5] >= d[2] * d[2] && d[3] * d[5] >= d[4] * d[4] &&
         vg_tensor_det(d) >= 0;
}

/* Intersection of the sizes so far: by its axes and, if they are not known, as
 * a metric. Most tensors are finer than the other in all directions, or one of
 * both is isotropic, which costs no eigenvalues. */
struct joined {
  struct vg_size_axes *a;
  double m[6];
  int has_axes, has_metric;
};

static void limit_sizes(struct vg_size_axes *a, double h)
{
  for (int k = 0; k < 3; k++) a->size[k] = vg_lesser(a->size[k], h);
}

static void join(struct joined *j, const struct vg_size_axes *b)
{
  double m[6], h = j->a->size[0];

  if (j->has_axes && vg_size_axes_are_equal(j->a)) {
    *j->a = *b;
    limit_sizes(j->a, h);
    j->has_metric = 0;
    return;
  }
  if (j->has_axes && vg_size_axes_are_equal(b)) {
    limit_sizes(j->a, b->size[0]);
    j->has_metric = 0;
    return;
  }
  if (!j->has_metric) vg_size_axes_metric(j->a, j->m);
  j->has_metric = 1;
  vg_size_axes_metric(b, m);
  if (is_at_least(m, j->m)) {
    *j->a = *b;
    j->has_axes = 1;
    memcpy(j->m, m, sizeof m);
  } else if (!is_at_least(j->m, m)) {
    vg_metric_intersect(j->m, m, j->m);
    j->has_axes = 0;
  }
}

static void join_group(struct joined *j, const struct vg_stretched_group *g,
                       const double x[3])
{
  const double most = j->has_axes ? vg_size_axes_most(j->a) : INFINITY;
  struct vg_size_axes a;

  if (vg_stretched_group_at(g, x, most, &a)) join(j, &a);
}

static void join_map(struct joined *j, const struct vg_source_set *set,
                     const double x[3])
{
  struct vg_size_axes a;
  double m[6];

  set->metric->metric(set->metric->user, x, m);
  if (is_zero(m)) return;
  if (!is_metric(m)) {
    note_fault(set->fault, x, m, 6);
    return;
  }
  vg_size_axes_of_metric(m, &a);
  join(j, &a);
}

void vg_source_axes_at(const struct vg_source_set *set, const double x[3],
                       double h, struct vg_size_axes *out)
{
  struct joined j;
  double mean[6];

  j.a = out;
  j.has_axes = 1;
  j.has_metric = 0;
  out->size[0] = out->size[1] = out->size[2] = h;
  if (set->mean_is_stretched) {
    vg_source_mean_tensor(set->n_mean, set->mean, x, mean);
    vg_size_axes_of(mean, out);
    limit_sizes(out, h);
  }
  for (size_t i = 0; i < set->groups.n; i++)
    join_group(&j, set->groups.item + i, x);
  if (set->metric) join_map(&j, set, x);
  if (!j.has_axes) vg_size_axes_of_metric(j.m, out);
}

/* There are two bounds per source: one from the box around its shape, which is
 * coarse for boxes of any size, and one from the law at the centre, which
 * becomes exact as the box shrinks. */
double vg_source_floor(const struct vg_source_set *set, const double lo[3],
                       const double hi[3])
{
  double h = set->map ? map_floor(set, lo, hi) : INFINITY, mid[3], half[3];

  for (int k = 0; k < 3; k++) {
    mid[k] = 0.5 * (lo[k] + hi[k]);
    half[k] = hi[k] - mid[k];
  }
  for (size_t i = 0; i < set->n_bounded; i++) {
    const struct vg_bounded *b = set->bounded + i;
    double d2 = 0, d, bound;

    for (int k = 0; k < 3; k++) {
      d = vg_greater(vg_greater(b->lo[k] - hi[k], lo[k] - b->hi[k]), 0);
      d2 += d * d;
    }
    bound = b->least + b->slope * sqrt(d2);
    if (bound >= h) continue;
    bound = vg_greater(bound, bounded_floor(b, mid, half));
    h = vg_lesser(h, bound);
  }
  return h;
}

int vg_source_resolved(const struct vg_source_set *set, const double lo[3],
                       const double hi[3], double side)
{
  double mid[3], r2 = 0, t;

  if (set->n_mean < 2)
    return 1; /* a single node is constant; a single line
                 is bounded */
  for (int k = 0; k < 3; k++) {
    mid[k] = 0.5 * (lo[k] + hi[k]);
    r2 += (hi[k] - mid[k]) * (hi[k] - mid[k]);
  }
  for (size_t i = 0; i < set->n_mean; i++) {
    const struct vg_source *s = set->mean + i;
    int is_line = s->kind == VG_SOURCE_VGRID_LINE;
    double d = vg_segment_distance(s->p0, is_line ? s->p1 : s->p0, mid, &t);

    if (side > vg_greater(d - sqrt(r2), set->reach[i])) return 0;
  }
  return 1;
}

static void widen(const double from_lo[3], const double from_hi[3],
                  int is_first, double lo[3], double hi[3])
{
  for (int k = 0; k < 3; k++) {
    if (is_first || from_lo[k] < lo[k]) lo[k] = from_lo[k];
    if (is_first || from_hi[k] > hi[k]) hi[k] = from_hi[k];
  }
}

int vg_source_bounds(const struct vg_source_set *set, double lo[3],
                     double hi[3])
{
  for (size_t i = 0; i < set->n_bounded; i++)
    widen(set->bounded[i].lo, set->bounded[i].hi, !i, lo, hi);
  for (size_t i = 0; i < set->n_stretched; i++)
    widen(set->stretched[i].lo, set->stretched[i].hi, !i && !set->n_bounded, lo,
          hi);
  return set->n_bounded || set->n_stretched;
}
