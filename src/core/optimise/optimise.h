/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/optimise/optimise.h: improvement of cells within a given boundary. */
#ifndef VG_CORE_OPTIMISE_OPTIMISE_H
#define VG_CORE_OPTIMISE_OPTIMISE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"
#include "core/front/region.h"
#include "core/metric/metrics.h"

struct vg_optimise_report {
  size_t n_smoothed, n_flip, n_collapse, n_split;
  size_t n_left; /* bad cells into which no point could be inserted any more
                    because the budget was spent */
};

/** Improve the cells of t in place by smoothing, swaps, insertion and removal
 * of points.
 *
 * Points 0..n_fixed-1 and fixed faces are preserved, and every cell stays
 * positive.
 *
 * @param sweeps  passes over all cells before the bad cells are improved one
 *                by one
 * @param region  cells that do not belong to it are left unchanged, unless
 *                changing them improves a cell that does; NULL: all cells
 *                belong
 * @param sizing  measures the region; NULL without region
 *
 * Insertion of points stops when the number of examined cells exceeds a budget
 * that grows with the number of cells of t: over a surface of sliver triangles
 * it could take any time and gain little. Deterministic. VG_ERR_MEMORY if
 * memory is refused (t is then still valid). */
vg_status vg_optimise(struct vg_tets *t, size_t n_fixed, int sweeps,
                      const struct vg_region *region,
                      const struct vg_sizing *sizing,
                      struct vg_optimise_report *report, struct vg_error *err);

/* The functions below measure shapes by vg_cell_shape. metrics: of the points
 * of t, kept up to date where points move or are added; NULL: shapes are
 * Euclidean. */

/** Improve the bad cells of t only: the part of vg_optimise after its sweeps.
 *
 * @param n_keep  >= n_fixed; points n_fixed to n_keep - 1 may move, but are
 *                not removed */
vg_status vg_optimise_bad(struct vg_tets *t, size_t n_fixed, size_t n_keep,
                          struct vg_metrics *metrics,
                          struct vg_optimise_report *report,
                          struct vg_error *err);

/** Swap faces and edges of cells with a shape below `below`, in one pass. No
 * point moves; fixed faces are preserved.
 *
 * *q in, out: [t.n_cell] shapes of the cells, allocated by vg_alloc.
 * Deterministic. VG_ERR_MEMORY if memory is refused (t is then still
 * valid). */
vg_status vg_optimise_swaps(struct vg_tets *t, float below,
                            struct vg_metrics *metrics, float **q,
                            struct vg_optimise_report *report,
                            struct vg_error *err);

/** Smooth points of cells that need not be connected: one sweep over point[n]
 * in this order. Points without a cell of a shape below `below` at the start
 * are skipped. Positions are rated by shapes and by how close edges are to the
 * target edge length; with sizing NULL by shapes only.
 *
 * t: links are not used, and cells must be positive. All cells around each of
 * the points must be present, and none of them may have a fixed face. q in,
 * out: [t.n_cell] shapes of the cells. Deterministic. VG_ERR_MEMORY if memory
 * is refused. */
vg_status vg_optimise_points(struct vg_tets *t, size_t n, const uint32_t *point,
                             float below, const struct vg_sizing *sizing,
                             struct vg_metrics *metrics, float *q,
                             struct vg_optimise_report *report,
                             struct vg_error *err);

/** Cells with a shape below this are improved one by one: a shape
 * (core/geometry/shape.h), and the cube of a mean ratio of 0.6 in a metric. */
#define VG_SHAPE_TARGET 0.1786 /* K23 */
#define VG_METRIC_TARGET 0.216 /* K43 */

#endif
