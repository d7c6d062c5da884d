/* core/recover/boundary.h: the coarsest tetrahedralisation that holds a
 * surface: points of the surface only, every triangle a constrained face. */
#ifndef VG_CORE_RECOVER_BOUNDARY_H
#define VG_CORE_RECOVER_BOUNDARY_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"
#include "core/front/region.h"

struct vg_boundary_report {
  size_t n_face_lost;             /* not in the Delaunay tetrahedra */
  size_t n_face_left;             /* of these, what flips did not bring in */
  size_t n_pocket, n_pocket_cell; /* regions that TetGen closed */
  size_t n_retry;                 /* pockets that had to grow */
  size_t n_restored;              /* flips back towards Delaunay cells */
  int whole_void;
  size_t n_steiner;
};

/** Tetrahedralise the surroundings of a closed oriented surface.
 *
 * Delaunay tetrahedra of the points in a wide box; triangles missing from
 * them are brought in by flips, else in pockets (core/recover/recover.h); if
 * that fails, TetGen gets the whole.
 * @param x, tri  [n][3] points, all used; [n_tri][3] facing the fluid
 * @param out     empty on entry; points 0..n-1 are x, later ones were added;
 *                cells linked, surface faces fixed, cells not in the fluid
 *                flagged VG_OUTSIDE
 * VG_ERR_GEOMETRY when the triangles do not bound a fluid. */
vg_status vg_boundary_tets(size_t n, const double (*x)[3], size_t n_tri,
                           const uint32_t (*tri)[3], struct vg_tets *out,
                           struct vg_boundary_report *report,
                           struct vg_error *err);

/** Flag the faces of `t` (linked) that are in tri as fixed.
 * missing out: [n_tri] 1 where no cell has the face; may be NULL.
 * n_missing out: how many. */
vg_status vg_boundary_fix(struct vg_tets *t, size_t n_tri,
                          const uint32_t (*tri)[3], uint8_t *missing,
                          size_t *n_missing, struct vg_error *err);

/** Flag VG_OUTSIDE the cells of t that do not lie on the side which the
 * triangles face, all of them being fixed faces.
 * region: NULL, or sides are told within VG_BAND_FLUID of it only, triangles
 * near it being all there are; what lies beyond counts as fluid, with fixed
 * faces before what is known to be solid. Points corner to corner + 7 are then
 * those of a wide box (vg_boundary_open).
 * VG_ERR_GEOMETRY when the triangles contradict each other. */
vg_status vg_boundary_sides(struct vg_tets *t, size_t n_tri,
                            const uint32_t (*tri)[3],
                            const struct vg_region *region, size_t corner,
                            const struct vg_sizing *sizing,
                            struct vg_error *err);

/** vg_boundary_tets for the part of a front near a region. Points n to n + 7
 * are corners of a wide box. VG_ERR_GEOMETRY also when pockets are not
 * enough. */
vg_status vg_boundary_open(size_t n, const double (*x)[3], size_t n_tri,
                           const uint32_t (*tri)[3],
                           const struct vg_region *region,
                           const struct vg_sizing *sizing, struct vg_tets *out,
                           struct vg_boundary_report *report,
                           struct vg_error *err);

#endif
