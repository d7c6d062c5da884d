/* core/fill/fill_parts.h: the steps of the kernel. Private to core/fill. */
#ifndef VG_CORE_FILL_FILL_PARTS_H
#define VG_CORE_FILL_FILL_PARTS_H

#include "core/delaunay/tets.h"
#include "core/fill/fill.h"

/* A front that is being filled. */
struct vg_filling {
  const struct vg_front *front;
  const struct vg_region *region; /* NULL: everywhere */
  const struct vg_sizing *sizing;
  const struct vg_fill_options *options;
  struct vg_fill_report *report;
  struct vg_tets t; /* the front's points are its first ones */
  struct vg_filled out;
};

/** Place points into the fluid cells of t and insert them. (populate.c) */
vg_status vg_filling_populate(struct vg_filling *g, struct vg_error *err);

/** Drop the cells outside, put the others into a good order, optimise.
 * (populate.c) */
vg_status vg_filling_improve(struct vg_filling *g, struct vg_error *err);

/** With a region: only cells near it stay, none of them at a corner of the
 * box around all points; the faces around them are fixed. (zone.c) */
vg_status vg_zone_narrow(struct vg_filling *g, struct vg_error *err);

/** VG_MARK on the cells that a region keeps; counts them, the holes and the
 * volume in g->out. (zone.c) */
vg_status vg_zone_choose(struct vg_filling *g, struct vg_error *err);

/** The marked cells, their new points, and the change of the front, in g->out.
 * (filled.c) */
vg_status vg_filled_take(struct vg_filling *g, struct vg_error *err);

#endif
