/* core/judge_slices.h: judging a mesh that no process holds as a whole: the
 * report of core/quality.h, from slices. */
#ifndef VG_CORE_JUDGE_SLICES_H
#define VG_CORE_JUDGE_SLICES_H

#include "base/comm.h"
#include "core/quality.h"
#include "core/slices.h"

/** Which cells are judged. */
enum vg_judge_what { VG_JUDGE_ALL, VG_JUDGE_FIELD /* no layers */ };

/** Judge a mesh in slices. Collective; the same report on every rank.
 *
 * All figures of vg_mesh_report, with the same meaning, the worst cells by
 * their number in the mesh (tets, pyramids, prisms). Faces are matched within
 * slices; those left over meet on the rank that their points' hash names. Sums
 * are kept in a way that does not depend on who adds what, so that the report
 * is the same for any number of ranks and threads, bit by bit.
 * VG_JUDGE_FIELD: slices of layers are left out; what bounds the field
 * (tops of layers, boundary) is not looked up, so faces without a neighbour
 * are counted only against `front_faces`, their expected number.
 * @param sizing  may be NULL; edges shared between slices count once
 * Memory: one slice and its faces per thread, and the left over faces. */
vg_status vg_slices_judge(struct vg_comm *comm, const struct vg_slices *s,
                          enum vg_judge_what what, uint64_t front_faces,
                          const struct vg_sizing *sizing, int threads,
                          struct vg_mesh_report *report, struct vg_error *err);

#endif
