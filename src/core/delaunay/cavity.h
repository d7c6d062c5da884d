/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/delaunay/cavity.h: the star of an edge, and replacement of the cells of
 * a cavity. Shared by the flips of boundary recovery and of the optimisation.
 * Uses tets.h. */
#ifndef VG_CORE_DELAUNAY_CAVITY_H
#define VG_CORE_DELAUNAY_CAVITY_H

#include "core/delaunay/tets.h"

enum {
  VG_CAVITY_MAX = 64
}; /* largest number of cells of a cavity, before
      and after */

/** The closed star of edge a b (the cells around it), starting at cell c.
 *
 * @param most   largest number of cells
 * @param fixed  1: fixed faces may be crossed
 *
 * cell, ring out: [most] cell[k] has the corners a, b, ring[k], ring[k + 1],
 * ordered such that (ring[k], ring[k + 1], a, b) is positive. Returns the
 * number of cells. Returns 0 if the edge is on the hull, if a fixed face may
 * not be crossed, or if there are more than `most` cells. */
int vg_cavity_ring(const struct vg_tets *t, uint32_t c, uint32_t a, uint32_t b,
                   int most, int fixed, uint32_t *cell, uint32_t *ring);

/** Points of face i of a cell, sorted. */
void vg_cavity_face(const struct vg_cell *c, int i, uint32_t v[3]);

/** Reserve memory for vg_cavity_refill. Returns 0, or -1 if memory is refused;
 * t is unchanged then. */
int vg_cavity_reserve(struct vg_tets *t, int n_old, int n_new);

/** Replace n_old cells by n_new cells that fill the same cavity; at most
 * VG_CAVITY_MAX each. The first slots of old are reused. Links and fixed faces
 * of the border are updated; faces between new cells are not fixed. slot out:
 * [n_new]. Call vg_cavity_reserve first. */
void vg_cavity_refill(struct vg_tets *t, int n_old, const uint32_t *old,
                      int n_new, const uint32_t (*v)[4], uint32_t *slot);

#endif
