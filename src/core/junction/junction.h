/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/junction/junction.h: the curves along which inner surfaces share edges
 * with walls and with each other, while these surfaces are remeshed one after
 * the other.
 *
 *          sheet                       A surface that is remeshed keeps the
 *        o-----o-----o                 junctions as feature curves, and divides
 *        |   / |   / |                 them by its own sizes (trace). The
 * points | /   | /   |                 of this division then replace those of
 *      --o-----o-----o--   junction    the surfaces that follow (piece), which
 *       / \   / \   / \                are remeshed with fixed junctions, so
 *      /   \ /   \ /   \   wall        that all have the same edges in the end.
 *
 * A piece is a part of a patch that is connected through edges of exactly two
 * triangles of the patch. All walls together are piece 0. Junctions run from
 * node to node; at nodes they end, branch, or other pieces share them. */
#ifndef VG_CORE_JUNCTION_JUNCTION_H
#define VG_CORE_JUNCTION_JUNCTION_H

#include "core/mesh/mesh.h"

struct vg_junction {
  size_t first, n; /* Range in vg_junctions.point. A closed curve has its first
                      point twice. */
  size_t made, n_made; /* Range of its new points; n_made 0: not divided. */
};

struct vg_junctions {
  const struct vg_mesh *m; /* Borrowed. */
  size_t n_wall;           /* First triangles, those of the walls. */
  size_t n_piece;
  uint32_t *piece; /* [m->n_tri] */
  size_t n, cap;
  struct vg_junction *curve;
  size_t n_point, cap_point, cap_at;
  uint32_t *point; /* Points of m along the curves. */
  double *at;      /* Arc length from the first point of the curve. */
  size_t n_edge;
  uint64_t *edge;    /* [n_edge] Ascending keys (base/tri_key.h). */
  uint32_t *of_edge; /* [n_edge] Curve. */
  size_t n_made, n_placed, cap_made[3]; /* n_placed: of earlier traces. */
  uint32_t *made;      /* New points along the curves: their numbers in the
                          surface that was traced last. */
  double *made_at;     /* Arc length along the curve. */
  double (*made_x)[3]; /* Coordinates (vg_junctions_place). */
  const double *size;  /* [m->n_point] Largest size at points of inner
                          surfaces, set by the caller; NULL: none. Borrowed. */
};
#define VG_JUNCTIONS_INIT                                                      \
  {                                                                            \
    .m = NULL                                                                  \
  }

/** Find pieces and junctions.
 *
 * @param m  triangles; the first n_wall are those of walls, the others those of
 *           inner surfaces, oriented piece by piece (core/sides/inner.h).
 * Points of the same place are one point
 *
 * O(n log n). VG_ERR_MEMORY. Same result for the same input. */
vg_status vg_junctions_find(const struct vg_mesh *m, size_t n_wall,
                            struct vg_junctions *j, struct vg_error *err);

void vg_junctions_release(struct vg_junctions *j);

/** Mark the junctions of the walls for vg_remesh.
 *
 * @param walls    with triangles 0 to n_wall - 1 of m, and points of its own
 * @param stretch  [3 n_wall] in/out: VG_REMESH_FEATURE at edges of junctions
 * @param still    [walls->n_point] in/out: VG_REMESH_STILL at their ends */
void vg_junctions_mark(const struct vg_junctions *j,
                       const struct vg_mesh *walls, double *stretch,
                       uint8_t *still);

/** Find the points of a remeshed piece on the junctions that are not divided
 * yet. The ends of junctions have the same coordinates as before.
 *
 * VG_ERR_GEOMETRY, with the place, if the piece has lost a junction.
 * VG_ERR_MEMORY. O(n). */
vg_status vg_junctions_trace(struct vg_junctions *j, uint32_t piece,
                             const struct vg_mesh *made, struct vg_error *err);

/** Take the coordinates of the points that the last trace found. `made` may
 * have moved them since. */
void vg_junctions_place(struct vg_junctions *j, const struct vg_mesh *made);

/* A piece of an inner surface as input of vg_remesh. */
struct vg_junction_piece {
  struct vg_mesh mesh; /* Its divided junctions have the new points. Patches as
                          in m. */
  uint32_t patch;
  double *stretch; /* [3 mesh.n_tri] VG_REMESH_FEATURE, 0 */
  uint8_t *still;  /* [mesh.n_point] VG_REMESH_KEPT on divided junctions,
                      VG_REMESH_STILL at ends of the others */
  double *cap;     /* [mesh.n_point] Mean length of the edges of divided
                      junctions; elsewhere `size` or INFINITY. */
};
#define VG_JUNCTION_PIECE_INIT                                                 \
  {                                                                            \
    .mesh = VG_MESH_INIT                                                       \
  }

/** Make piece i > 0. *p is empty before, and released by the caller, also on
 * failure. VG_ERR_GEOMETRY, with the place, if the piece meets itself along a
 * junction, or if it cannot take over a division. VG_ERR_MEMORY. */
vg_status vg_junctions_piece(const struct vg_junctions *j, uint32_t i,
                             struct vg_junction_piece *p, struct vg_error *err);

void vg_junction_piece_release(struct vg_junction_piece *p);

/** Let sheets that pass along sharp edges of walls, as a wake does behind a
 * trailing edge, share these edges: points of sheets at most `most` from a
 * sharp edge move onto it, and both surfaces get the points of each other
 * there.
 *
 * @param walls, sheets  oriented manifolds, without common points; triangles
 *                       are added at the end
 * @param n              out: number of points that were moved
 * O(n log n). VG_ERR_MEMORY: both are valid. */
vg_status vg_junction_snap(struct vg_mesh *walls, struct vg_mesh *sheets,
                           double most, size_t *n, struct vg_error *err);

/* --- parts outside the fluid ------------------------------------------------
 */

/* A half space that contains the domain: coordinates of `axis` at or above
 * `at`, or at or below it. */
struct vg_junction_half {
  int axis, is_above;
  double at;
};

/** Cut inner surfaces, the triangles of m from n_wall on, off at the plane of a
 * half model. Points of the cut are exactly in the plane. Patches without
 * triangles may be left.
 *
 * @param lost  in/out: the area that was cut off is added
 * VG_ERR_MEMORY: m is valid. O(n). */
vg_status vg_junction_clip(struct vg_mesh *m, size_t n_wall,
                           const struct vg_junction_half *half, double *lost,
                           struct vg_error *err);

/** Join points and edges at most `most` apart at the common curves of walls and
 * sheets that were cut along each other: they are due to rounding, such as
 * points of a smooth wall in the plane of a sheet.
 *
 * @param m       walls, and from *n_wall on sheets, of other patches; points of
 *                the same place are one point
 * @param n_wall  in/out
 * VG_ERR_MEMORY: m is not usable. O(n log n). */
vg_status vg_junction_mend(struct vg_mesh *m, size_t *n_wall, double most,
                           struct vg_error *err);

/** Do two triangles overlap in one plane? They do if the corners of t are at
 * most `most` from the plane of s and more than an edge is common to both. */
int vg_junction_overlap(const double s[3][3], const double t[3][3],
                        double most);

/** Drop triangles with two equal corners, which rounding leaves. Returns the
 * number of those of walls, the first n_wall ones, that are left. */
size_t vg_junction_drop_flat(struct vg_mesh *m, size_t n_wall);

/** Remove the parts of inner surfaces that are on the other side of the walls
 * than the fluid, as far as they have common edges with walls.
 *
 * @param m     triangles into the fluid, and from n_wall on inner surfaces that
 *              cross walls in shared edges only. Points of the same
 *              place are one point
 * @param lost  in/out: the area that was removed is added
 *
 * VG_ERR_GEOMETRY, with the place, if a part without common edges with walls
 * inside it is on both sides of the walls. VG_ERR_MEMORY. O(n log n). */
vg_status vg_junction_drop_solid(struct vg_mesh *m, size_t n_wall, double *lost,
                                 struct vg_error *err);

#endif
