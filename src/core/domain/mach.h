/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/mach.h: places a farfield that is swept along the Mach cone
 * around a body. Private to core/domain. */
#ifndef VG_CORE_DOMAIN_MACH_H
#define VG_CORE_DOMAIN_MACH_H

#include "core/domain/revolution.h"

enum { VG_MACH_CORNERS = 6 };

struct vg_mach {
  struct vg_revolution shape; /* Its profile is `corner`. */
  double corner[VG_MACH_CORNERS][2];
  double cap;    /* Radius of the caps. */
  double window; /* Axial distance of inflow and outflow face. */
};

/** Profile from the upstream cap over the inflow cone, the cylinder and the
 * outflow cone to the downstream cap. The upstream cap is the smallest one for
 * which every point of the body is at least as far behind the inflow face as
 * the foremost point.
 *
 * @param body    at least one point
 * @param length  body length
 * @param centre  a point of the axis
 * @param half    as in vg_revolution
 * @param out     not moved afterwards, since shape refers to corner
 * VG_ERR_INPUT: Mach number not above 1, extents not above 0, direction of the
 * flow zero or not in the symmetry plane. VG_ERR_GEOMETRY: a point of the body
 * is not well within the radius. O(points). */
vg_status vg_mach_place(const struct vg_mesh *body,
                        const struct vg_mach_extent *extent, double length,
                        const double centre[3], int half, struct vg_mach *out,
                        struct vg_error *err);

/** Box around the domain as a whole. */
void vg_mach_bounds(const struct vg_mach *d, double lo[3], double hi[3]);

/** Largest edge on the farfield at x for which circles are round and the window
 * is resolved. */
double vg_mach_edge(const struct vg_mach *d, const double x[3]);

#endif
