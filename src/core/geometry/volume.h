/* core/geometry/volume.h: volumes by cones from a point over faces. Plain sums,
 * in the order of the faces; core/judge has exact ones. */
#ifndef VG_CORE_GEOMETRY_VOLUME_H
#define VG_CORE_GEOMETRY_VOLUME_H

#include <stddef.h>
#include <stdint.h>

#include "core/geometry/vector.h"

/** Six times the volume of the cone from o over the triangle a b c: positive
 * if o sees its corners clockwise. */
static inline double vg_tri_cone(const double o[3], const double a[3],
                                 const double b[3], const double c[3])
{
  double u[3], v[3], w[3];

  vg_sub(a, o, u);
  vg_sub(b, o, v);
  vg_sub(c, o, w);
  return vg_triple(u, v, w);
}

/** The same over a quadrilateral: the mean of its two triangulations, so that
 * the cones of two cells over a warped face that they share cancel. */
static inline double vg_quad_cone(const double o[3], const double a[3],
                                  const double b[3], const double c[3],
                                  const double d[3])
{
  return (vg_tri_cone(o, a, b, c) + vg_tri_cone(o, a, c, d) +
          vg_tri_cone(o, a, b, d) + vg_tri_cone(o, b, c, d)) /
         2;
}

/** Six times the volume that triangles tri[n] with corners in x enclose, if
 * their normals point outwards. The result loses least to rounding if o is
 * near them. */
static inline double vg_enclosed6(size_t n, const uint32_t (*tri)[3],
                                  const double (*x)[3], const double o[3])
{
  double sum = 0;

  for (size_t i = 0; i < n; i++)
    sum += vg_tri_cone(o, x[tri[i][0]], x[tri[i][1]], x[tri[i][2]]);
  return sum;
}

#endif
