/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/partition.h: settings, report and result of the decomposition
 * and filling of a void. Uses core, lattice.h, store.h. */
#ifndef VG_PARTITION_CUT_PARTITION_H
#define VG_PARTITION_CUT_PARTITION_H

#include <stdint.h>

#include "base/progress.h"
#include "base/stop.h"
#include "core/fill/fill.h"
#include "core/mesh/slices.h"
#include "core/mesher/fill_with.h"
#include "partition/cut/lattice.h"
#include "partition/cut/decomposition.h"
#include "partition/store/store.h"

/** Default number of cells per leaf: measured,
 * docs/lab/performance-parallel.md. */
#define VG_LEAF_CELLS 300000.0 /* C1 */

struct vg_partition_options {
  struct vg_cut_rule rule;
  int levels; /* Bisections, if rule.leaf_cells is 0. */
  /* Decomposes the void before any of it is filled, with the options in
   * `decomposition`; NULL: planes cut it. */
  vg_decomposition_maker *maker;
  struct vg_decomposition_options decomposition;
  double cells_per_cube; /* Expected density (load.h); corrected by the cells
                            found in zones; overloaded leaves are cut again. */
  int threads;
  int cyclic; /* 1: leaves are assigned statically (engine.h), by
                 vg_front_work. */
  int sweeps; /* Optimisation sweeps. */
  struct vg_mesher_pool *mesher; /* External mesher for leaves; NULL: the
                                    built-in kernel. */
  uint64_t max_cells;   /* Upper limit of the number of cells; 0: none. */
  uint64_t layer_cells; /* Cells of the layers, which count towards
                           max_cells. */
  /* Called on every rank before the first task with the expected load, which
   * only rank 0 has (NULL elsewhere); a failure on any rank ends the run.
   * NULL: not called. */
  vg_status (*admit)(const void *user, const struct vg_front *front,
                     const struct vg_load *load, const struct vg_cut_rule *rule,
                     struct vg_error *err);
  const void *admit_user;
  uint64_t shuffle;       /* See engine.h. */
  struct vg_store *store; /* may be NULL */
  struct vg_digest job; /* Digest of sizing field and options, for the store. */
  /* For tests: share of the leaves, selected by path, that fail to fill,
   * also in the larger attempts before fail_rounds; 0. */
  double fail_leaves;
  int fail_rounds;
  struct vg_progress progress; /* Called on rank 0 with cells done and
                                  expected. */
  struct vg_stop stop;         /* Polled on every rank. */
};
#define VG_PARTITION_OPTIONS_INIT                                              \
  {                                                                            \
    .rule = { VG_LEAF_CELLS, -1, 0 }, .threads = 1, .sweeps = 2,               \
    .decomposition = VG_DECOMPOSITION_OPTIONS_INIT,                            \
    .cells_per_cube = VG_LOAD_CELLS_PER_CUBE                                   \
  }

/** Report, summed over all ranks. */
struct vg_partition_report {
  struct vg_fill_report fill; /* Times are seconds summed over all workers. */
  uint64_t n_node, n_pencil, n_tile, n_leaf;
  uint64_t n_zone_cell; /* Cells of pencils and tiles. */
  uint64_t n_blocked;   /* Pencils and tiles that could not be grown. */
  uint64_t n_crossing;  /* Those of them whose cells crossed parts of
                           the front that they had not been given. */
  uint64_t n_retry;     /* Cuts that failed to divide their void. */
  /* Stages that did not close open places, because the void is connected at
   * more places, or by more faces, than the limits of node_close.c; these
   * places are left to the leaves. */
  uint64_t n_open_left;
  uint64_t n_uncut;          /* Leaves filled although larger than requested,
                                because no plane divides them. */
  uint64_t n_outgrown;       /* Overloaded leaves, which needed more points
                                than estimated and were cut again. */
  uint64_t n_found;          /* Tasks whose outcome was in the store. */
  uint64_t n_repair_moved;   /* Moves of interface points; some points moved
                                twice. */
  uint64_t n_repair_swapped; /* Swaps of faces and edges across interfaces. */
  uint64_t n_repair;         /* Regions with bad cells at interfaces; the
                                improved ones. */
  uint64_t n_repaired;
  uint64_t n_repair_cell; /* Cells in all these regions. */
  uint64_t n_repair_bad;  /* Bad cells in them, before and after: below
                             VG_SHAPE_TARGET, or VG_METRIC_TARGET in a
                             metric. */
  uint64_t n_repair_bad_left;
  double repair_worst; /* Worst shape in them, before and after: vg_shape
                          (core/geometry/shape.h), or vg_metrics_shape
                          (core/metric/metrics.h) in a metric. */
  double repair_worst_left;
  double repair;           /* Time of repairs in s. */
  uint64_t n_widened;      /* Leaves that could not be filled, and were
                              filled together with adjacent pieces. */
  uint64_t n_widened_cell; /* Cells of these pieces, which were discarded. */
  double widened;          /* Wall time in s of the repeated decomposition. */
  uint64_t n_part; /* Subdomains that a maker made; 0: no maker was used. */
  struct vg_decomposition_report decomposition;
  double cell_bytes; /* Memory of the cells and points that a rank keeps
                          until they are written; of the rank with the most. */
  double estimate;   /* Cells expected at the start. */
  double wall;       /* Wall time in s of the engine. */
  double number;     /* Time of numbering in s. */
};

/** Members of the report, and of its decomposition, that ranks combine
 * (partition_report.c). */
extern const struct vg_entries vg_partition_entries, vg_decomposition_entries;

/** The cells of a void, on the ranks that made them. */
struct vg_partition;

/** Moves points of the field; cells keep their points. Every rank gives the
 * same points. O(n_point log n).
 *
 * @param point  [n] ascending; ids as in the slices, none of the front */
void vg_partition_move_points(struct vg_partition *p, size_t n,
                              const struct vg_slices_point *point);

#endif
