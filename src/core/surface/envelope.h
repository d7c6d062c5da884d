/* core/surface/envelope.h: is a closed surface a body, or the boundary of a
 * whole flow domain? Uses core/mesh/mesh.h. */
#ifndef VG_CORE_SURFACE_ENVELOPE_H
#define VG_CORE_SURFACE_ENVELOPE_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

/** How a closed surface lies in its convex hull. The outer part is the
 * largest edge-connected piece of it on the hull; what is off the hull falls
 * into pockets, each closed by a lid: the surface that its border would span.
 * */
struct vg_envelope {
  size_t n_outer;      /* triangles of the outer part */
  size_t n_pocket_tri; /* triangles of the deepest pocket */
  double covered;      /* share of the hull's silhouette that the outer part
                          covers, least of the six views along the axes */
  double depth;        /* area of a pocket over that of its lid, largest; 0:
                          none. A dent has 1 and a little, half a body on a
                          plane 1.5 and more */
  int is_domain;       /* covered and depth are those of a flow domain */
};

/* A farfield, box or tunnel is its own convex hull, but for the footprint of
 * a half body; an aircraft covers little of its hull. What stands in a flow
 * domain has more surface than the hole that it leaves. */
#define VG_ENVELOPE_COVERED 0.7 /* S4 */
#define VG_ENVELOPE_DEPTH 1.3

/** Measure one closed, consistently oriented shell of triangles.
 *
 * A triangle is on the hull when no point lies above its plane by more than a
 * tenth of its longest edge; points are those extreme in 218 directions.
 * Convex surfaces have no pocket and are never called domains: a closed box
 * may be a brick or a tank.
 *
 * @param outer  out: [n_tri] 1 for the outer part; may be NULL
 * Same answer whichever way the shell is oriented. Quads are ignored.
 * O(n log n). VG_ERR_MEMORY. Threads: re-entrant. */
vg_status vg_envelope_measure(const struct vg_mesh *m, uint8_t *outer,
                              struct vg_envelope *out, struct vg_error *err);

#endif
