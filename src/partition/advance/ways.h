/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/advance/ways.h: the methods to decompose a void. */
#ifndef VG_PARTITION_ADVANCE_WAYS_H
#define VG_PARTITION_ADVANCE_WAYS_H

#include "partition/cut/decomposition.h"

struct vg_way {
  const char *name;
  vg_decomposition_maker *maker; /* NULL: cut by planes of final cells. */
};

/** Indexed by enum vg_decomposition_method. */
extern const struct vg_way vg_ways[VG_DECOMPOSITIONS];

#endif
