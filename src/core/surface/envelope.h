/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/surface/envelope.h: decides whether a closed surface is a body or the
 * boundary of a whole flow domain. Uses core/mesh/mesh.h. */
#ifndef VG_CORE_SURFACE_ENVELOPE_H
#define VG_CORE_SURFACE_ENVELOPE_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

/** Relation of a closed surface to its convex hull. The outer part is its
 * largest edge-connected piece on the hull. The triangles off the hull form
 * pockets, each closed by a lid, the surface that would span its border. */
struct vg_envelope {
  size_t n_outer;      /* Triangles of the outer part. */
  size_t n_pocket_tri; /* Triangles of the deepest pocket. */
  double covered;      /* Fraction of the silhouette of the hull that the outer
                          part covers; the least of the six views along the
                          axes. */
  double depth;        /* Largest ratio of the area of a pocket to that of its
                          lid; 0: no pocket. Slightly above 1 for a dent, 1.5 or
                          more for half a body on a plane. */
  int is_domain;       /* 1: covered and depth are those of a flow domain. */
};

/* A farfield, box or tunnel is its own convex hull except for the footprint of
 * a half body; an aircraft covers little of its hull. A body in a flow domain
 * has a larger surface than the hole that it leaves. */
#define VG_ENVELOPE_COVERED 0.7 /* S4 */
#define VG_ENVELOPE_DEPTH 1.3

/** Measure one closed, consistently oriented shell of triangles.
 *
 * A triangle is on the hull if no point is above its plane by more than a tenth
 * of its longest edge, where only the points extreme in 218 directions are
 * tested. Convex surfaces have no pocket and are never classified as domains: a
 * closed box may be a brick or a tank.
 *
 * @param outer  out: [n_tri] 1 for the outer part; may be NULL
 * The result does not depend on the orientation of the shell. Quadrilaterals
 * are ignored. O(n log n). VG_ERR_MEMORY. Threads: re-entrant. */
vg_status vg_envelope_measure(const struct vg_mesh *m, uint8_t *outer,
                              struct vg_envelope *out, struct vg_error *err);

#endif
