/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/planar_front.h: points of a plane region by an advancing front,
 * and smoothing. Private to planar*.c. */
#ifndef VG_CORE_DOMAIN_PLANAR_FRONT_H
#define VG_CORE_DOMAIN_PLANAR_FRONT_H

#include "core/domain/planar.h"
#include "core/domain/planar_tri.h"

/** Largest gradient of the edge length that the front allows. It only matters
 * where the boundary segments contradict the size function. */
#define VG_T2_GROWTH 0.5

/** Has the caller asked to stop? k counts steps; only some of them are
 * polled. */
static inline int vg_tri2_stops(const struct vg_planar_law *law, size_t k)
{
  return k % 256 == 0 && vg_stops(&law->stop);
}

/** Add points until the triangles have their target size. The new points come
 * last. Returns 0; 1 if stopped; -1 without memory. */
int vg_tri2_fill(struct vg_tri2 *t, const struct vg_planar_law *law);

/** Smooth the points from first_free on in at most n_sweep sweeps, then raise
 * small angles, for which points are added if the law says so. The
 * triangulation stays Delaunay. Returns 0, 1 or -1 as vg_tri2_fill. */
int vg_tri2_improve(struct vg_tri2 *t, uint32_t first_free, int n_sweep,
                    const struct vg_planar_law *law);

#endif
