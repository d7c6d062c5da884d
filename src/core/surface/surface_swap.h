/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/surface/surface_swap.h: improves the triangles of a surface without
 * adding points.
 *
 * Surfaces from CAD contain caps (three nodes almost on a line) and needles
 * (two nodes almost at the same point), on which layers invert at once. Caps
 * are removed by swapping their long edge, needles by collapsing their short
 * edge; both hardly move the surface.
 * Swaps: Lawson, "Software for C1 surface interpolation", Mathematical Software
 * III, 1977. Collapses: the link condition of Dey et al., "Topology preserving
 * edge contraction", Publ. Inst. Math. 66, 1999. */
#ifndef VG_CORE_SURFACE_SURFACE_SWAP_H
#define VG_CORE_SURFACE_SURFACE_SWAP_H

#include <stddef.h>

#include "core/mesh/mesh.h"

struct vg_swap_options {
  double distance;   /* Largest total movement of the surface relative to a
                        local length: the longest edge at a cap, the mean edge
                        at a short edge, elsewhere 0.3 of the shortest edge. */
  double angle;      /* Largest change of normals in degrees, < 90. */
  int collapse;      /* 1: also collapse short edges. */
  double short_edge; /* Edges are short below this fraction of the mean length
                        of the other edges at both ends, < 1. */
};
#define VG_SWAP_OPTIONS_INIT                                                   \
  {                                                                            \
    1e-3, 10, 1, 0.02                                                          \
  } /* S1 */

/* Triangles lower than this fraction of their longest edge are caps if they
 * have an angle above 120 degrees, else needles. */
#define VG_SWAP_SLIVER 0.02 /* S2 */

struct vg_swap_report {
  size_t n_swapped, n_collapsed;
  double moved;                 /* Upper bound of the movement of the
                                   surface. */
  double moved_relative;        /* The same, relative to the local length. */
  size_t n_cap[2], n_needle[2]; /* Before, after. */
  size_t n_kept;                /* Points whose triangles were kept because
                                   better ones intersected another part of the
                                   surface; all points if no attempt avoided
                                   that. */
};
#define VG_SWAP_REPORT_INIT                                                    \
  {                                                                            \
    0                                                                          \
  }

/** Swap the edges of a closed surface until it is as nearly Delaunay (its
 * smallest angles as large) as its shape permits, and collapse short edges.
 *
 * Patch borders and sharp edges (between triangles of sound shape that differ
 * by more than the angle) are never swapped. Points are removed only inside
 * patches and along smooth patch borders. A surface that is closed, manifold,
 * oriented and free of self-intersections stays so: everything that changed is
 * subjected to the exact test of vg_surface_check, and changes that intersect
 * anything are undone.
 *
 * @param m  triangles only. Order of points, triangles and patches is kept;
 *           points and triangles removed leave no gaps. Corners of changed
 *           triangles may start elsewhere. Untouched on failure.
 * @param r  out; may be NULL
 * VG_ERR_INPUT for a surface that is open, non-manifold or not oriented, has
 * quadrilaterals or cells, or for options out of range; VG_ERR_UNSUPPORTED
 * beyond 1.4e9 triangles; VG_ERR_MEMORY. O(n log n). Re-entrant. */
vg_status vg_surface_swap(struct vg_mesh *m, const struct vg_swap_options *o,
                          struct vg_swap_report *r, struct vg_error *err);

#endif
