/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_bvh_parts.h: the hierarchy of samples that
 * core/sizing/sizing_bvh.c builds and core/sizing/sizing_walk.c searches.
 * Internal to core/sizing.
 *
 * Samples are classed by size, so that large and small samples do not weaken
 * each other's bounds. Each class is a tree: samples in the order of a k-d
 * tree, eight per block, eight blocks per group, eight groups per group of the
 * next level, up to one root. Positions are in single precision and relative
 * to an origin of the block or group, so that rounding is relative to the
 * distance, for any range of sizes. VG_BVH_MARGIN allows for this rounding
 * where a bound must not exclude valid results. */
#ifndef VG_CORE_SIZING_SIZING_BVH_PARTS_H
#define VG_CORE_SIZING_SIZING_BVH_PARTS_H

#include "core/sizing/sizing_bvh.h"

#define VG_BVH_LANES 8
#define VG_BVH_LEVELS 12
#define VG_BVH_MARGIN 2e-6f
#define VG_BVH_NEVER 1e38f /* a size larger than that of any sample */

struct vg_bvh_block {
  double origin[3];
  float p[3][VG_BVH_LANES], h[VG_BVH_LANES];
};

/* Boxes and sizes of eight children; an empty lane has sizes that no search
 * accepts. */
struct vg_bvh_group {
  double origin[3];
  float mid[3][VG_BVH_LANES], half[3][VG_BVH_LANES];
  float h_min[VG_BVH_LANES], h_max[VG_BVH_LANES];
};

struct vg_bvh_tree {
  const struct vg_bvh_block *block;
  const struct vg_bvh_group *group[VG_BVH_LEVELS]; /* lowest level first */
  int n_level;
  float h_min, h_max;
};

struct vg_bvh {
  struct vg_bvh_block *block; /* blocks of all trees, one after the other */
  struct vg_bvh_group *group;
  struct vg_bvh_tree tree[VG_BVH_CLASSES];
  int n_tree;
  float slope, offset;
  float steep, rise; /* slope and offset from below, beyond the knee */
};

/** vg_bvh_above and vg_bvh_below with four lanes, and with eight for processors
 * with AVX2 (only if VG_WIDE is defined, base/wide.h). Same results, bit by
 * bit. */
double vg_bvh_above_narrow(const struct vg_bvh *t, const double lo[3],
                           const double hi[3], double below,
                           struct vg_bvh_reach *reach, uint32_t *hint);
double vg_bvh_below_narrow(const struct vg_bvh *t, const double x[3],
                           double above, double enough,
                           struct vg_bvh_reach *reach, double *by);
double vg_bvh_above_wide(const struct vg_bvh *t, const double lo[3],
                         const double hi[3], double below,
                         struct vg_bvh_reach *reach, uint32_t *hint);
double vg_bvh_below_wide(const struct vg_bvh *t, const double x[3],
                         double above, double enough,
                         struct vg_bvh_reach *reach, double *by);

#endif
