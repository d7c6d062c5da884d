/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/wake/trailing.h: trailing edges of a triangulated body, found by
 * geometry. Uses core/mesh.
 *
 * A convex edge between two triangles of the body is a sharp trailing edge if
 * the angle inside the body is at most 60 degrees and both triangles extend
 * upstream from it, within 60 degrees of the stream in the plane normal to the
 * edge. It is the rim of a blunt trailing edge if one triangle faces
 * downstream, within 45 degrees, the other extends upstream, the angle between
 * them is below 150 degrees, and the base, measured in the section through the
 * middle of the edge up to its other convex edge, which is about parallel, is
 * at most 5 % of the chord thick. Edges within 15 degrees of the stream are
 * side edges, not trailing edges.
 *
 * The local chord of a trailing edge is the largest distance of a point of the
 * section from the middle of the edge. The section is the connected cut of the
 * body with the plane through the middle of the edge that contains the stream
 * and is otherwise as normal to the edge as possible. */
#ifndef VG_CORE_WAKE_TRAILING_H
#define VG_CORE_WAKE_TRAILING_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

struct vg_trailing_edge {
  uint32_t point[2]; /* lower index first */
  uint32_t patch[2]; /* patches of its triangles */
  double chord;      /* local chord, > 0 */
  double thickness;  /* of a blunt trailing edge; 0: sharp */
};

struct vg_trailing {
  size_t n, cap;
  struct vg_trailing_edge *edge; /* [n] owned, by their points */
};
#define VG_TRAILING_INIT                                                       \
  {                                                                            \
    0                                                                          \
  }

/** Find the trailing edges of the triangles of m.
 *
 * @param m           points with the same coordinates must be merged;
 *                    neighbours may disagree in orientation. No inner
 *                    surfaces: an edge of three triangles does not count.
 *                    Quadrilaterals are ignored
 * @param is_body     [n_patch] 1: the patch belongs to the body; 0: farfield
 *                    or symmetry plane
 * @param is_internal 1: the fluid is inside of all shells, if all patches
 * belong to the body
 * @param flow        direction of the stream, unit vector
 * @param out         empty; the caller releases it with vg_trailing_release
 *
 * The sides of a shell follow from its volume: the fluid is outside of a shell
 * that consists of a body alone, also if it is cut open at a plane, and inside
 * of one with other patches. Cost: O(n_tri), and the triangles of one section
 * for each trailing edge. VG_ERR_MEMORY. Threads: re-entrant. */
vg_status vg_trailing_find(const struct vg_mesh *m, const uint8_t *is_body,
                           int is_internal, const double flow[3],
                           struct vg_trailing *out, struct vg_error *err);

void vg_trailing_release(struct vg_trailing *t);

#endif
