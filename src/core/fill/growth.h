/* core/fill/growth.h: the steps that fills and zones share. Private to grow.c,
 * zone.c and growth.c. */
#ifndef VG_CORE_FILL_GROWTH_H
#define VG_CORE_FILL_GROWTH_H

#include "core/delaunay/tets.h"
#include "core/fill/grow.h"

struct vg_growth {
  const struct vg_sizing *sizing;
  const struct vg_region *region;    /* NULL: everywhere */
  const struct vg_grow_options *options;
  struct vg_fill_report *report;
  struct vg_tets t;
  size_t n_front;            /* points of the front: the first of t */
};

/** Non-zero: the caller wants to stop. */
int vg_growth_stopped(const struct vg_growth *g, const char *stage,
                      size_t done, size_t expected);

/** Place points into the fluid cells of t and insert them. */
vg_status vg_growth_populate(struct vg_growth *g, struct vg_error *err);

/** Drop what is outside, put what stays into a good order, optimise. */
vg_status vg_growth_improve(struct vg_growth *g, struct vg_error *err);

#endif
