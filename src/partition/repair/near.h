/* partition/repair/near.h: how good are the cells near interfaces? Uses core,
 * node.h. */
#ifndef VG_PARTITION_REPAIR_NEAR_H
#define VG_PARTITION_REPAIR_NEAR_H

#include "partition/cut/node.h"

struct vg_near_report {
  uint64_t n_cell;     /* with a corner on an interface, or beside a cell
                          that has one; those of zones and repairs, which
                          are interfaces, all */
  double angle_min;    /* degrees, of the least dihedral angle of each */
  double angle_min_p1; /* 1st percentile of these */
};

/** Look at all cells that were made. Collective; after repairs.
 * The same for any number of ranks and threads. O(cells), half a microsecond
 * for each that is near. VG_ERR_MEMORY. */
vg_status vg_partition_near(const struct vg_partition *p, struct vg_comm *comm,
                            struct vg_near_report *out, struct vg_error *err);

#endif
