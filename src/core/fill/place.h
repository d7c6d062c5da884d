/* core/fill/place.h: where the points of the field go: a front of points that
 * starts at the surface and advances by the local spacing.
 *
 * Each face of the surface proposes the apex of a well-shaped cell; each
 * point that stands proposes its neighbours in a body-centred cubic pattern.
 * A proposal stands when it lies in the fluid and no point is nearer than a
 * share of the local spacing. Smallest spacing first, then first come. The
 * proposals of one point are tested against one list of its surroundings, from
 * a spatial hash keyed by the level of the spacing: constant cost per point,
 * whatever the span of sizes. */
#ifndef VG_CORE_FILL_PLACE_H
#define VG_CORE_FILL_PLACE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"
#include "core/front/region.h"
#include "core/sizing/sizing.h"

struct vg_placed {
  size_t n;
  double (*x)[3]; /* [n], owned by the receiver */
  size_t n_cut;   /* lists of surroundings cut short (hgrid.h) */
};

/** A sparse set of points, one for every few hundred of the field, to stand
 * first. They break up the long cells that span a void from surface to
 * surface, across which location would walk for ever. Where the field changes
 * by more than half of a length over it, what is much finer than around it has
 * some of its own: a front of points would step over it.
 * @param x    in: [n][3] the points that bound the void
 * @param out  owned by the caller: free(out->x); some may lie outside */
vg_status vg_place_seeds(size_t n, const double (*x)[3],
                         const struct vg_sizing *sizing,
                         const struct vg_region *region, struct vg_placed *out,
                         struct vg_error *err);

/** Place field points into the fluid cells of t, besides those it has.
 * @param region  NULL: everywhere
 * @param limit   refuse to place more points; 0: none
 * Returns VG_ERR_UNSUPPORTED when the limit is passed. Deterministic. */
vg_status vg_place(const struct vg_tets *t, const struct vg_sizing *sizing,
                   const struct vg_region *region, size_t limit,
                   struct vg_placed *out, struct vg_error *err);

#endif
