/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/repair/near.h: quality of the cells near interfaces. Uses core,
 * node.h. */
#ifndef VG_PARTITION_REPAIR_NEAR_H
#define VG_PARTITION_REPAIR_NEAR_H

#include "partition/cut/node.h"

struct vg_near_report {
  /* Cells with a corner on an interface, or adjacent to a cell that has
   * one; all cells of zones and repairs count, since they form the
   * interfaces. */
  uint64_t n_cell;
  double angle_min;    /* Smallest dihedral angle of these cells, in degrees. */
  double angle_min_p1; /* 1st percentile of their smallest dihedral angles. */
};

/** Measures the cells that were made. Collective; after repairs. The result is
 * the same for any number of ranks and threads. O(cells), half a microsecond
 * for each cell near an interface. VG_ERR_MEMORY. */
vg_status vg_partition_near(const struct vg_partition *p, struct vg_comm *comm,
                            struct vg_near_report *out, struct vg_error *err);

#endif
