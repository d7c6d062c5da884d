/* core/surface/surface_swap.h: better triangles on the points a surface has.
 *
 * Surfaces from CAD carry caps (three nodes almost on a line) and needles
 * (two nodes almost at one place), on which layers invert at once. Caps
 * vanish when their long edge is swapped for the other diagonal, needles when
 * their short edge is collapsed; both hardly move the surface.
 * Swaps: Lawson, "Software for C1 surface interpolation", Mathematical
 * Software III, 1977; collapses: the link condition of Dey et al.,
 * "Topology preserving edge contraction", Publ. Inst. Math. 66, 1999. */
#ifndef VG_CORE_SURFACE_SURFACE_SWAP_H
#define VG_CORE_SURFACE_SURFACE_SWAP_H

#include <stddef.h>

#include "core/mesh/mesh.h"

struct vg_swap_options {
  double distance;   /* how far the surface may move in all, in parts
                        of the length there: of the longest edges at
                        a cap, of the mean of the edges at a short
                        edge, elsewhere of 0.3 of the shortest */
  double angle;      /* how far normals may turn, degrees, < 90 */
  int collapse;      /* collapse short edges too */
  double short_edge; /* short: below this part of the mean length of
                        the other edges at both ends, < 1 */
};
#define VG_SWAP_OPTIONS_INIT                                                   \
  {                                                                            \
    1e-3, 10, 1, 0.02                                                          \
  } /* S1 */

/* Triangles lower than this part of their longest edge are caps when they
 * have an angle over 120 degrees, else needles. */
#define VG_SWAP_SLIVER 0.02 /* S2 */

struct vg_swap_report {
  size_t n_swapped, n_collapsed;
  double moved;                 /* bound of how far the surface moved */
  double moved_relative;        /* the same, in parts of the length there */
  size_t n_cap[2], n_needle[2]; /* before, after */
  size_t n_kept; /* points whose triangles stay as they are, since
                    better ones met another part of the surface;
                    all when no way was found to avoid that */
};
#define VG_SWAP_REPORT_INIT                                                    \
  {                                                                            \
    0                                                                          \
  }

/** Swap the edges of a closed surface until it is as nearly Delaunay (its
 * smallest angles as large) as its shape permits, and collapse short edges.
 *
 * Edges between patches and ridges (triangles of sound shape that differ by
 * more than the angle) are never swapped; points are removed only within
 * patches and along smooth edges of patches. A surface that is closed,
 * manifold, oriented and free of self-intersections stays so: the exact test
 * of vg_surface_check is made of all that changed, and what meets anything is
 * taken back.
 *
 * @param m  triangles only. Order of points, triangles and patches is kept;
 *           points and triangles removed leave no gaps. Corners of triangles
 *           that changed may begin elsewhere. Untouched on failure.
 * @param r  out; may be NULL
 * VG_ERR_INPUT for a surface that is open, non-manifold or not oriented, has
 * quadrilaterals or cells, or for options out of range; VG_ERR_UNSUPPORTED
 * beyond 1.4e9 triangles; VG_ERR_MEMORY. O(n log n). Re-entrant. */
vg_status vg_surface_swap(struct vg_mesh *m, const struct vg_swap_options *o,
                          struct vg_swap_report *r, struct vg_error *err);

#endif
