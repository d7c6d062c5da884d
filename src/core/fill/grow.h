/* core/fill/grow.h: the one kernel that makes cells.
 *
 * The front is tetrahedralised (core/recover/boundary.h), points are placed by
 * their own front (core/fill/place.h) and inserted (core/delaunay/insert.h),
 * the cells are optimised (core/optimise/optimise.h); those that the region
 * admits are kept, the rest is left with a new front. Everywhere, that is the
 * fill: vg_grow. Along a plane or a line it makes a zone or a pencil out of the
 * front nearby, which need not be closed, and at a cost that does not depend on
 * the rest of the front: vg_zone_grow. */
#ifndef VG_CORE_FILL_GROW_H
#define VG_CORE_FILL_GROW_H

#include <stddef.h>
#include <stdint.h>

#include "core/fill/fill.h"
#include "core/front/region.h"
#include "core/front/void.h"

struct vg_grow_options {
  int sweeps;                /* of optimisation over all cells; 0: none */
  size_t max_cells;          /* keep at most so many; 0: all */
  uint64_t point_limit;      /* refuse to place more points; 0: none */
  vg_progress progress;
  void *user;
};
#define VG_GROW_OPTIONS_INIT { 2, 0, 0, NULL, NULL }

/** Grow cells in v. Counts and times are added to *report.
 *
 * On return the cells were appended to v->cell, new points to v->x, and
 * v->face is the front of what is left: empty when all was filled.
 * Deterministic, re-entrant.
 * Returns VG_BLOCKED when the progress callback asked to stop (v unchanged),
 * VG_ERR_GEOMETRY when the front does not bound a fluid (v unchanged). */
vg_status vg_grow(struct vg_void *v, const struct vg_sizing *sizing,
                  const struct vg_grow_options *options,
                  struct vg_fill_report *report, struct vg_error *err);

/** What vg_zone_grow made of a part of a front. */
struct vg_zone {
  size_t n_point, n_face, n_cell;
  double (*x)[3];            /* [n_point] new points */
  uint32_t (*face)[3];       /* [n_face] new front faces, facing the void;
                                points of the front first, new ones behind */
  uint32_t (*cell)[4];       /* [n_cell] likewise */
  uint8_t *gone;             /* [n_face of the front] 1: has a cell now */
  double volume;             /* sum over the cells of V / h^3 */
  size_t n_hole;             /* cells of the region that could not be kept */
};
#define VG_ZONE_INIT { 0 }

void vg_zone_release(struct vg_zone *z);

/** Grow the cells of a region from the front near it.
 *
 * @param x, face  front faces that vg_region_may_meet within VG_BAND_FRONT,
 *                 all of them and no other, with their points
 * @param region   with at least one plane
 * @param z        empty; released on failure
 * Cells lie within the region's walls, so regions that walls keep apart may be
 * grown from the same front at the same time. Holes are where the region's
 * cells would leave the walls or what is known of the front.
 * VG_BLOCKED: stopped, or no zone can be made here (the front cannot be
 * recovered, or its inner side not told from its outer side): z is empty and
 * nothing was changed; report->n_retry counts the latter. */
vg_status vg_zone_grow(size_t n_point, const double (*x)[3], size_t n_face,
                       const uint32_t (*face)[3],
                       const struct vg_region *region,
                       const struct vg_sizing *sizing,
                       const struct vg_grow_options *options,
                       struct vg_zone *z, struct vg_fill_report *report,
                       struct vg_error *err);

#endif
