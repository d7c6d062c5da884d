/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/delaunay/insert.h: point insertion with the Bowyer-Watson cavity in a
 * tetrahedralisation with constrained faces. Uses core/delaunay/tets.h.
 *
 * The cavity of a new point is the connected set of cells whose circumscribed
 * sphere contains it. It grows through unconstrained faces only, and is then
 * cut back until every face of it is strictly visible from the point. The
 * result is therefore valid for any degenerate input, and Delaunay wherever no
 * constraint interferes. (Bowyer, Watson, Comput. J. 24, 1981.)
 *
 * With metrics, the sphere of a cell is one in the mean of the metric at the
 * new point and those of its corners, tested in plain arithmetic (Borouchaki,
 * George, Hecht, Laug, Saltel, Finite Elem. Anal. Des. 25, 1997). The cells are
 * then not all Delaunay in the metric of the new point. Therefore a cavity
 * first grows through its hidden faces. Visibility stays exact, and with it the
 * validity of the result. */
#ifndef VG_CORE_DELAUNAY_INSERT_H
#define VG_CORE_DELAUNAY_INSERT_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"
#include "core/geometry/tensor.h"

/** A face of the cavity, seen from inside. */
struct vg_cavity_face {
  uint32_t v[3];
  uint32_t link;   /* face of the cell behind, VG_NONE at the hull */
  uint8_t fixed;   /* constrained */
  uint8_t hidden;  /* not strictly visible from the point */
  uint8_t outside; /* VG_OUTSIDE flag of the cell in front */
  uint8_t at[3];   /* numbers of the vertices within the cavity */
};

/* Cavities with up to this many vertices are linked by a table. */
enum { VG_CAVITY_TABLE = 64 };

/** Working memory of insertions, reused from one to the next; one per thread.
 */
struct vg_inserter {
  struct vg_tets *t;                    /* borrowed */
  const struct vg_point_metric *metric; /* [points] metrics of the points, in
                                           which spheres and distances are
                                           measured; NULL: Euclidean. Set by
                                           the caller */
  uint32_t *star; /* [points] a cell of each point, kept up to date for all
                     points of new cells; NULL: not kept. Set by the caller */
  int is_least;   /* 1: the cavity is the cells that contain the point, which is
                     always valid. Set by the caller */
  size_t n_cell, cap_cell, n_face, cap_face, n_tried, cap_tried;
  struct vg_cavity_cell { /* the cavity; for signs see
                             core/delaunay/cell_signs.h */
    uint32_t at, signs;
  } * cell;
  uint32_t *tried; /* cells that were found not to belong to the cavity */
  struct vg_cavity_face *face;
  size_t cap_local;
  uint32_t *local;   /* [points] number within the cavity; valid only if
                        vertex[] refers back to the point */
  uint32_t n_vertex; /* 0 if there are too many */
  uint32_t vertex[VG_CAVITY_TABLE];
  uint32_t table[VG_CAVITY_TABLE][VG_CAVITY_TABLE]; /* link of an edge */
  uint32_t point; /* the point that is inserted */
  uint32_t last;  /* a cell created by the last insertion */
};

vg_status vg_inserter_init(struct vg_inserter *s, struct vg_tets *t,
                           struct vg_error *err);
void vg_inserter_release(struct vg_inserter *s);

/** Insert point p (already in t->x, not yet in any cell), starting at the cell
 * `at` that contains it.
 *
 * @param clearance  least height of the new point over a constrained face of
 *                   its cavity, relative to the smaller of that face's mean
 *                   edge and twice `nearest`; 0: no limit
 * @param nearest    least distance to any vertex of the cavity; 0: no limit
 *
 * Returns VG_BLOCKED, and leaves t unchanged, if the point would be too near,
 * would coincide with a vertex, or has no valid cavity. */
vg_status vg_insert(struct vg_inserter *s, uint32_t p, uint32_t at,
                    double clearance, double nearest, struct vg_error *err);

#endif
