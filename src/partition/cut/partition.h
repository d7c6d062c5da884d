/* partition/cut/partition.h: a void that is cut into parts and filled:
 * settings, report and what comes of it. Uses core, lattice.h, store.h. */
#ifndef VG_PARTITION_CUT_PARTITION_H
#define VG_PARTITION_CUT_PARTITION_H

#include <stdint.h>

#include "base/progress.h"
#include "base/stop.h"
#include "core/fill/fill.h"
#include "core/mesher/fill_with.h"
#include "partition/cut/lattice.h"
#include "partition/cut/decomposition.h"
#include "partition/store/store.h"

/** Cells to a leaf, by default: measured, docs/performance-parallel.md. */
#define VG_LEAF_CELLS 300000.0 /* C1 */

struct vg_partition_options {
  struct vg_cut_rule rule;
  int levels;                    /* bisections, where rule.leaf_cells is 0 */
  vg_decomposition_maker *maker; /* parts the void before any of it is filled,
                              by the options behind; NULL: planes cut it */
  struct vg_decomposition_options decomposition;
  double cells_per_cube; /* expected (load.h); what zones hold corrects it,
                            and leaves that outgrow it are cut again */
  int threads;
  int cyclic; /* 1: leaves are dealt out beforehand (engine.h),
                 by vg_front_work */
  int sweeps; /* of optimisation */
  struct vg_mesher_pool *mesher; /* for leaves; NULL: the built-in kernel */
  uint64_t max_cells;            /* refuse to make more; 0: no limit */
  uint64_t layer_cells;          /* cells that the mesh has besides, which count
                                    for max_cells */
  uint64_t shuffle;              /* see engine.h */
  struct vg_store *store;        /* may be NULL */
  struct vg_digest job;          /* of size field and options, for the store */
  double fail_leaves;            /* share of the leaves that are not filled, by
                                    their paths, nor in the larger attempts
                                    before fail_rounds: for tests; 0 */
  int fail_rounds;
  struct vg_progress progress; /* on rank 0; cells done, expected */
  struct vg_stop stop;         /* asked on every rank */
};
#define VG_PARTITION_OPTIONS_INIT                                              \
  {                                                                            \
    .rule = { VG_LEAF_CELLS, -1, 0 }, .threads = 1, .sweeps = 2,               \
    .decomposition = VG_DECOMPOSITION_OPTIONS_INIT,                            \
    .cells_per_cube = VG_LOAD_CELLS_PER_CUBE                                   \
  }

/** What happened, summed over all ranks. */
struct vg_partition_report {
  struct vg_fill_report fill; /* times are seconds of all workers together */
  uint64_t n_node, n_pencil, n_tile, n_leaf;
  uint64_t n_zone_cell;      /* cells of pencils and tiles */
  uint64_t n_blocked;        /* pencils and tiles that could not be grown */
  uint64_t n_crossing;       /* among these, those whose cells crossed a front
                                that they had not been given */
  uint64_t n_retry;          /* cuts that did not part their void */
  uint64_t n_open_left;      /* stages between zones left to leaves, since the
                                void hangs together at more places, or by more
                                faces, than are looked at (node_close.c) */
  uint64_t n_uncut;          /* leaves filled although larger than asked for,
                                because no plane parts them */
  uint64_t n_outgrown;       /* leaves that outgrew their estimate and were
                                cut again */
  uint64_t n_found;          /* tasks whose outcome was in the store */
  uint64_t n_repair_moved;   /* moves of points on interfaces: some twice */
  uint64_t n_repair_swapped; /* swaps of faces and edges across interfaces */
  uint64_t n_repair;         /* bad regions at interfaces; those that got
                                better */
  uint64_t n_repaired;
  uint64_t n_repair_cell; /* cells in all those regions */
  uint64_t n_repair_bad;  /* below VG_SHAPE_TARGET among them, before, after */
  uint64_t n_repair_bad_left;
  double repair_worst; /* and the worst one (core/geometry/shape.h) */
  double repair_worst_left;
  double repair;           /* seconds of repairs */
  uint64_t n_widened;      /* parts that could not be filled, and were filled
                              together with what is beside them */
  uint64_t n_widened_cell; /* cells there, made for nothing */
  double widened;          /* seconds, in wall */
  uint64_t n_part;         /* that a maker made; 0: there was none */
  struct vg_decomposition_report decomposition;
  double estimate; /* cells expected at the start */
  double wall;     /* seconds of the engine */
  double number;   /* seconds of numbering */
};

/** Fields of it, and of its decomposition, that ranks combine
 * (partition_report.c).
 */
extern const struct vg_entries vg_partition_entries, vg_decomposition_entries;

/** The cells of a void, on the ranks that made them. */
struct vg_partition;

#endif
