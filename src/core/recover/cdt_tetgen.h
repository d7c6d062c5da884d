/* core/recover/cdt_tetgen.h: the only door to TetGen (H. Si, "TetGen, a
 * Delaunay-based quality tetrahedral mesh generator", ACM TOMS 41(2), 2015).
 *
 * TetGen 1.5 keeps filters and random state in statics, prints when told to
 * be quiet, ends the process on failed assertions and frees twice what it
 * gives up. So it runs in a child process (base/child.h), which may die without
 * harm. */
#ifndef VG_CORE_RECOVER_CDT_TETGEN_H
#define VG_CORE_RECOVER_CDT_TETGEN_H

#include <stddef.h>
#include <stdint.h>

#include "base/library.h"
#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

struct vg_cdt_job {
  size_t n, n_tri;          /* in */
  const double (*x)[3];     /* in: [n] */
  const uint32_t (*tri)[3]; /* in: [n_tri], any orientation, no two crossing */
  vg_status st;             /* out: VG_OK, VG_ERR_GEOMETRY: TetGen failed */
  size_t n_all, n_tet;      /* out: points in all, >= n; tetrahedra */
  double (*all)[3];         /* out: [n_all], the first n equal to x */
  uint32_t (*tet)[4];       /* out: [n_tet], in either orientation */
};

/** For each job the constrained Delaunay tetrahedra of the convex hull of its
 * points, holding every triangle as a face of cells. Not trusted: callers
 * verify. Caller frees all and tet of jobs whose st is VG_OK (else NULL).
 * Threads: re-entrant. Same bytes for the same job.
 * Returns VG_ERR_MEMORY when memory or a process is refused (jobs may then be
 * undone: st VG_ERR_GEOMETRY), else VG_OK. */
vg_status vg_cdt_tetgen(size_t n_job, struct vg_cdt_job *job,
                        struct vg_error *err);

/** Which TetGen this is; it cannot tell itself. */
void vg_library_tetgen(struct vg_library *out);

#ifdef __cplusplus
}
#endif

#endif
