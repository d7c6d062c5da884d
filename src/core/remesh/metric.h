/* core/remesh/metric.h: edge lengths asked for at a place, by direction: a
 * size, and a symmetric tensor that is its share in each direction (George and
 * Borouchaki, "Delaunay Triangulation and Meshing", 1998, chapter 10). Private
 * to core/remesh.
 *
 * Where nothing is stretched the size says all: functions that take a form take
 * NULL for that, and then do what they would without tensors. */
#ifndef VG_CORE_REMESH_METRIC_H
#define VG_CORE_REMESH_METRIC_H

#include <assert.h>

#include "core/geometry/vector.h"

struct vg_metric {
  double size;    /* least of all directions */
  double form[6]; /* xx, yy, zz, xy, yz, zx; its largest eigenvalue is
                     1. An edge e is as long as asked where e form e
                     is the squared size */
};

/** a form b. */
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

/** Squared norm of the cross product n of two vectors, were they measured by
 * the form: twice the area of their triangle. */
static inline double vg_form_area2(const double *form, const double n[3])
{
  const double *f = form;

  if (!f) return vg_dot(n, n);
  /* by the cofactors */
  return (f[1] * f[2] - f[4] * f[4]) * n[0] * n[0] +
         (f[0] * f[2] - f[5] * f[5]) * n[1] * n[1] +
         (f[0] * f[1] - f[3] * f[3]) * n[2] * n[2] +
         2 * ((f[4] * f[5] - f[3] * f[2]) * n[0] * n[1] +
              (f[3] * f[5] - f[4] * f[0]) * n[1] * n[2] +
              (f[3] * f[4] - f[5] * f[1]) * n[2] * n[0]);
}

/** Square of the sine of the smallest angle of a triangle, as measured by the
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

/** Edges along the unit vector d are `by` >= 1 times as long as across it. d
 * does not matter where by is 1. */
void vg_form_stretch(double *form, const double d[3], double by);

/** Vectors in the plane of u and v that have length 1 and right angles, as
 * measured by the form; u keeps its direction. */
void vg_form_frame(const double *form, double u[3], double v[3]);

/** Largest length asked for over the least, in the plane with the normal n
 * (any length but 0). */
double vg_form_aspect(const double *form, const double n[3]);

/** Length of the edge e between places that ask for a and b, in parts of the
 * mean of what they ask for along it. 0 for an edge of no length. */
static inline double vg_metric_length(const struct vg_metric *a,
                                      const struct vg_metric *b,
                                      const double e[3])
{
  assert(a->size > 0 && b->size > 0);

  const double la = vg_form_norm(a->form, e) / a->size;
  const double lb = vg_form_norm(b->form, e) / b->size;

  return la + lb > 0 ? 2 * la * lb / (la + lb) : 0;
}

/** Length asked for along d, of any length but 0. */
static inline double vg_metric_along(const struct vg_metric *m,
                                     const double d[3])
{
  assert(m->size > 0);
  return m->size * vg_norm(d) / vg_form_norm(m->form, d);
}

#endif
