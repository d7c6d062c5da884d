/* core/grow.h: the one kernel that makes cells.
 *
 * vg_grow marches into a void as far as the region admits and the limit
 * allows: the front is tetrahedralised (core/boundary.h), points are placed
 * by their own front (core/place.h) and inserted (core/insert.h), the cells
 * are optimised (core/optimise.h); those that the region admits are kept, the
 * rest is left as a void with a new front. Region "everything" is the fill,
 * "crosses a plane" a zone, "crosses a line" a pencil. */
#ifndef VG_CORE_GROW_H
#define VG_CORE_GROW_H

#include <stddef.h>
#include <stdint.h>

#include "core/fill.h"
#include "core/region.h"
#include "core/void.h"

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
 * Deterministic, re-entrant (TetGen, where needed, is serialised).
 * Returns VG_BLOCKED when the progress callback asked to stop (v unchanged),
 * VG_ERR_GEOMETRY when the front does not bound a fluid (v unchanged). */
vg_status vg_grow(struct vg_void *v, const struct vg_sizing *sizing,
                  const struct vg_region *region,
                  const struct vg_grow_options *options,
                  struct vg_fill_report *report, struct vg_error *err);

#endif
