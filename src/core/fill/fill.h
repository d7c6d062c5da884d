/* core/fill/fill.h: a closed surface and a size field in, tetrahedra out. */
#ifndef VG_CORE_FILL_FILL_H
#define VG_CORE_FILL_FILL_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

/** Called now and then with the work done so far; return non-zero to stop
 * (the fill then ends with VG_BLOCKED and no mesh). May be NULL. */
typedef int (*vg_progress)(void *user, const char *stage, size_t done,
                           size_t expected);

struct vg_fill_options {
  int optimise;            /* sweeps of optimisation, 0: none; default 2 */
  uint64_t max_cells;      /* refuse to make more; 0: no limit */
  vg_progress progress;
  void *user;
};
#define VG_FILL_OPTIONS_INIT { 2, 0, NULL, NULL }

/** What happened, for the report. Times are wall seconds. */
struct vg_fill_report {
  size_t n_surface_face_lost; /* surface triangles to be recovered: not among
                                 the Delaunay faces of the surface's points */
  size_t n_pocket, n_pocket_cell; /* pockets closed by TetGen, their cells */
  size_t n_retry;          /* larger pockets that had to be tried */
  int whole_void;          /* 1: TetGen had to close a whole void */
  size_t n_steiner;        /* interior points added by boundary recovery */
  size_t n_placed, n_inserted, n_refused; /* field points */
  size_t n_list_cut;       /* points whose surroundings were more than a list
                              holds (hgrid.h): others may be too near */
  size_t n_smoothed, n_flip, n_collapse, n_split; /* optimisation steps */
  size_t n_left;           /* bad cells into which no point was tried to be put:
                              too many of them (core/optimise/optimise.h) */
  size_t n_other, n_other_cell; /* voids filled by another mesher, their cells */
  size_t n_other_failed;   /* voids that another mesher gave back, */
  size_t n_other_ended;    /* that its process ended in, or would not end, */
  size_t n_other_wrong;    /* and that it did not fill as it should have */
  double time_other;       /* seconds in another mesher */
  double time_boundary, time_place, time_insert, time_optimise, time_total;
};

/** Tetrahedralise what the boundary triangles of `surface` enclose.
 *
 * @param surface  closed, oriented into the fluid, free of intersections
 *                 (see surface_check.h), no quads; cells ignored; borrowed
 * @param out      the volume mesh: its first surface->n_point points, its
 *                 triangles and its patches are those of `surface`, in order
 *                 (points of the surface that no triangle uses are refused)
 * Threads: re-entrant. Same bytes for the same input.
 * Returns VG_ERR_GEOMETRY when the surface cannot bound a mesh. */
vg_status vg_fill(const struct vg_mesh *surface, const struct vg_sizing *sizing,
                  const struct vg_fill_options *options, struct vg_mesh *out,
                  struct vg_fill_report *report, struct vg_error *err);

#endif
