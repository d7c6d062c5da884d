/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/metric.h: target edge length as a function of position and
 * direction: a size, and a symmetric tensor (form) that scales it in each
 * direction (George and Borouchaki, "Delaunay Triangulation and Meshing", 1998,
 * chapter 10). Private to core/remesh.
 *
 * Where edges are not stretched the size is sufficient: functions that take a
 * form accept NULL and then compute isotropic lengths.
 *
 * The metric of a sizing field is restricted to the tangent plane: its size
 * normal to the surface has no influence, since the shape of the surface
 * determines how far an edge may deviate from it. Points of feature curves have
 * no tangent plane and take the metric in all directions. */
#ifndef VG_CORE_REMESH_METRIC_H
#define VG_CORE_REMESH_METRIC_H

#include <assert.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing.h"

struct vg_metric {
  double size;    /* Smallest target length over all directions. */
  double form[6]; /* Components xx, yy, zz, xy, yz, zx; the largest eigenvalue
                     is 1. An edge e has its target length if e^T form e equals
                     the squared size. */
};

/** Inner product a^T form b. */
static inline double vg_form_dot(const double *form, const double a[3],
                                 const double b[3])
{
  if (!form) return vg_dot(a, b);
  return form[0] * a[0] * b[0] + form[1] * a[1] * b[1] + form[2] * a[2] * b[2] +
         form[3] * (a[0] * b[1] + a[1] * b[0]) +
         form[4] * (a[1] * b[2] + a[2] * b[1]) +
         form[5] * (a[2] * b[0] + a[0] * b[2]);
}

static inline double vg_form_norm(const double *form, const double a[3])
{
  return sqrt(vg_form_dot(form, a, a));
}

/** Squared norm of the cross product n of two vectors in the metric of the
 * form, that is, of twice the area of their triangle. */
static inline double vg_form_area2(const double *form, const double n[3])
{
  const double *f = form;

  if (!f) return vg_dot(n, n);
  /* By the cofactors of the form. */
  return (f[1] * f[2] - f[4] * f[4]) * n[0] * n[0] +
         (f[0] * f[2] - f[5] * f[5]) * n[1] * n[1] +
         (f[0] * f[1] - f[3] * f[3]) * n[2] * n[2] +
         2 * ((f[4] * f[5] - f[3] * f[2]) * n[0] * n[1] +
              (f[3] * f[5] - f[4] * f[0]) * n[1] * n[2] +
              (f[3] * f[4] - f[5] * f[1]) * n[2] * n[0]);
}

/** Mean of three forms on a triangle with the normal n, which need not be a
 * unit vector. The forms are scaled such that areas on the triangle are equal
 * in all of them. Returns 0 if the triangle has no area. */
static inline int vg_form_mean(const double *a, const double *b,
                               const double *c, const double n[3], double *form)
{
  const double a2 = vg_form_area2(a, n), b2 = vg_form_area2(b, n);
  const double c2 = vg_form_area2(c, n);
  double wa, wb, wc;

  if (!(a2 > 0 && b2 > 0 && c2 > 0)) return 0;
  wa = sqrt(b2 * c2);
  wb = sqrt(a2 * c2);
  wc = sqrt(a2 * b2);
  for (int k = 0; k < 6; k++) form[k] = wa * a[k] + wb * b[k] + wc * c[k];
  return 1;
}

/** Squared sine of the smallest angle of a triangle in the metric of the
 * form. */
static inline double vg_form_shape(const double *form, const double *a,
                                   const double *b, const double *c)
{
  double u[3], v[3], w[3], n[3], l[3], least;

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_sub(b, c, w);
  vg_cross(u, v, n);
  l[0] = vg_form_dot(form, u, u);
  l[1] = vg_form_dot(form, v, v);
  l[2] = vg_form_dot(form, w, w);
  least = l[0] < l[1] ? l[0] : l[1];
  if (l[2] < least) least = l[2];
  if (!(least > 0)) return 0;
  return vg_form_area2(form, n) * least / (l[0] * l[1] * l[2]);
}

/** Set the form so that edges along the unit vector d are `by` >= 1 times as
 * long as across it. d is ignored if `by` is 1. */
void vg_form_stretch(double *form, const double d[3], double by);

/** Make u and v orthonormal in the metric of the form, within the plane that
 * they span. u keeps its direction. */
void vg_form_frame(const double *form, double u[3], double v[3]);

/** Ratio of the largest to the smallest target length in the plane with normal
 * n, which need not be a unit vector but must not be 0. */
double vg_form_aspect(const double *form, const double n[3]);

/** Length of the edge e between points with metrics a and b, relative to the
 * mean of their target lengths along e. 0 for an edge of zero length. */
static inline double vg_metric_ratio(const struct vg_metric *a,
                                     const struct vg_metric *b,
                                     const double e[3])
{
  assert(a->size > 0 && b->size > 0);

  const double la = vg_form_norm(a->form, e) / a->size;
  const double lb = vg_form_norm(b->form, e) / b->size;

  return la + lb > 0 ? 2 * la * lb / (la + lb) : 0;
}

/** Length of the edge e between points with metrics a and b in a metric whose
 * sizes change geometrically along it (core/geometry/tensor.h). */
static inline double vg_metric_span(const struct vg_metric *a,
                                    const struct vg_metric *b,
                                    const double e[3])
{
  assert(a->size > 0 && b->size > 0);
  return vg_log_mean(vg_form_norm(a->form, e) / a->size,
                     vg_form_norm(b->form, e) / b->size);
}

/** Target length along d, which may have any length but 0. */
static inline double vg_metric_along(const struct vg_metric *m,
                                     const double d[3])
{
  assert(m->size > 0);
  return m->size * vg_norm(d) / vg_form_norm(m->form, d);
}

/** Intersect *m with the metric of the field at x.
 *
 * @param n         unit normal of the surface, to whose plane the metric of
 *                  the field is restricted; NULL: not restricted
 * @param factor    on the sizes of the field
 * @param has_form  0: m->form is not set, and lengths are equal in all
 *                  directions
 * @param m         in: the size and form that the surface requests; out: the
 *                  same, with the form set. Normal to the surface, edges have
 *                  the largest length within it.
 * Threads: safe. */
void vg_follow_field(const struct vg_sizing *field, const double x[3],
                     const double *n, double factor, int has_form,
                     struct vg_metric *m);

#endif
