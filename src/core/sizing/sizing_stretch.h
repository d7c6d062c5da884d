/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_stretch.h: sources whose sizes depend on the direction.
 * Internal to core/sizing. Uses core/sizing/sizing.h, core/search.
 *
 * A stretched source has the size h across its axis u, and `ratio` times h
 * along it: a ratio above 1 requests needles along u, a ratio below 1 thin
 * cells normal to u. Mach cones have other axes at each point (sizing_cone.h).
 * In its shape, the size tensor is H = h (I + (ratio - 1) u u'), and it grows
 * outside as in vg_size_grow.
 *
 * Sources with the same axis form a group. Their size tensors have the same
 * eigenvectors at each point, so that their intersection is the smallest size
 * along and across the axis. A tree of boxes finds it without visiting all
 * sources. Its coordinates are those along and across the axis, the first
 * divided by the largest ratio, so that sizes grow with the distance at about
 * the same rate in all directions. Mach cones, whose axes depend on the point,
 * are groups of one source. Threads: safe once made. */
#ifndef VG_CORE_SIZING_SIZING_STRETCH_H
#define VG_CORE_SIZING_SIZING_STRETCH_H

#include "core/search/box_tree.h"
#include "core/sizing/sizing.h"
#include "core/sizing/sizing_cone.h"

/** A prepared source. */
struct vg_stretched {
  struct vg_source law; /* source with scaled spacings; corners of a box are
                           ordered */
  double axis[3][3];    /* unit vector u, and two unit vectors normal to it and
                           to each other */
  double ratio[2];      /* at p0 and p1 */
  double slope;         /* rate of growth - 1 */
  struct vg_mach_cones cones; /* of this kind of source only */
  double least;               /* smallest size */
  double rise;         /* smallest growth of the smallest size per distance */
  double lo[3], hi[3]; /* box around all points of the shape */
};

/** Does the source stretch? Gives its axis and the ratios at p0 and p1. For
 * VGRID's sources with the stretching flag 1, the ratio is the secondary
 * spacing SP over S, and the axis is the vector P. */
int vg_source_stretch(const struct vg_source *s, double axis[3],
                      double ratio[2]);

/** Defect of the stretching of a source and how to correct it, or NULL. */
const char *vg_source_stretch_defect(const struct vg_source *s);

/** Complete s, whose law, slope and box are set. */
void vg_stretched_prepare(struct vg_stretched *s);

/** Size tensor of the source at x. */
void vg_stretched_at(const struct vg_stretched *s, const double x[3],
                     struct vg_size_axes *a);

/** Smallest size of the source in the box lo..hi, or less. */
double vg_stretched_floor(const struct vg_stretched *s, const double lo[3],
                          const double hi[3]);

/** Point of the box lo..hi where the source is near, by projections from the
 * shape to the box and back, with which the distance falls. Returns whether it
 * is the centre, because that is in the shape. */
int vg_stretched_near(const struct vg_stretched *s, const double lo[3],
                      const double hi[3], double x[3]);

/* --- groups --------------------------------------------------------------- */

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
