/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_bounds.h: bounds of the sizes in a box of an
 * octree with size tensors. Internal to core/sizing.
 *
 * Every split cell of the tree has a size tensor B and two factors. The
 * distance |H n| across a plane (vg_sizing_across) at any point of the cell is
 * between `low` and `high` times |B n|, whatever n is:
 *
 *   |H n| = |H B^-1  B n| <= |H B^-1| |B n|
 *   |B n| = |B H^-1  H n| <= |B H^-1| |H n|
 *
 * Sizes that are equal up to a factor and axes that turn little in the metric
 * give narrow bounds. The tensors in a leaf are means of those at its corners,
 * and norms are convex. Therefore the corners bound the first norm exactly,
 * and the second by 1 / (1 - |H B^-1 - I|). */
#ifndef VG_CORE_SIZING_SIZING_BOUNDS_H
#define VG_CORE_SIZING_SIZING_BOUNDS_H

#include "core/sizing/sizing_octree.h"

/** Compute the bounds of all split cells of a stretched octree. Cost:
 * O(leaves). VG_ERR_MEMORY. */
vg_status vg_octree_bounds(struct vg_octree *t, struct vg_error *err);

/** Bounds of the distance across planes with n unit normals in the box lo..hi,
 * within the root cube. The tree is descended down to cells of half the longest
 * side of the box, and to leaves.
 *
 * @param least, most  out: [n] */
void vg_octree_range_across(const struct vg_octree *t, const double lo[3],
                            const double hi[3], int n,
                            const double (*normal)[3], double *least,
                            double *most);

#endif
