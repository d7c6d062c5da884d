/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/periodic/near_points.h: the nearest of some points of a mesh. Private to
 * core/periodic. */
#ifndef VG_CORE_PERIODIC_NEAR_POINTS_H
#define VG_CORE_PERIODIC_NEAR_POINTS_H

#include "core/periodic/periodic.h"
#include "core/search/box_tree.h"

struct vg_near_points {
  const struct vg_mesh *m; /* borrowed */
  uint32_t *point;         /* owned, ascending */
  size_t n, cap;
  struct vg_box_tree tree;
};
#define VG_NEAR_POINTS_INIT                                                    \
  {                                                                            \
    .tree = VG_BOX_TREE_INIT                                                   \
  } /* releasing this is a no-op */

/** Adds a point before the tree is built. Points are added in ascending order.
 * VG_ERR_MEMORY. */
vg_status vg_near_points_add(struct vg_near_points *s, uint32_t point,
                             struct vg_error *err);

/** Builds the tree. O(n log n). VG_ERR_MEMORY. */
vg_status vg_near_points_build(struct vg_near_points *s,
                               const struct vg_mesh *m, struct vg_error *err);

/** The point nearest to x, of equally near ones the lowest; VG_PERIODIC_NONE:
 * the set is empty.
 *
 * @param d2  out: its squared distance; INFINITY if the set is empty
 * O(log n). Threads: safe. */
uint32_t vg_near_points_find(const struct vg_near_points *s, const double x[3],
                             double *d2);

void vg_near_points_release(struct vg_near_points *s);

#endif
