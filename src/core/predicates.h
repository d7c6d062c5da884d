/* core/predicates.h: signs of determinants, exact for every finite input.
 *
 * A static error bound decides almost all calls; what it cannot decide is
 * computed exactly with floating-point expansions (Shewchuk, "Adaptive
 * precision floating-point arithmetic and fast robust geometric predicates",
 * Discrete Comput. Geom. 18, 1997). No global state, no initialisation call:
 * safe from any thread. Build with -ffp-contract=off (cmake/flags.cmake).
 * Underflow and overflow aside (|x| between 1e-140 and 1e+60 is safe). */
#ifndef VG_CORE_PREDICATES_H
#define VG_CORE_PREDICATES_H

/** Sign of (b-a) x (c-a) . (d-a): > 0 when a, b, c turn counter-clockwise
 * seen from d, i.e. when the tetrahedron a b c d has positive volume.
 * Returns a value with the exact sign (0 only for exactly coplanar points);
 * its magnitude approximates six times the volume. */
double vg_orient3d(const double a[3], const double b[3], const double c[3],
                   const double d[3]);

/** For a positive tetrahedron a b c d: > 0 when e lies strictly inside its
 * circumscribed sphere, 0 on it, < 0 outside. Exact sign. */
double vg_insphere(const double a[3], const double b[3], const double c[3],
                   const double d[3], const double e[3]);

/** Sign of the area of a b c in the plane: > 0 counter-clockwise. Exact. */
double vg_orient2d(const double a[2], const double b[2], const double c[2]);

/** For a counter-clockwise triangle a b c: > 0 when d is strictly inside its
 * circumcircle. Exact sign. */
double vg_incircle(const double a[2], const double b[2], const double c[2],
                   const double d[2]);

#endif
