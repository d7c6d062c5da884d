/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/fill/place.h: placement of field points by a front of points that
 * starts at the surface and advances by the local spacing.
 *
 * Each face of the surface proposes the apex of a well-shaped cell. Each point
 * that is placed proposes its neighbours in a body-centred cubic pattern. A
 * proposal is accepted if it lies in the fluid and no point is nearer than a
 * fraction of the local spacing. Points and faces with the smallest spacing
 * come first; equal ones in the order of their creation. The proposals of a
 * point are tested against one list of the points around it, from a spatial
 * hash with the level of the spacing in its key. The cost per point is
 * therefore constant for any range of spacings. */
#ifndef VG_CORE_FILL_PLACE_H
#define VG_CORE_FILL_PLACE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"
#include "core/front/region.h"
#include "core/sizing/sizing.h"

/** Points in the order of their placement; empty if zeroed. */
struct vg_placed {
  size_t n;
  double (*x)[3]; /* [n] */
  float *h;       /* [n] spacings at the points; NULL: not computed */
  size_t n_cut;   /* number of truncated lists of surrounding points
                     (hgrid.h) */
};

/** Free the points; p is empty afterwards. */
void vg_placed_release(struct vg_placed *p);

/** A sparse set of points, one for every few hundred points of the field, to be
 * inserted first. They break up the long cells that span a void from surface
 * to surface, across which point location would be very slow. Where the
 * spacing has a steep gradient (it changes by more than half an edge over one
 * edge), finer parts of the sizing field get seeds of their own, since the
 * advancing points would step over them.
 *
 * @param x    in: [n][3] the points that bound the void
 * @param out  replaced without being released, to be released by the caller;
 *             some points may lie outside; without spacings */
vg_status vg_place_seeds(size_t n, const double (*x)[3],
                         const struct vg_sizing *sizing,
                         const struct vg_region *region, struct vg_placed *out,
                         struct vg_error *err);

/** Place field points in the fluid cells of t, in addition to its own points.
 *
 * @param region  NULL: everywhere
 * @param limit   fail if more points are needed; 0: no limit
 * @param out     as for vg_place_seeds, but unchanged on failure
 *
 * Returns VG_ERR_UNSUPPORTED if the limit is exceeded. Deterministic. */
vg_status vg_place(const struct vg_tets *t, const struct vg_sizing *sizing,
                   const struct vg_region *region, size_t limit,
                   struct vg_placed *out, struct vg_error *err);

#endif
