/* core/optimise/optimise.h: better cells from the same points and boundary. */
#ifndef VG_CORE_OPTIMISE_OPTIMISE_H
#define VG_CORE_OPTIMISE_OPTIMISE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"
#include "core/front/region.h"

struct vg_optimise_report {
  size_t n_smoothed, n_flip, n_collapse, n_split;
  size_t n_left; /* bad cells into which no point was tried to be put
                    any more: enough had been spent on others */
};

/** Improve the cells of t in place: smoothing, swaps, insertion, removal.
 *
 * Points 0..n_fixed-1 stay; fixed faces stay; every cell stays positive.
 * @param sweeps  passes over all cells before the bad ones alone are worked on
 * @param region  cells that do not belong to it are left as they are, unless
 *                that helps one that does; NULL: all belong
 * @param sizing  what the region is measured by; NULL without region
 * Points are put in until a number of cells has been looked at that grows with
 * those of t: over a surface of needles it would take any time and gain little.
 * Deterministic. VG_ERR_MEMORY on refusal (t is then still valid). */
vg_status vg_optimise(struct vg_tets *t, size_t n_fixed, int sweeps,
                      const struct vg_region *region,
                      const struct vg_sizing *sizing,
                      struct vg_optimise_report *report, struct vg_error *err);

/** Improve the bad cells of t alone: what vg_optimise does after its sweeps.
 *
 * @param n_keep  >= n_fixed; points below may move from n_fixed on, but are
 *                not taken away */
vg_status vg_optimise_bad(struct vg_tets *t, size_t n_fixed, size_t n_keep,
                          struct vg_optimise_report *report,
                          struct vg_error *err);

/** Swap faces and edges of the cells of a shape below `below`, in one pass.
 * No point moves; fixed faces stay.
 *
 * *q in, out: [t.n_cell] shapes (vg_shape) of the cells, from vg_alloc
 * Deterministic. VG_ERR_MEMORY on refusal (t is then still valid). */
vg_status vg_optimise_swaps(struct vg_tets *t, float below, float **q,
                            struct vg_optimise_report *report,
                            struct vg_error *err);

/** Smooth points of cells that need not hang together: one sweep over
 * point [n], in that order, but for those that have no cell of a shape below
 * `below` when it begins. Shapes decide, and how near edges come to the length
 * that is wanted; sizing NULL: shapes alone.
 *
 * t: its links are not looked at, its cells positive; each of those points
 * has all its cells there, none of them with a fixed face.
 * q in, out: [t.n_cell] shapes (vg_shape) of the cells
 * Deterministic. VG_ERR_MEMORY on refusal. */
vg_status vg_optimise_points(struct vg_tets *t, size_t n, const uint32_t *point,
                             float below, const struct vg_sizing *sizing,
                             float *q, struct vg_optimise_report *report,
                             struct vg_error *err);

/** A cell of a shape (core/geometry/shape.h) below this is one that is worked
 * on. */
#define VG_SHAPE_TARGET 0.1786 /* K23 */

#endif
