/* core/delaunay/insert.h: point insertion by Bowyer and Watson's cavity, in a
 * tetrahedralisation with constrained faces. Uses core/delaunay/tets.h.
 *
 * The cavity of a new point is the connected set of cells whose circumscribed
 * sphere holds it, grown through unconstrained faces only, then cut back until
 * every face of it is strictly visible from the point. So the result is valid
 * whatever the degeneracy; it is Delaunay wherever no constraint interferes.
 * (Bowyer, Watson, Comput. J. 24, 1981.) */
#ifndef VG_CORE_DELAUNAY_INSERT_H
#define VG_CORE_DELAUNAY_INSERT_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/delaunay/tets.h"

/** One face of the cavity, seen from inside. */
struct vg_cavity_face {
  uint32_t v[3];
  uint32_t link;   /* what lies behind, VG_NONE at the hull */
  uint8_t fixed;   /* constrained */
  uint8_t hidden;  /* not strictly visible from the point */
  uint8_t outside; /* of the cell in front */
  uint8_t at[3];   /* numbers of v within the cavity */
};

/* Cavities of up to so many vertices are linked by a table. */
enum { VG_CAVITY_TABLE = 64 };

/** Scratch of insertions, reused from one to the next; one per thread. */
struct vg_inserter {
  struct vg_tets *t; /* borrowed */
  size_t n_cell, cap_cell, n_face, cap_face, n_tried, cap_tried;
  struct vg_cavity_cell { /* the cavity; signs: core/delaunay/cell_signs.h */
    uint32_t at, signs;
  } * cell;
  uint32_t *tried; /* cells found not to be in it */
  struct vg_cavity_face *face;
  size_t cap_local;
  uint32_t *local;   /* [points] number within the cavity, sure where
                        vertex[] tells the same */
  uint32_t n_vertex; /* 0: of too many */
  uint32_t vertex[VG_CAVITY_TABLE];
  uint32_t table[VG_CAVITY_TABLE][VG_CAVITY_TABLE]; /* link of an edge */
  uint32_t last; /* a cell made by the last insertion */
};

vg_status vg_inserter_init(struct vg_inserter *s, struct vg_tets *t,
                           struct vg_error *err);
void vg_inserter_release(struct vg_inserter *s);

/** Insert point p (already in t->x, in no cell yet), starting at the cell
 * `at` that contains it.
 *
 * @param clearance  least height of the new point over a constrained face of
 *                   its cavity, as a share of that face's mean edge or of
 *                   twice `nearest`, whichever is less; 0: none
 * @param nearest    least distance to any vertex of the cavity; 0: none
 * Returns VG_BLOCKED, and leaves t untouched, where the point would come too
 * near, coincide with a vertex, or see no valid cavity. */
vg_status vg_insert(struct vg_inserter *s, uint32_t p, uint32_t at,
                    double clearance, double nearest, struct vg_error *err);

#endif
