/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/slits.h: sheets that end in a generated symmetry plane, which is
 * cut along them. Private to core/domain. */
#ifndef VG_CORE_DOMAIN_SLITS_H
#define VG_CORE_DOMAIN_SLITS_H

#include "core/domain/farfield.h"

/** The plane x[axis] = at. */
struct vg_slit_plane {
  int axis, side; /* side 1: the fluid is above */
  double at;
  double tolerance; /* largest distance of points in the plane */
};

/** Append the edges of sheets in the plane to the border, in both directions.
 *
 * @param m       gets the points of these edges that are at no point of the
 *                border
 * @param sheets  any triangles of patches of m; points within the tolerance are
 * moved into the plane
 * @param border  in/out: closed loops in the plane
 * VG_ERR_GEOMETRY, with the place, for a sheet that crosses the plane or has a
 * triangle in it. VG_ERR_MEMORY. O(n log n). */
vg_status vg_add_slits(struct vg_mesh *m, struct vg_mesh *sheets,
                       const struct vg_slit_plane *plane,
                       struct vg_border *border, struct vg_error *err);

#endif
