/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/recover/boundary.h: the coarsest tetrahedralisation that contains a
 * surface: only points of the surface, and every triangle is a constrained
 * face. */
#ifndef VG_CORE_RECOVER_BOUNDARY_H
#define VG_CORE_RECOVER_BOUNDARY_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"
#include "core/front/region.h"

struct vg_boundary_report {
  size_t n_face_lost;             /* triangles missing from the Delaunay
                                     tetrahedra */
  size_t n_face_left;             /* triangles that flips could not recover */
  size_t n_pocket, n_pocket_cell; /* regions closed by TetGen, and their
                                     cells */
  size_t n_retry;                 /* pockets that had to be enlarged */
  size_t n_restored;              /* flips that restored Delaunay cells */
  size_t n_unassisted;            /* pockets that were not closed because there
                                     is no TetGen */
  int whole_void;
  size_t n_steiner;
};

/** Tetrahedralise the surroundings of a closed oriented surface.
 *
 * Starts from the Delaunay tetrahedra of the points in a wide box. Missing
 * triangles are recovered by flips, or else in pockets
 * (core/recover/recover.h). If that fails, TetGen meshes the whole void.
 * Without TetGen (base/helper/helper.h) only flips recover triangles.
 *
 * @param x, tri  [n][3] points, all used; [n_tri][3] facing the fluid
 * @param sizing  NULL, or a field; if it has metrics, the cells are Delaunay in
 *                them instead, so that most of the triangles of a surface that
 *                was remeshed in the metric are among their faces
 * @param out     empty on entry; points 0..n-1 are x, later ones were added;
 *                cells are linked, surface faces fixed, and cells outside the
 *                fluid flagged VG_OUTSIDE
 *
 * VG_ERR_GEOMETRY if the triangles do not bound a fluid. */
vg_status vg_boundary_tets(size_t n, const double (*x)[3], size_t n_tri,
                           const uint32_t (*tri)[3],
                           const struct vg_sizing *sizing, struct vg_tets *out,
                           struct vg_boundary_report *report,
                           struct vg_error *err);

/** Flag the faces of `t` (linked) that are in tri as fixed. missing out:
 * [n_tri] 1 if no cell has the face; may be NULL. n_missing out: number of
 * missing faces. */
vg_status vg_boundary_fix(struct vg_tets *t, size_t n_tri,
                          const uint32_t (*tri)[3], uint8_t *missing,
                          size_t *n_missing, struct vg_error *err);

/** Flag as VG_OUTSIDE the cells of t that are not on the side that the
 * triangles face. All triangles must be fixed faces.
 *
 * region: NULL, or a region; then sides are determined within VG_BAND_FLUID of
 * it only, and tri contains only the triangles near it. Cells farther away
 * count as fluid, with fixed faces between them and known solid cells. In this
 * case points corner to corner + 7 must be the corners of the wide box
 * (vg_boundary_open).
 *
 * VG_ERR_GEOMETRY if the triangles contradict each other. */
vg_status vg_boundary_sides(struct vg_tets *t, size_t n_tri,
                            const uint32_t (*tri)[3],
                            const struct vg_region *region, size_t corner,
                            const struct vg_sizing *sizing,
                            struct vg_error *err);

/** As vg_boundary_tets, for the part of a front near a region. Points n to n +
 * 7 are the corners of the wide box. VG_ERR_GEOMETRY also if recovery in
 * pockets does not suffice. */
vg_status vg_boundary_open(size_t n, const double (*x)[3], size_t n_tri,
                           const uint32_t (*tri)[3],
                           const struct vg_region *region,
                           const struct vg_sizing *sizing, struct vg_tets *out,
                           struct vg_boundary_report *report,
                           struct vg_error *err);

#endif
