/* core/delaunay/cavity.h: cells around an edge, and cells put in the place of
 * others. What flips of boundary recovery and of the optimisation share. Uses
 * tets.h. */
#ifndef VG_CORE_DELAUNAY_CAVITY_H
#define VG_CORE_DELAUNAY_CAVITY_H

#include "core/delaunay/tets.h"

enum { VG_CAVITY_MAX = 64 }; /* cells of a cavity, before and after */

/** The closed ring of cells around edge a b, starting at cell c.
 *
 * @param most   cells at most
 * @param fixed  1: through fixed faces too
 * cell, ring out: [most] cell[k] holds a, b, ring[k], ring[k + 1], in an order
 * such that (ring[k], ring[k + 1], a, b) is positive.
 * Returns the number of cells; 0 at the hull, at a fixed face that is not to
 * be crossed, and where there are more than `most`. */
int vg_cavity_ring(const struct vg_tets *t, uint32_t c, uint32_t a, uint32_t b,
                   int most, int fixed, uint32_t *cell, uint32_t *ring);

/** Points of face i of a cell, the least first. */
void vg_cavity_face(const struct vg_cell *c, int i, uint32_t v[3]);

/** Room for vg_cavity_refill. 0, or -1 when refused, t unchanged. */
int vg_cavity_reserve(struct vg_tets *t, int n_old, int n_new);

/** Replace n_old cells by n_new ones that fill the same cavity, each at most
 * VG_CAVITY_MAX. The first slots of old are reused; links and fixed faces of
 * the border are brought up to date, faces between new cells are not fixed.
 * slot out: [n_new]. Room must be there. */
void vg_cavity_refill(struct vg_tets *t, int n_old, const uint32_t *old,
                      int n_new, const uint32_t (*v)[4], uint32_t *slot);

#endif
