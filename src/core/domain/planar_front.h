/* core/domain/planar_front.h: points of a plane region by an advancing front,
 * and their smoothing. Private to planar*.c. */
#ifndef VG_CORE_DOMAIN_PLANAR_FRONT_H
#define VG_CORE_DOMAIN_PLANAR_FRONT_H

#include "core/domain/planar.h"
#include "core/domain/planar_tri.h"

/** Steepest change of edge length with distance that the front allows. It
 * only matters where boundary segments and size function disagree. */
#define VG_T2_GROWTH 0.5

/** Is the caller asked to stop? k counts steps: not at every one of them. */
static inline int vg_tri2_stops(const struct vg_planar_law *law, size_t k)
{
  return k % 256 == 0 && vg_stops(&law->stop);
}

/** Add points until the triangles have the target size.
 * Points from `first_free` on are the new ones. 0; 1: stopped; or -1 without
 * memory. */
int vg_tri2_fill(struct vg_tri2 *t, const struct vg_planar_law *law);

/** Move the points from first_free on to better places, keeping the
 * triangulation Delaunay; bad vertices are taken out. 0, 1 or -1. */
int vg_tri2_improve(struct vg_tri2 *t, uint32_t first_free, int n_sweep,
                    const struct vg_planar_law *law);

#endif
