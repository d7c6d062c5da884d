/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/tensor.h: symmetric 3 x 3 tensors and metrics.
 *
 * A tensor is its six components xx, xy, xz, yy, yz, zz. A metric M is a
 * positive tensor: the edge e has the length sqrt(e' M e) in it. Its stretch
 * T = M^(1/2) maps space so that lengths in the metric become Euclidean
 * lengths, and its size tensor H = M^(-1/2) has the target edge lengths as
 * eigenvalues:
 *
 *        __----__                    _--_
 *      <__  H  __>   -- T = 1/H --> (    )  unit sphere
 *         ----                       ¯--¯
 *
 * All functions use + - * / and sqrt only, so that results are the same on
 * all processors. Threads: safe. */
#ifndef VG_CORE_GEOMETRY_TENSOR_H
#define VG_CORE_GEOMETRY_TENSOR_H

#include <math.h>

/** A metric, and the square root of its determinant: the number of unit cells
 * per volume. */
struct vg_point_metric {
  double m[6];
  double root;
};

/** out = a v. out may be v. */
static inline void vg_tensor_apply(const double a[6], const double v[3],
                                   double out[3])
{
  double x = v[0], y = v[1], z = v[2];

  out[0] = a[0] * x + a[1] * y + a[2] * z;
  out[1] = a[1] * x + a[3] * y + a[4] * z;
  out[2] = a[2] * x + a[4] * y + a[5] * z;
}

/** v' a v. */
static inline double vg_tensor_form(const double a[6], const double v[3])
{
  return v[0] * (a[0] * v[0] + 2 * (a[1] * v[1] + a[2] * v[2])) +
         v[1] * (a[3] * v[1] + 2 * a[4] * v[2]) + a[5] * v[2] * v[2];
}

static inline double vg_tensor_det(const double a[6])
{
  return a[0] * (a[3] * a[5] - a[4] * a[4]) -
         a[1] * (a[1] * a[5] - a[4] * a[2]) +
         a[2] * (a[1] * a[4] - a[3] * a[2]);
}

/** Trace of the product a b. */
static inline double vg_tensor_trace2(const double a[6], const double b[6])
{
  return a[0] * b[0] + a[3] * b[3] + a[5] * b[5] +
         2 * (a[1] * b[1] + a[2] * b[2] + a[4] * b[4]);
}

/** out = det(a) / a, the adjugate. out may be a. Returns the determinant. */
static inline double vg_tensor_adjugate(const double a[6], double out[6])
{
  double xx = a[3] * a[5] - a[4] * a[4], xy = a[2] * a[4] - a[1] * a[5];
  double xz = a[1] * a[4] - a[2] * a[3], yy = a[0] * a[5] - a[2] * a[2];
  double yz = a[1] * a[2] - a[0] * a[4], zz = a[0] * a[3] - a[1] * a[1];
  double det = a[0] * xx + a[1] * xy + a[2] * xz;

  out[0] = xx;
  out[1] = xy;
  out[2] = xz;
  out[3] = yy;
  out[4] = yz;
  out[5] = zz;
  return det;
}

/** out = 1 / a for a positive tensor. out may be a. Returns the determinant of
 * a; if it is not positive, out has no meaning. */
static inline double vg_tensor_invert(const double a[6], double out[6])
{
  double det = vg_tensor_adjugate(a, out);

  for (int k = 0; k < 6; k++) out[k] /= det;
  return det;
}

/** out = a a. out must not be a. */
static inline void vg_tensor_square(const double a[6], double out[6])
{
  out[0] = a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
  out[1] = a[0] * a[1] + a[1] * a[3] + a[2] * a[4];
  out[2] = a[0] * a[2] + a[1] * a[4] + a[2] * a[5];
  out[3] = a[1] * a[1] + a[3] * a[3] + a[4] * a[4];
  out[4] = a[1] * a[2] + a[3] * a[4] + a[4] * a[5];
  out[5] = a[2] * a[2] + a[4] * a[4] + a[5] * a[5];
}

/** a = value I. */
static inline void vg_tensor_uniform(double value, double a[6])
{
  a[0] = a[3] = a[5] = value;
  a[1] = a[2] = a[4] = 0;
}

/** Cube root of x > 0, within 2 units in the last place. */
double vg_cube_root(double x);

/** Eigenvalues of a, ascending, and orthonormal eigenvectors vector[k], by
 * Jacobi rotations. a must be finite. */
void vg_tensor_eigen(const double a[6], double value[3], double vector[3][3]);

/** The tensor with these eigenvalues and orthonormal eigenvectors. */
void vg_tensor_from_eigen(const double value[3], const double vector[3][3],
                          double a[6]);

/** out = a^(1/2) for a positive tensor. out may be a. */
void vg_tensor_root(const double a[6], double out[6]);

/** Intersection of two metrics: the metric with the largest unit ball that
 * lies within both, by simultaneous reduction (Alauzet, Finite Elem. Anal.
 * Des. 46, 2010). Exactly `a` if it is at least as fine as b in all
 * directions. out may be a or b. */
void vg_metric_intersect(const double a[6], const double b[6], double out[6]);

/** Logarithmic mean (a - b) / ln(a / b) of two lengths >= 0, within 1e-3 of
 * it. */
double vg_log_mean(double a, double b);

/** Length of the edge v from a point with metric a to one with metric b:
 * (la - lb) / ln(la / lb), the exact length for sizes that change
 * geometrically along the edge; within 1e-3 of it. */
double vg_metric_length(const double a[6], const double b[6],
                        const double v[3]);

#endif
