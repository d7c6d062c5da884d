/* core/cdt_tetgen.h: the only door to TetGen (H. Si, "TetGen, a Delaunay-based
 * quality tetrahedral mesh generator", ACM TOMS 41(2), 2015). */
#ifndef VG_CORE_CDT_TETGEN_H
#define VG_CORE_CDT_TETGEN_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Constrained Delaunay tetrahedra of the convex hull of n points, holding
 * every triangle given as a face of cells. Not trusted: callers verify.
 *
 * @param x      in: [n][3]
 * @param tri    in: [n_tri][3], any orientation, no two crossing
 * @param n_all  out: points in all, >= n; those from n on were added inside
 * @param all    out: [n_all][3], the first n equal to x; caller frees
 * @param n_tet, tet  out: [n_tet][4], either orientation; caller frees
 * TetGen keeps filters and random state in statics: calls are serialised by a
 * mutex, and results do not depend on their order.
 * Returns VG_ERR_GEOMETRY with TetGen's reason when it gives up. */
vg_status vg_cdt_tetgen(size_t n, const double (*x)[3], size_t n_tri,
                        const uint32_t (*tri)[3], size_t *n_all,
                        double (**all)[3], size_t *n_tet, uint32_t (**tet)[4],
                        struct vg_error *err);

#ifdef __cplusplus
}
#endif

#endif
