/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/advance/ways.h"

#include "partition/discrete/discrete.h"
#include "partition/octree/octree.h"

const struct vg_way vg_ways[VG_DECOMPOSITIONS] = {
  [VG_DECOMPOSE_ADVANCING] = { "advancing", NULL },
  [VG_DECOMPOSE_DISCRETE] = { "discrete", vg_discrete_part },
  [VG_DECOMPOSE_OCTREE] = { "octree", vg_octree_part },
};
