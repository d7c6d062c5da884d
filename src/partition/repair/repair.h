/* partition/repair/repair.h: cells at interfaces get better, whichever
 * tasks made them. Uses core, node.h.
 *
 * A task leaves the front that it was given as it is, so points on interfaces
 * lack sweeps of the optimisation: they get two first, with swaps across the
 * interfaces before the second, and adjacent ones one (repair_smooth.c).
 * What is bad then may need changes on both sides. Such cells are found, each
 * with a ball around it; balls that overlap are a cluster. The cells with a
 * corner in a cluster's balls are taken from their pieces and repaired on one
 * rank: points in the balls may move, all others stay, so that clusters do not
 * depend on each other. What got better becomes a piece of its own, else the
 * cells stay where they are.
 *
 * Clusters follow from coordinates alone, the cells of a cluster are in the
 * order of the paths of their pieces, and names are compared for equality
 * only: so what is made does not depend on ranks, threads and timing. */
#ifndef VG_PARTITION_REPAIR_REPAIR_H
#define VG_PARTITION_REPAIR_REPAIR_H

#include "partition/cut/node.h"

/** Improve cells at interfaces. Collective; call between the end of the
 * engine and numbering. spans: those of the engine, on all ranks or none; tasks
 * are added to them. Fills what concerns it in p->report, the same on all
 * ranks. VG_ERR_MEMORY: pieces are then of no further use. */
vg_status vg_partition_repair(struct vg_partition *p, struct vg_comm *comm,
                              struct vg_spans *spans, struct vg_error *err);

#endif
