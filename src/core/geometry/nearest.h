/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/nearest.h: the point of a triangle nearest to a given one. Uses
 * core/geometry/vector.h. */
#ifndef VG_CORE_GEOMETRY_NEAREST_H
#define VG_CORE_GEOMETRY_NEAREST_H

/** Squared distance of x from triangle a b c. Most accurate if x is close to a,
 * since all vectors are relative to a. The triangle must have an area if the
 * foot of x lies inside it. Thread-safe; constant cost. */
double vg_to_triangle2(const double x[3], const double a[3], const double b[3],
                       const double c[3]);

/** Barycentric coordinates of the point of triangle a b c nearest to x. The
 * triangle must have an area. Thread-safe; constant cost. */
void vg_nearest_weights(const double x[3], const double a[3], const double b[3],
                        const double c[3], double w[3]);

#endif
