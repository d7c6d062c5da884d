/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/revolution.h: closed surfaces of revolution whose profile
 * consists of straight lines: discs, cones and cylinders, whole or cut in half
 * by a coordinate plane through the axis. Private to core/domain. */
#ifndef VG_CORE_DOMAIN_REVOLUTION_H
#define VG_CORE_DOMAIN_REVOLUTION_H

#include "core/domain/farfield.h"

/** A point has the axial coordinate z and the radius r:
 *   x = origin + z axis + r (cos u + sin v).
 * axis, u and v are orthonormal, and u x v = axis. */
struct vg_revolution {
  double origin[3], axis[3], u[3], v[3];
  int half;                   /* -1: whole; else 2 * k + side: the half in which
                                 coordinate k is above (side 1) or below
                                 (side 0) that of the origin; v is then exactly
                                 the unit vector into that half */
  size_t n;                   /* Corners of the profile, at least 3. */
  const double (*profile)[2]; /* [n] z and r, by increasing z where lines are
                                 not normal to the axis; r is 0 at both ends
                                 and above 0 elsewhere. Borrowed. */
};

/** Complete the frame of a revolution: set half, u and v.
 *
 * @param r     in: axis, a unit vector; out: half, u, v
 * @param half  -1, or 2 * k + side; axis[k] must be 0 exactly */
void vg_revolution_frame(struct vg_revolution *r, int half);

/** Axial coordinate and radius of a point. */
void vg_revolution_locate(const struct vg_revolution *r, const double x[3],
                          double *z, double *radius);

/** Append the surface, with normals that point into it.
 *
 * Each line is unrolled into the plane without distortion and triangulated
 * there.
 * @param border  out: edges in the plane of a half are appended, directed as
 *                the closing surface runs along them; not used for a whole
 * Points in the plane of a half have the coordinate of the origin exactly. On
 * failure m is unchanged except for points without triangles. Cost: that of
 * vg_planar_mesh. */
vg_status vg_add_revolution(struct vg_mesh *m, const struct vg_revolution *r,
                            const struct vg_size_function *size, uint32_t patch,
                            struct vg_border *border, struct vg_error *err);

#endif
