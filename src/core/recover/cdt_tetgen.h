/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/recover/cdt_tetgen.h: the only interface to TetGen for boundary
 * recovery (H. Si, "TetGen, a Delaunay-based quality tetrahedral mesh
 * generator", ACM TOMS 41(2), 2015).
 *
 * TetGen 1.5 keeps filters and random state in static variables, prints even
 * in quiet mode, ends the process on failed assertions and frees memory twice
 * after a failure, and its licence would apply to this program. It is therefore
 * part of the helper program vanguard-tetgen (base/helper/helper.h), whose end
 * does no harm. */
#ifndef VG_CORE_RECOVER_CDT_TETGEN_H
#define VG_CORE_RECOVER_CDT_TETGEN_H

#include <stddef.h>
#include <stdint.h>

#include "base/helper/link.h"

struct vg_cdt_job {
  size_t n, n_tri;          /* in: numbers of points and triangles */
  const double (*x)[3];     /* in: [n] */
  const uint32_t (*tri)[3]; /* in: [n_tri], any orientation, must not cross
                               each other */
  vg_status st;             /* out: VG_OK, or VG_ERR_GEOMETRY if TetGen
                               failed on the triangles */
  int n_crash;              /* crashes of TetGen so far */
  size_t n_all, n_tet;      /* out: number of all points, >= n; number of
                               tetrahedra */
  double (*all)[3];         /* out: [n_all], the first n equal to x */
  uint32_t (*tet)[4];       /* out: [n_tet], in either orientation */
};

/** For each job, compute the constrained Delaunay tetrahedra of the convex hull
 * of its points, with every triangle as a face of cells. The result is not
 * trusted: callers must verify it. The caller frees all and tet of jobs whose
 * st is VG_OK (otherwise they are NULL). Threads: re-entrant. Same bytes for
 * the same job. Returns VG_BLOCKED if vanguard-tetgen is not installed: no job
 * has run, and err says why; VG_ERR_MEMORY or VG_ERR_IO if a job twice got no
 * answer (vg_helper_repeat), so that some jobs have not run; else VG_OK. */
vg_status vg_cdt_tetgen(size_t n_job, struct vg_cdt_job *job,
                        struct vg_error *err);

/** Receive the answer to a job and store it there. VG_BLOCKED: TetGen failed,
 * and the helper ends; VG_NOT_BETTER: so does a crash, which must happen twice.
 * VG_ERR_MEMORY, VG_ERR_IO: there is no valid answer. */
vg_status vg_cdt_receive(struct vg_cdt_job *job, struct vg_link *from,
                         struct vg_error *err);

#endif
