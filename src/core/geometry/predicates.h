/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/predicates.h: signs of determinants, exact for every finite
 * input.
 *
 * An inline filter with an error bound decides almost all calls. The remaining
 * calls go out of line to double-double arithmetic, then to exact
 * floating-point expansions (Shewchuk, "Adaptive precision floating-point
 * arithmetic and fast robust geometric predicates", Discrete Comput. Geom. 18,
 * 1997). There is no global state and no initialisation call, so every thread
 * may call them. Build with -ffp-contract=off (cmake/flags.cmake).
 *
 * Exact as long as no product under- or overflows: coordinates must be 0 or
 * have a magnitude in [1e-85, 1e+60] (1e-45 for vg_insphere and vg_incircle).
 */
#ifndef VG_CORE_GEOMETRY_PREDICATES_H
#define VG_CORE_GEOMETRY_PREDICATES_H

#include <math.h>

/* Out-of-line continuations of the filters below. Do not call them directly. */
double vg_orient3d_exact(const double a[3], const double b[3],
                         const double c[3], const double d[3]);
double vg_insphere_exact(const double a[3], const double b[3],
                         const double c[3], const double d[3],
                         const double e[3]);
double vg_orient2d_exact(const double a[2], const double b[2],
                         const double c[2]);
double vg_incircle_exact(const double a[2], const double b[2],
                         const double c[2], const double d[2]);

static inline double vg_max3_abs(double x, double y, double z)
{
  double m = fabs(x);

  y = fabs(y);
  z = fabs(z);
  if (y > m) m = y;
  return z > m ? z : m;
}

/** Sign of (b-a) x (c-a) . (d-a): > 0 if a, b, c turn counter-clockwise seen
 * from d, i.e. if the tetrahedron a b c d has positive volume. Returns a value
 * with the exact sign (0 only for exactly coplanar points); its magnitude
 * approximates six times the volume. */
static inline double vg_orient3d(const double a[3], const double b[3],
                                 const double c[3], const double d[3])
{
  double bx = b[0] - a[0], by = b[1] - a[1], bz = b[2] - a[2];
  double cx = c[0] - a[0], cy = c[1] - a[1], cz = c[2] - a[2];
  double dx = d[0] - a[0], dy = d[1] - a[1], dz = d[2] - a[2];
  double yz = by * cz, zy = bz * cy, zx = bz * cx, xz = bx * cz;
  double xy = bx * cy, yx = by * cx;
  double det = dx * (yz - zy) + dy * (zx - xz) + dz * (xy - yx);
  /* Error: 8 roundings of u = 2^-53 each on any path, 8 u = 8.882e-16. There
   * is only one comparison because a branch on the sign itself is hard to
   * predict. */
  double bound = 8.9e-16 * (fabs(dx) * (fabs(yz) + fabs(zy)) +
                            fabs(dy) * (fabs(zx) + fabs(xz)) +
                            fabs(dz) * (fabs(xy) + fabs(yx)));

  if (fabs(det) > bound) return det;
  return vg_orient3d_exact(a, b, c, d);
}

/** For a positive tetrahedron a b c d: > 0 if e lies strictly inside its
 * circumscribed sphere, 0 on it, < 0 outside. Exact sign. */
static inline double vg_insphere(const double a[3], const double b[3],
                                 const double c[3], const double d[3],
                                 const double e[3])
{
  double ax = a[0] - e[0], ay = a[1] - e[1], az = a[2] - e[2];
  double bx = b[0] - e[0], by = b[1] - e[1], bz = b[2] - e[2];
  double cx = c[0] - e[0], cy = c[1] - e[1], cz = c[2] - e[2];
  double dx = d[0] - e[0], dy = d[1] - e[1], dz = d[2] - e[2];
  double ab = ax * by - bx * ay, bc = bx * cy - cx * by;
  double cd = cx * dy - dx * cy, da = dx * ay - ax * dy;
  double ac = ax * cy - cx * ay, bd = bx * dy - dx * by;
  double al = ax * ax + ay * ay + az * az, bl = bx * bx + by * by + bz * bz;
  double cl = cx * cx + cy * cy + cz * cz, dl = dx * dx + dy * dy + dz * dz;
  double det = (cl * (dz * ab + az * bd + bz * da) -
                dl * (az * bc - bz * ac + cz * ab)) +
               (al * (bz * cd - cz * bd + dz * bc) -
                bl * (cz * da + dz * ac + az * cd));
  double mx = vg_max3_abs(ax, bx, cx), my = vg_max3_abs(ay, by, cy);
  double mz = vg_max3_abs(az, bz, cz), ml = vg_max3_abs(al, bl, cl), bound;

  if (fabs(dx) > mx) mx = fabs(dx);
  if (fabs(dy) > my) my = fabs(dy);
  if (fabs(dz) > mz) mz = fabs(dz);
  if (dl > ml) ml = dl;
  /* (16 + 224 u) u times the permanent, which is at most 4 lifts times 6
   * products: 384 u = 4.263e-14. */
  bound = 4.27e-14 * mx * my * mz * ml;
  if (fabs(det) > bound) return det;
  return vg_insphere_exact(a, b, c, d, e);
}

/** Sign of the area of the plane triangle a b c: > 0 if counter-clockwise.
 * Exact. */
static inline double vg_orient2d(const double a[2], const double b[2],
                                 const double c[2])
{
  double l = (b[0] - a[0]) * (c[1] - a[1]), r = (b[1] - a[1]) * (c[0] - a[0]);
  double det = l - r, bound = 3.34e-16 * (fabs(l) + fabs(r));

  /* (3 + 16 u) u = 3.331e-16. */
  if (fabs(det) > bound) return det;
  return vg_orient2d_exact(a, b, c);
}

/** For a counter-clockwise triangle a b c: > 0 if d lies strictly inside its
 * circumcircle. Exact sign. */
static inline double vg_incircle(const double a[2], const double b[2],
                                 const double c[2], const double d[2])
{
  double ax = a[0] - d[0], ay = a[1] - d[1];
  double bx = b[0] - d[0], by = b[1] - d[1];
  double cx = c[0] - d[0], cy = c[1] - d[1];
  double al = ax * ax + ay * ay, bl = bx * bx + by * by;
  double cl = cx * cx + cy * cy;
  double det = al * (bx * cy - cx * by) + bl * (cx * ay - ax * cy) +
               cl * (ax * by - bx * ay);
  /* (10 + 96 u) u times the permanent, at most 3 lifts times 2 products:
   * 60 u = 6.662e-15. */
  double bound = 6.67e-15 * vg_max3_abs(ax, bx, cx) * vg_max3_abs(ay, by, cy) *
                 vg_max3_abs(al, bl, cl);

  if (fabs(det) > bound) return det;
  return vg_incircle_exact(a, b, c, d);
}

#endif
