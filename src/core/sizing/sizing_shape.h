/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_shape.h: distances from the shapes of sources. Internal to
 * core/sizing. Uses core/sizing/sizing.h. */
#ifndef VG_CORE_SIZING_SIZING_SHAPE_H
#define VG_CORE_SIZING_SIZING_SHAPE_H

#include "core/geometry/vector.h"
#include "core/sizing/sizing.h"

static inline double vg_within(double t, double lo, double hi)
{
  return t < lo ? lo : t > hi ? hi : t;
}

/** Distance of x from the segment a b. t out: position of the nearest point,
 * from 0 at a to 1 at b. */
static inline double vg_segment_distance(const double a[3], const double b[3],
                                         const double x[3], double *t)
{
  double d[3], u[3], len2;

  vg_sub(b, a, d);
  vg_sub(x, a, u);
  len2 = vg_dot(d, d);
  *t = len2 > 0 ? vg_within(vg_dot(u, d) / len2, 0, 1) : 0;
  for (int k = 0; k < 3; k++) u[k] -= *t * d[k];
  return sqrt(vg_dot(u, u));
}

/** As vg_segment_distance, with the vector from the segment to x. */
double vg_segment_way(const double a[3], const double b[3], const double x[3],
                      double *t, double way[3]);

/** Distance of x from the triangle of the source. way out: direction from the
 * triangle to x, not normalised. */
double vg_triangle_distance(const struct vg_source *s, const double x[3],
                            double way[3]);

/** Distance of x from an axis-parallel box. */
static inline double vg_box_distance(const double lo[3], const double hi[3],
                                     const double x[3])
{
  double d2 = 0;

  for (int k = 0; k < 3; k++) {
    double d = x[k] - vg_within(x[k], lo[k], hi[k]);

    d2 += d * d;
  }
  return sqrt(d2);
}

/** Distance of x from the cylinder or cone of the source. t out: position along
 * the axis, from 0 to 1. */
double vg_cone_distance(const struct vg_source *s, const double x[3],
                        double *t);

/** Distance of x from the shape of a source, including its radius. The corners
 * of a box must be ordered.
 *
 * @param t    out: position along the axis, from 0 to 1; 0 without an axis
 * @param way  out: vector to x from the point of the shape nearest to it; zero
 *             within the shape */
double vg_shape_way(const struct vg_source *s, const double x[3], double *t,
                    double way[3]);

#endif
