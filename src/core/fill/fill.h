/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/fill/fill.h: the kernel, which makes all tetrahedra.
 *
 * The kernel tetrahedralises a front (core/recover/boundary.h), places points
 * that advance from the front by the local spacing (core/fill/place.h),
 * inserts them (core/delaunay/insert.h) and optimises the cells
 * (core/optimise/optimise.h). Without a region it fills the whole void. With a
 * region it keeps the cells along the region's planes. The faces around these
 * cells join the front of the remaining void:
 *
 *     front   ___________           ___________
 *            |     :     |         |   |xxx|   |   x  cells that are kept
 *            |     :     |   ->    |   |xxx|   |   |  new faces of the front
 *            |_____:_____|         |___|xxx|___|   :  plane of the region
 *
 * The decomposition, its coarse mesh, other meshers (core/mesher/fill_with.h)
 * and tests receive cells as vg_filled. */
#ifndef VG_CORE_FILL_FILL_H
#define VG_CORE_FILL_FILL_H

#include <stddef.h>
#include <stdint.h>

#include "base/entries.h"
#include "base/stop.h"
#include "core/front/front.h"
#include "core/front/region.h"
#include "core/sizing/sizing.h"

struct vg_fill_options {
  int sweeps;           /* optimisation sweeps over all cells; 0: no
                           optimisation at all */
  uint64_t point_limit; /* fail if more points are needed; 0: no limit */
  struct vg_stop stop;  /* checked now and then, on the caller's thread */
};
#define VG_FILL_OPTIONS_INIT                                                   \
  {                                                                            \
    2, 0,                                                                      \
    {                                                                          \
      NULL, NULL                                                               \
    }                                                                          \
  }

/** Counts and times for the report. Times are wall-clock seconds. */
struct vg_fill_report {
  size_t n_surface_face_lost;     /* front faces that had to be recovered:
                                     missing from the Delaunay tetrahedra of
                                     the front's points */
  size_t n_pocket, n_pocket_cell; /* pockets closed by TetGen, and their
                                     cells */
  size_t n_retry;                 /* pockets enlarged and tried again;
                                     regions that failed */
  size_t n_unassisted;            /* pockets that were not closed because there
                                     is no TetGen */
  int whole_void;                 /* 1: TetGen had to mesh a whole void */
  size_t n_steiner; /* interior points added by boundary recovery */
  size_t n_placed, n_inserted, n_refused; /* points of the field */
  size_t n_list_cut; /* places with more points around them than a list can
                        hold (hgrid.h); points may be too close to each other
                        there */
  size_t n_smoothed, n_flip, n_collapse, n_split; /* optimisation steps */
  size_t n_left; /* bad cells into which no point was inserted because the
                    budget was spent (core/optimise/optimise.h) */
  double bytes;  /* memory of the largest void: its tetrahedra and points
                    when all points are inserted */
  size_t n_other,
    n_other_cell;        /* voids filled by another mesher, and their cells */
  size_t n_other_failed; /* voids that another mesher failed to fill */
  size_t n_other_ended;  /* voids in which it crashed */
  size_t n_other_wrong;  /* voids for which its result was wrong */
  double time_other;     /* seconds in another mesher */
  double time_boundary, time_place, time_insert, time_optimise, time_total;
};

/** Fields of the report (fill_report.c). */
extern const struct vg_entries vg_fill_entries;

/** Result of the kernel for a front. Corners of cells and faces are indices of
 * points: first the points of the front, then the new points. */
struct vg_filled {
  size_t n_point, n_cell, n_face, n_consumed;
  double (*x)[3];      /* [n_point] coordinates of the new points */
  uint32_t (*cell)[4]; /* [n_cell] corners of cells of positive volume; NULL:
                          the cells are stored elsewhere */
  uint32_t (*face)[3]; /* [n_face] new faces of the front, which look into
                          the remaining void */
  uint32_t *consumed;  /* [n_consumed] faces of the front that have a cell
                          now, ascending. Empty without a region, where all
                          faces are consumed */
  size_t n_hole;       /* cells of the region that could not be kept */
  double volume;       /* sum of V / h^3 over the cells of a region */
};
#define VG_FILLED_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

/** Free the arrays and leave *f empty. */
void vg_filled_release(struct vg_filled *f);

/** Append *f to the bytes of a message or record. cells = 0: without cells. */
struct vg_writer;
struct vg_reader;
void vg_filled_put(struct vg_writer *w, const struct vg_filled *f, int cells);
/** Read a result written by vg_filled_put. Damaged data set r->bad and leave *f
 * empty. */
void vg_filled_get(struct vg_reader *r, struct vg_filled *f, int cells);

/** Number of defects: cells without positive volume (exact), indices out of
 * range, and, with a region, open edges of the boundary of its cells, which
 * consists of the consumed faces and the new faces. A closed front stays
 * closed if and only if this boundary has no open edges. Without a region, new
 * and consumed faces are defects. Returns SIZE_MAX if memory is refused, or if
 * the consumed faces are not ascending or out of range. has_region: as in the
 * call that made *f, which must have its cells. O(n log n). For checks. */
size_t vg_filled_defects(const struct vg_front *front,
                         const struct vg_filled *f, int has_region);

/** Make cells from a front.
 *
 * @param front   faces into the void. Every point is a corner of a face.
 *                Without a region, the front must be closed and free of
 *                intersections. With a region, it must contain exactly the
 *                faces for which vg_region_may_meet is true within
 *                VG_BAND_FRONT
 * @param region  NULL: fill the void. Otherwise it has a plane or walls, and
 *                cells lie within the walls. Regions separated by walls may
 *                therefore be meshed from the same front at the same time, at
 *                a cost that does not depend on the rest of the front
 * @param out     empty; unchanged on failure
 * @param report  counts and times are added
 *
 * An empty front bounds nothing: VG_OK and no cells, or, with a region,
 * VG_BLOCKED. Same bytes for the same input. Threads: re-entrant.
 *
 * VG_BLOCKED: no cells can be made along this region, because the front cannot
 * be recovered or its inner and outer sides cannot be distinguished; counted
 * in report->n_retry. VG_ERR_STOPPED: stop requested. VG_ERR_GEOMETRY: the
 * front does not bound a fluid. VG_ERR_UNSUPPORTED: the limit of points is
 * exceeded. VG_ERR_INPUT: see vg_front_check. */
vg_status vg_fill_front(const struct vg_front *front,
                        const struct vg_region *region,
                        const struct vg_sizing *sizing,
                        const struct vg_fill_options *options,
                        struct vg_filled *out, struct vg_fill_report *report,
                        struct vg_error *err);

#endif
