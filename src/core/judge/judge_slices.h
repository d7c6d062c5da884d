/* core/judge/judge_slices.h: judging a mesh that no process holds as a whole:
 * the report of core/judge/quality.h, from slices. */
#ifndef VG_CORE_JUDGE_JUDGE_SLICES_H
#define VG_CORE_JUDGE_JUDGE_SLICES_H

#include "base/comm.h"
#include "core/judge/quality.h"
#include "core/mesh/slices.h"

/** Judge a mesh in slices, and at the same time the field in it by itself:
 * the slices that are no layers. Collective; the same reports on every rank.
 *
 * All figures of vg_mesh_report, with the same meaning, by the same code as
 * vg_mesh_judge, the worst cells by their number in the mesh (tets, pyramids,
 * prisms). Faces are matched within slices, then between the slices of a rank;
 * those left over meet on the rank that their points' hash names, edges and
 * keys of the places of points likewise. Counts
 * are integers and sums exact, so that the reports are the same, bit by bit,
 * for any number of ranks and threads and for any cut into slices, and those
 * of vg_mesh_judge on the whole mesh.
 *
 * What bounds the field (tops of layers, boundary) is not looked up, so its
 * faces without a neighbour are only counted: in the field's report open_face
 * is their difference from `front_faces`, and `enclosed` is its volume. Points
 * at one place are counted for the whole mesh only.
 *
 * In a mesh that is not valid a face may have two cells in one slice and more
 * elsewhere. So where faces do not join two things, all slices are judged a
 * second time with these faces left over.
 *
 * @param sizing  may be NULL; edges are those of the field if a report of it
 *                is asked for (those of its faces without a neighbour apart),
 *                else those of the whole mesh (the boundary's apart)
 * @param field   may be NULL
 * VG_ERR_MEMORY; VG_ERR_INPUT when slices and their counts do not agree, and
 * what a server of slices answers; on failure reports are untouched.
 * Memory: one slice and its faces per thread; 28 bytes per face left over
 * and 8 per point, twice while they are sent; n_point / 8. */
vg_status vg_slices_judge(struct vg_comm *comm, const struct vg_slices *s,
                          uint64_t front_faces, const struct vg_sizing *sizing,
                          int threads, struct vg_mesh_report *whole,
                          struct vg_mesh_report *field, struct vg_error *err);

/** The same, and body (may be NULL) for each slice of this rank while it is at
 * hand, once if the mesh is valid: so a slice needs to be made once only. As
 * in vg_slices_each; where its indices are bad or places not finite a slice is
 * left out. A failure of body fails the call, on all ranks. */
vg_status vg_slices_judge_with(struct vg_comm *comm, const struct vg_slices *s,
                               uint64_t front_faces,
                               const struct vg_sizing *sizing, int threads,
                               vg_slice_body body, void *context,
                               struct vg_mesh_report *whole,
                               struct vg_mesh_report *field,
                               struct vg_error *err);

#endif
