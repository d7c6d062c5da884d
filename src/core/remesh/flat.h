/* core/remesh/flat.h: triangles without height taken out of a finished surface.
 * Private to core/remesh. */
#ifndef VG_CORE_REMESH_FLAT_H
#define VG_CORE_REMESH_FLAT_H

#include "base/status.h"
#include "core/mesh/mesh.h"

struct vg_flat_limit {
  double height;            /* largest height of a triangle that is flat */
  double far;               /* longer edges are on an outer boundary, where
                               the height is a share of the edge; 0: there is
                               none */
};

/** Swap the longest edge of triangles whose three corners are nearly on a line.
 * The edge may be part of a line that stays: its two new pieces are within the
 * limit of it, and the flat triangle joins the patch of its neighbour.
 *
 * @param n      out: edges swapped
 * O(n), and O(n log n) for each sweep where there are any. VG_ERR_INPUT for a
 * surface that is not manifold or not oriented; VG_ERR_MEMORY. Untouched on
 * failure. */
vg_status vg_flat_swap(struct vg_mesh *m, const struct vg_flat_limit *limit,
                       size_t *n, struct vg_error *err);

#endif
