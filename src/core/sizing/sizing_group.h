/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_group.h: stretched sources in groups with the same axis.
 * Internal to core/sizing. Uses core/sizing/sizing_stretch.h, core/search.
 *
 * All size tensors of a group have the same eigenvectors at each point, so that
 * their intersection is the smallest size along and across the axis. A tree of
 * boxes finds it without visiting all sources. Its coordinates are those along
 * and across the axis, the first divided by the largest ratio, so that sizes
 * grow with the distance at about the same rate in all directions. Mach cones,
 * whose axes depend on the point, are groups of one source. Threads: safe once
 * made. */
#ifndef VG_CORE_SIZING_SIZING_GROUP_H
#define VG_CORE_SIZING_SIZING_GROUP_H

#include "core/search/box_tree.h"
#include "core/sizing/sizing_stretch.h"

/** Box of sources in the coordinates of their group, and lower bounds of their
 * sizes along and across the axis: size + rise d at the distance d from it. */
struct vg_stretched_bound {
  struct vg_box box;
  double size[2], rise[2];
};

struct vg_stretched_group {
  size_t n;
  struct vg_stretched *source; /* [n] in the order of the set; borrowed */
  /* The rest only if n > 1. */
  double frame[3][3];               /* coordinates are products with these */
  struct vg_stretched_bound *bound; /* [n] owned */
  struct vg_box_tree tree; /* in the same order; nodes are vg_stretched_bound */
};

struct vg_stretched_groups {
  size_t n;
  struct vg_stretched_group *item; /* [n] owned, by their first sources */
};

/** Group the sources s [n], which are sorted by their groups; within a group
 * they keep their order. O(n log n). VG_ERR_MEMORY; *out stays empty then. */
vg_status vg_stretched_groups_make(size_t n, struct vg_stretched *s,
                                   struct vg_stretched_groups *out,
                                   struct vg_error *err);

void vg_stretched_groups_release(struct vg_stretched_groups *g);

/** Size tensor of a group at x, with sizes of at most `most`, which may be
 * INFINITY. That of a single source is not limited.
 *
 * Returns 0 if no size is below `most`; *a is not set then. The result is the
 * same, to the bit, as the smallest sizes of all sources. */
int vg_stretched_group_at(const struct vg_stretched_group *g, const double x[3],
                          double most, struct vg_size_axes *a);

/** Visit, in their order, the sources of a group that may request smaller sizes
 * somewhere in the box lo..hi than one of the size tensors h [n]: those for
 * which vg_size_is_within(h, size tensor of the source, within) may fail.
 *
 * @param most   largest size of the tensors
 * @param visit  a nonzero return value ends the search, and is returned */
int vg_stretched_group_finer(
  const struct vg_stretched_group *g, const double lo[3], const double hi[3],
  double most, size_t n, const double (*h)[6], double within,
  int (*visit)(void *context, const struct vg_stretched *s), void *context);

#endif
