/* core/sizing/sizing_parts.h: what a field of sizes consists of. Internal to
 * core/sizing. */
#ifndef VG_CORE_SIZING_SIZING_PARTS_H
#define VG_CORE_SIZING_SIZING_PARTS_H

#include "core/sizing/sizing.h"
#include "core/sizing/sizing_octree.h"

struct vg_sizing {
  struct vg_octree octree;
  double growth, cap;     /* of sizes outside the octree; growth: rate - 1 */
  double slope;           /* bound on the gradient in it */
  double least, most;     /* over the octree */
  struct vg_shmem common; /* where the octree's arrays are, if anywhere */
};

#endif
