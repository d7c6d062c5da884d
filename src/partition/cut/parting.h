/* partition/cut/parting.h: a void that was parted by interfaces before any of
 * it is filled: what the discrete and the octree-guided decomposition make. The
 * parts are filled, or cut further, like the children of a cut. */
#ifndef VG_PARTITION_CUT_PARTING_H
#define VG_PARTITION_CUT_PARTING_H

#include "partition/cut/task_data.h"

struct vg_parting {
  size_t n_point;
  double (*x)[3];            /* [n_point] points of interfaces, none of them on
                                the front */
  size_t n_part;
  struct vg_part {
    struct vg_front front;   /* closed, into the part; names: of the void's own
                                points as they were, of x[k] VG_POINT_NAME(
                                serial of the parting, k) */
    int may_cut;             /* 1: the advancing partition may cut it further */
  } *part;                   /* [n_part], in an order that follows from input */
};
#define VG_PARTING_INIT { 0 }

void vg_parting_release(struct vg_parting *p);

#endif
