/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/vector.h: three-dimensional vectors in plain floating-point
 * arithmetic. Use core/geometry/predicates.h where a sign must be exact. */
#ifndef VG_CORE_GEOMETRY_VECTOR_H
#define VG_CORE_GEOMETRY_VECTOR_H

#include <math.h>

static inline double vg_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vg_norm(const double a[3])
{
  return sqrt(vg_dot(a, a));
}

static inline void vg_sub(const double a[3], const double b[3], double out[3])
{
  for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static inline void vg_cross(const double a[3], const double b[3], double out[3])
{
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}

/** a . (b x c). */
static inline double vg_triple(const double a[3], const double b[3],
                               const double c[3])
{
  double n[3];

  vg_cross(b, c, n);
  return vg_dot(a, n);
}

/** Scale a to length 1. Returns its original length; a zero vector is left
 * unchanged. */
static inline double vg_unit(double a[3])
{
  double l = vg_norm(a);

  if (l > 0)
    for (int k = 0; k < 3; k++) a[k] /= l;
  return l;
}

/** Two unit vectors normal to the unit vector n and to each other. */
static inline void vg_normals(const double n[3], double u[3], double v[3])
{
  int k = fabs(n[0]) < fabs(n[1]) ? 0 : 1;

  if (fabs(n[2]) < fabs(n[k])) k = 2;
  for (int i = 0; i < 3; i++) u[i] = i == k;
  vg_cross(n, u, v);
  vg_unit(v);
  vg_cross(v, n, u);
}

static inline double vg_distance2(const double a[3], const double b[3])
{
  double d[3];

  vg_sub(a, b, d);
  return vg_dot(d, d);
}

static inline double vg_distance(const double a[3], const double b[3])
{
  return sqrt(vg_distance2(a, b));
}

/** Area of the triangle a b c. */
static inline double vg_triangle_area(const double a[3], const double b[3],
                                      const double c[3])
{
  double u[3], v[3], n[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(u, v, n);
  return vg_norm(n) / 2;
}

/** Six times the volume of the tetrahedron o, a, b, c. */
static inline double vg_det(const double o[3], const double a[3],
                            const double b[3], const double c[3])
{
  double u[3], v[3], w[3];

  vg_sub(a, o, u);
  vg_sub(b, o, v);
  vg_sub(c, o, w);
  return vg_triple(w, u, v);
}

/** Distance of the point p + v (v a unit vector) from the corner at p of the
 * triangle p, a, b with unit normal n. The triangle is extended to infinity,
 * beyond its edge a b. */
static inline double vg_off_corner(const double p[3], const double a[3],
                                   const double b[3], const double n[3],
                                   const double v[3])
{
  double edge[2][3], in[3], side[2], least = 1;

  vg_sub(a, p, edge[0]);
  vg_sub(b, p, edge[1]);
  for (int s = 0; s < 2; s++) vg_unit(edge[s]);
  vg_cross(n, edge[0], in);
  side[0] = vg_dot(v, in);
  vg_cross(edge[1], n, in);
  side[1] = vg_dot(v, in);
  if (side[0] >= 0 && side[1] >= 0) return vg_dot(v, n);
  for (int s = 0; s < 2; s++) { /* v projects outside the corner: distance
                                   from its edges */
    double along = vg_dot(v, edge[s]);
    double off = along > 0 ? sqrt(fmax(0, 1 - along * along)) : 1;

    if (off < least) least = off;
  }
  return least;
}

#endif
