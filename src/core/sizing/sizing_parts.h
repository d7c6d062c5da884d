/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_parts.h: data of a sizing field. Internal to core/sizing.
 */
#ifndef VG_CORE_SIZING_SIZING_PARTS_H
#define VG_CORE_SIZING_SIZING_PARTS_H

#include "core/sizing/sizing.h"
#include "core/sizing/sizing_octree.h"

struct vg_sizing {
  struct vg_octree octree;
  double growth, cap;     /* for spacings outside the octree: rate - 1, and
                             their upper limit */
  double slope;           /* bound on the gradient within the octree */
  double least, most;     /* range over the octree */
  double reach;           /* bound on the ratio of the largest and the mean
                             size at a point; 1 if the field is isotropic */
  struct vg_shmem common; /* shared memory with the octree's arrays, if it is
                             used */
};

#endif
