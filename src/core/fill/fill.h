/* core/fill/fill.h: the one kernel that makes cells.
 *
 * The kernel tetrahedralises a front (core/recover/boundary.h), places points
 * that advance from the front by the local spacing (core/fill/place.h), inserts
 * them (core/delaunay/insert.h) and optimises the cells
 * (core/optimise/optimise.h). Without a region it fills the whole void. With a
 * region it keeps the cells along the region's planes. The faces around these
 * cells join the front of the void that is left:
 *
 *     front   ___________           ___________
 *            |     :     |         |   |xxx|   |   x  cells that are kept
 *            |     :     |   ->    |   |xxx|   |   |  new faces of the front
 *            |_____:_____|         |___|xxx|___|   :  plane of the region
 *
 * The decomposition, its coarse mesh, other meshers (core/mesher/fill_with.h)
 * and tests make cells through vg_filled. */
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
  int sweeps;           /* of optimisation over all cells; 0: none */
  uint64_t point_limit; /* refuse to place more points; 0: no limit */
  struct vg_stop stop;  /* asked now and then, on the caller's thread */
};
#define VG_FILL_OPTIONS_INIT                                                   \
  {                                                                            \
    2, 0,                                                                      \
    {                                                                          \
      NULL, NULL                                                               \
    }                                                                          \
  }

/** What happened, for the report. Times are wall seconds. */
struct vg_fill_report {
  size_t n_surface_face_lost;     /* front faces to be recovered: not among the
                                     Delaunay faces of the front's points */
  size_t n_pocket, n_pocket_cell; /* pockets closed by TetGen, their cells */
  size_t n_retry;                 /* larger pockets that had to be tried */
  int whole_void;                 /* 1: TetGen had to close a whole void */
  size_t n_steiner; /* interior points added by boundary recovery */
  size_t n_placed, n_inserted, n_refused; /* field points */
  size_t n_list_cut; /* points whose surroundings were more than a list
                        holds (hgrid.h): others may be too near */
  size_t n_smoothed, n_flip, n_collapse, n_split; /* optimisation steps */
  size_t n_left; /* bad cells into which no point was tried to be put:
                    too many of them (core/optimise/optimise.h) */
  size_t n_other,
    n_other_cell;        /* voids filled by another mesher, their cells */
  size_t n_other_failed; /* voids that another mesher gave back, */
  size_t n_other_ended;  /* that its process ended in, or would not end, */
  size_t n_other_wrong;  /* and that it did not fill as it should have */
  double time_other;     /* seconds in another mesher */
  double time_boundary, time_place, time_insert, time_optimise, time_total;
};

/** Its fields (fill_report.c). */
extern const struct vg_entries vg_fill_entries;

/** What became of a front: its change. Corners of cells and faces are indices
 * of points: those of the front first, new points behind them. */
struct vg_filled {
  size_t n_point, n_cell, n_face, n_consumed;
  double (*x)[3];      /* [n_point] coordinates of the new points */
  uint32_t (*cell)[4]; /* [n_cell] corners of cells of positive volume;
                          NULL: the cells are elsewhere */
  uint32_t (*face)[3]; /* [n_face] new faces of the front, which look into
                          the void that is left */
  uint32_t *consumed;  /* [n_consumed] faces of the front that have a cell
                          now, ascending. Without a region all of them
                          have, and the list is empty */
  size_t n_hole;       /* cells of the region that could not be kept */
  double volume;       /* sum over a region's cells of V / h^3 */
};
#define VG_FILLED_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

/** Frees the arrays. *f is empty then. */
void vg_filled_release(struct vg_filled *f);

/** Append *f to the bytes of a message or record; cells 0: without cells. */
struct vg_writer;
struct vg_reader;
void vg_filled_put(struct vg_writer *w, const struct vg_filled *f, int cells);
/** The reverse. Damaged data set r->bad and leave *f empty. */
void vg_filled_get(struct vg_reader *r, struct vg_filled *f, int cells);

/** Number of defects: cells without positive volume (exact), indices out of
 * range, and, with a region, open edges of the boundary of its cells, which the
 * consumed faces and the new faces make up. A closed front stays closed if and
 * only if this boundary has no open edges. Without a region, new and consumed
 * faces are defects. 0 where all is well; SIZE_MAX when memory is refused, or
 * where the consumed faces do not ascend or are out of range. has_region: as in
 * the call that made *f, which has its cells. O(n log n). For checks. */
size_t vg_filled_defects(const struct vg_front *front,
                         const struct vg_filled *f, int has_region);

/** Make cells from a front.
 *
 * @param front   faces into the void. Every point is a corner of a face.
 * Without a region: closed, free of intersections. With a region: all faces
 * that vg_region_may_meet within VG_BAND_FRONT, and no others
 * @param region  NULL: fill the void. Else it has a plane or walls; cells lie
 * in the walls, so that regions which walls keep apart may be made from the
 * same front at the same time, at a cost that does not depend on the rest of
 * the front
 * @param out     empty; untouched on failure
 * @param report  counts and times are added
 * An empty front bounds nothing: VG_OK and no cells, or, with a region,
 * VG_BLOCKED. Same bytes for the same input. Threads: re-entrant.
 * VG_BLOCKED: no cells can be made along this region (the front cannot be
 * recovered, or its inner side not told from its outer side, which
 * report->n_retry counts). VG_ERR_STOPPED: as asked. VG_ERR_GEOMETRY: the front
 * does not bound a fluid. VG_ERR_UNSUPPORTED: the limit of points is passed.
 * VG_ERR_INPUT: see vg_front_check. */
vg_status vg_fill_front(const struct vg_front *front,
                        const struct vg_region *region,
                        const struct vg_sizing *sizing,
                        const struct vg_fill_options *options,
                        struct vg_filled *out, struct vg_fill_report *report,
                        struct vg_error *err);

#endif
