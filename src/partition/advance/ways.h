/* partition/advance/ways.h: the ways to decompose a void. */
#ifndef VG_PARTITION_ADVANCE_WAYS_H
#define VG_PARTITION_ADVANCE_WAYS_H

#include "partition/cut/parting.h"

struct vg_way {
  const char *name;
  vg_parting_maker *maker; /* NULL: cut by planes of final cells */
};

/** By enum vg_decomposition. */
extern const struct vg_way vg_ways[VG_DECOMPOSITIONS];

#endif
