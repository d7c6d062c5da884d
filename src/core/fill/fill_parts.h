/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/fill/fill_parts.h: the steps of the kernel. Private to core/fill. */
#ifndef VG_CORE_FILL_FILL_PARTS_H
#define VG_CORE_FILL_FILL_PARTS_H

#include "core/delaunay/tets.h"
#include "core/fill/fill.h"

/* State of the kernel while it fills a front. */
struct vg_filling {
  const struct vg_front *front;
  const struct vg_region *region; /* NULL: no restriction */
  const struct vg_sizing *sizing;
  const struct vg_fill_options *options;
  struct vg_fill_report *report;
  struct vg_tets t; /* the points of the front come first */
  struct vg_filled out;
};

/** Place points in the fluid cells of t and insert them. (populate.c) */
vg_status vg_filling_populate(struct vg_filling *g, struct vg_error *err);

/** As vg_filling_populate, in a metric. (stretched.c) */
vg_status vg_stretched_populate(struct vg_filling *g, struct vg_error *err);

/** Remove the cells outside, reorder the others, optimise. (populate.c) */
vg_status vg_filling_improve(struct vg_filling *g, struct vg_error *err);

/** With a region: remove all cells that are not near it or have a corner of the
 * box around all points, and fix the faces around the remaining cells.
 * (zone.c) */
vg_status vg_zone_narrow(struct vg_filling *g, struct vg_error *err);

/** Set VG_MARK on the cells that a region keeps. Counts these cells, holes, and
 * the volume in g->out. (zone.c) */
vg_status vg_zone_choose(struct vg_filling *g, struct vg_error *err);

/** Store the marked cells, their new points, and the change of the front in
 * g->out. (filled.c) */
vg_status vg_filled_take(struct vg_filling *g, struct vg_error *err);

#endif
