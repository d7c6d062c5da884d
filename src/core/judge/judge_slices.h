/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/judge_slices.h: check of a mesh that no process holds as a whole:
 * the report of core/judge/quality.h, from slices. */
#ifndef VG_CORE_JUDGE_JUDGE_SLICES_H
#define VG_CORE_JUDGE_JUDGE_SLICES_H

#include "base/comm.h"
#include "core/judge/quality.h"
#include "core/mesh/slices.h"

/** Check a mesh in slices, and at the same time the field alone, i.e. the
 * slices that are not layers. Collective; every rank gets the same reports.
 *
 * All figures of vg_mesh_report have the same meaning and are computed by the
 * same code as in vg_mesh_judge. The worst cells are identified by their
 * number in the mesh (tets, pyramids, prisms). Faces are matched within
 * slices, then between the slices of a rank. Remaining faces are sent to the
 * rank given by the hash of their points, as are edges and the keys of point
 * positions. Counts are integers and sums are exact. The reports are therefore
 * the same, bit by bit, for any number of ranks and threads and any division
 * into slices, and equal to those of vg_mesh_judge for the whole mesh.
 *
 * The boundary of the field (tops of layers, boundary) is not looked up, so
 * its faces without a neighbour are only counted. In the field's report,
 * open_face is the difference of this count from `front_faces`, and `enclosed`
 * is the volume of the field. Coincident points are counted for the whole mesh
 * only.
 *
 * In an invalid mesh, a face may have two cells in one slice and more cells
 * elsewhere. If faces do not join exactly two sides, all slices are therefore
 * checked a second time with these faces left unmatched.
 *
 * @param sizing  may be NULL; edges are those of the field if a report for it
 *                is requested (except those of its faces without a neighbour),
 *                else those of the whole mesh (except those of the boundary).
 *                Figures in the metric of a stretched field are in the same
 *                report, and include these exceptions
 * @param field   may be NULL
 *
 * VG_ERR_MEMORY. VG_ERR_INPUT if slices and their counts do not agree. Errors
 * of the server of slices are passed on. Reports are unchanged on failure.
 * Memory: one slice and its faces per thread; 28 bytes per unmatched face, 160
 * per side of a face between slices and 8 per point, twice that while they are
 * sent; n_point / 8; per thread, 9 bytes per tetrahedron of a slice and 41 per
 * other cell, and in a metric, 57 per point. */
vg_status vg_slices_judge(struct vg_comm *comm, const struct vg_slices *s,
                          uint64_t front_faces, const struct vg_sizing *sizing,
                          int threads, struct vg_mesh_report *whole,
                          struct vg_mesh_report *field, struct vg_error *err);

/** As vg_slices_judge, with the causes of flat cells if `flat` is not NULL: in
 * the report of the field if it is requested, else in that of the whole mesh.
 * Points owned by other slices, and all points of separators and repairs, count
 * as interface points unless they are on the boundary of `flat`.
 *
 * has_dual 1: the report of the whole mesh has the figures of
 * vg_mesh_judge_dual, also bit by bit. This takes 112 bytes per dual face and
 * 96 per control volume between slices. A pinched part of the fluid, which
 * slices share at an edge but at none of its faces, counts once per slice.
 *
 * There is an additional call of body (may be NULL) for each
 * slice of this rank while the slice is in memory, so that a valid mesh needs
 * to provide each slice only once. body is called as in vg_slices_each; slices
 * with bad indices or coordinates are skipped. A failure of body fails the
 * call, on all ranks. */
vg_status vg_slices_judge_with(
  struct vg_comm *comm, const struct vg_slices *s, uint64_t front_faces,
  const struct vg_sizing *sizing, int threads, const struct vg_flat *flat,
  int has_dual, vg_slice_body body, void *context, struct vg_mesh_report *whole,
  struct vg_mesh_report *field, struct vg_error *err);

#endif
