/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/volume.h: volumes as sums of cones from a point over faces.
 * The sums are in plain arithmetic, in the order of the faces; core/judge has
 * exact ones. */
#ifndef VG_CORE_GEOMETRY_VOLUME_H
#define VG_CORE_GEOMETRY_VOLUME_H

#include <stddef.h>
#include <stdint.h>

#include "core/geometry/vector.h"

/** Six times the volume of the cone from o over the triangle a b c: positive if
 * its corners are clockwise seen from o. */
static inline double vg_tri_cone(const double o[3], const double a[3],
                                 const double b[3], const double c[3])
{
  double u[3], v[3], w[3];

  vg_sub(a, o, u);
  vg_sub(b, o, v);
  vg_sub(c, o, w);
  return vg_triple(u, v, w);
}

/** Six times the volume of the cone over a quadrilateral: the mean over its two
 * triangulations, so that the cones of two cells over a shared warped face
 * cancel. */
static inline double vg_quad_cone(const double o[3], const double a[3],
                                  const double b[3], const double c[3],
                                  const double d[3])
{
  return (vg_tri_cone(o, a, b, c) + vg_tri_cone(o, a, c, d) +
          vg_tri_cone(o, a, b, d) + vg_tri_cone(o, b, c, d)) /
         2;
}

/** Six times the volume enclosed by the triangles tri[n] with corners in x, if
 * their normals point outwards. The rounding error is smallest if o is near
 * them. */
static inline double vg_enclosed6(size_t n, const uint32_t (*tri)[3],
                                  const double (*x)[3], const double o[3])
{
  double sum = 0;

  for (size_t i = 0; i < n; i++)
    sum += vg_tri_cone(o, x[tri[i][0]], x[tri[i][1]], x[tri[i][2]]);
  return sum;
}

#endif
