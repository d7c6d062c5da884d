/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/shape.h: a fast quality measure of tetrahedra. */
#ifndef VG_CORE_GEOMETRY_SHAPE_H
#define VG_CORE_GEOMETRY_SHAPE_H

#include "core/geometry/predicates.h"

/** Square of the smallest sine of the six dihedral angles, with the sign of the
 * volume: 8/9 for the regular tetrahedron, 0 for a flat one. Both small and
 * large angles reduce it. Uses + - * / only.
 *
 * The result is nonzero only if the sign is exact and the face areas are not
 * dominated by rounding: it is 0 if the volume is tiny compared with the
 * product of three edge lengths. For collinear points all areas are pure
 * rounding error, and so would be any sine computed from them.
 *
 * The sine at edge kl, between faces i and j, is det l_kl / (|n_i| |n_j|),
 * where det is six times the volume and n is twice the area vector. */
static inline double vg_shape(const double a[3], const double b[3],
                              const double c[3], const double d[3])
{
  double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
  /* Area vectors of the faces opposite d (u v), b (v w), c (w u), a (sum). */
  double dx = uy * vz - uz * vy, dy = uz * vx - ux * vz, dz = ux * vy - uy * vx;
  double bx = vy * wz - vz * wy, by = vz * wx - vx * wz, bz = vx * wy - vy * wx;
  double cx = wy * uz - wz * uy, cy = wz * ux - wx * uz, cz = wx * uy - wy * ux;
  double ax = bx + cx + dx, ay = by + cy + dy, az = bz + cz + dz;
  double na = ax * ax + ay * ay + az * az, nb = bx * bx + by * by + bz * bz;
  double nc = cx * cx + cy * cy + cz * cz, nd = dx * dx + dy * dy + dz * dz;
  double det = dx * wx + dy * wy + dz * wz;
  double px = vx - ux, py = vy - uy, pz = vz - uz;
  double qx = wx - ux, qy = wy - uy, qz = wz - uz;
  double rx = wx - vx, ry = wy - vy, rz = wz - vz;
  double uu = ux * ux + uy * uy + uz * uz, vv = vx * vx + vy * vy + vz * vz;
  double ww = wx * wx + wy * wy + wz * wz, square = det * fabs(det);
  double least = uu * na * nb, next;

  next = vv * na * nc;
  least = next < least ? next : least;
  next = ww * na * nd;
  least = next < least ? next : least;
  next = (px * px + py * py + pz * pz) * nb * nc;
  least = next < least ? next : least;
  next = (qx * qx + qy * qy + qz * qz) * nb * nd;
  least = next < least ? next : least;
  next = (rx * rx + ry * ry + rz * rz) * nc * nd;
  least = next < least ? next : least;
  next = na * nb * nc * nd;
  return next > 0 && fabs(square) > 1e-24 * uu * vv * ww ? square * least / next
                                                         : 0;
}

/** Cells with a smaller shape count as flat: neither their sign in plain
 * arithmetic nor their angles are meaningful. Such cells are left alone if no
 * change improves them by more. */
#define VG_SHAPE_FLAT 1e-12

#endif
