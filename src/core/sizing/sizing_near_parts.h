/* core/sizing/sizing_near_parts.h: the hierarchy of samples that
 * core/sizing/sizing_near.c builds and core/sizing/sizing_walk.c searches.
 * Internal to core/sizing.
 *
 * Samples are classed by size, so that large and small ones do not spoil each
 * other's bounds; each class is a tree: samples in the order of a k-d tree,
 * eight to a block, blocks eight to a group, groups eight to a group above,
 * up to one root. Positions are single precision and relative to an origin of
 * the block or group, so that rounding is relative to the distance itself,
 * however wide the span of sizes is; VG_NEAR_SHY allows for it where a bound
 * must not exclude what it should not. */
#ifndef VG_CORE_SIZING_SIZING_NEAR_PARTS_H
#define VG_CORE_SIZING_SIZING_NEAR_PARTS_H

#include "core/sizing/sizing_near.h"

#define VG_NEAR_LANES 8
#define VG_NEAR_LEVELS 12
#define VG_NEAR_SHY 2e-6f
#define VG_NEAR_NEVER 1e38f  /* a size that none has */

struct vg_near_block {
  double origin[3];
  float p[3][VG_NEAR_LANES], h[VG_NEAR_LANES];
};

/* Boxes and sizes of eight children; a lane without one has sizes that are
 * never of use. */
struct vg_near_group {
  double origin[3];
  float mid[3][VG_NEAR_LANES], half[3][VG_NEAR_LANES];
  float h_min[VG_NEAR_LANES], h_max[VG_NEAR_LANES];
};

struct vg_near_tree {
  const struct vg_near_block *block;
  const struct vg_near_group *group[VG_NEAR_LEVELS]; /* the lowest first */
  int n_level;
  float h_min, h_max;
};

struct vg_near {
  struct vg_near_block *block;  /* of all trees, one after the other */
  struct vg_near_group *group;
  struct vg_near_tree tree[VG_NEAR_CLASSES];
  int n_tree;
  float slope, offset;
  float steep, rise;            /* from below, beyond the knee */
};

#endif
