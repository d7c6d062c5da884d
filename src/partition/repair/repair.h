/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/repair/repair.h: improves cells at interfaces, across the pieces
 * of all tasks. Uses core, node.h.
 *
 * A task leaves its front unchanged, so points on interfaces lack sweeps of
 * the optimisation. They get two sweeps first, with swaps across the
 * interfaces before the second, and adjacent points one (repair_smooth.c).
 * Cells that are still bad may need changes on both sides. Such cells are
 * found, each with a ball (repair region) around it; overlapping balls form a
 * cluster. The cells with a corner in a cluster's balls are taken from their
 * pieces and repaired on one rank: points in the balls may move, all others
 * stay, so that clusters are independent of each other. An improved cluster
 * becomes a piece of its own; otherwise the cells stay where they are.
 *
 * Clusters depend on coordinates alone, the cells of a cluster are in the
 * order of the paths of their pieces, and global ids are compared for equality
 * only. The result is therefore independent of ranks, threads and timing. */
#ifndef VG_PARTITION_REPAIR_REPAIR_H
#define VG_PARTITION_REPAIR_REPAIR_H

#include "partition/cut/node.h"

/** Improves cells at interfaces. Collective; called between the end of the
 * engine and numbering. spans: the trace of the engine, on all ranks or none;
 * tasks are added to it. Sets the members for repairs in p->report, equal on
 * all ranks. VG_ERR_MEMORY: the pieces are then unusable. */
vg_status vg_partition_repair(struct vg_partition *p, struct vg_comm *comm,
                              struct vg_spans *spans, struct vg_error *err);

#endif
