/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/sides_parts.h: directions around edges. Private to core/sides. */
#ifndef VG_CORE_SIDES_SIDES_PARTS_H
#define VG_CORE_SIDES_SIDES_PARTS_H

#include "core/sides/sides.h"

/* An edge from its lower point a to its higher point b, and the direction from
 * which angles around it count, counter-clockwise seen from b. */
struct vg_turn {
  const double *a, *b, *zero;
};

/** The corner of the triangle of half-edge h that is not on its edge. */
static inline uint32_t vg_half_apex(const struct vg_sides *s, uint32_t h)
{
  return vg_half_from(s->tri, vg_half_prev(h));
}

/** The edge of half-edge h. Angles count from the triangle of h. */
struct vg_turn vg_turn_of(const struct vg_sides *s, uint32_t h);

/** Is the angle of y smaller than that of z? Angles are from 0 (included) to a
 * full turn. Exact. */
int vg_turn_before(const struct vg_turn *axis, const double y[3],
                   const double z[3]);

/** The half-face edge of the triangle of half-edge h, as 3 h' + k, that looks
 * counter-clockwise (above) or clockwise (below) around the edge. The normal
 * side of a triangle looks counter-clockwise if its half-edge begins at the
 * lower point. */
static inline uint32_t vg_wedge_above(const struct vg_sides *s, uint32_t h)
{
  return vg_sides_corner(h, vg_half_from(s->tri, h) > vg_half_to(s->tri, h));
}

static inline uint32_t vg_wedge_below(const struct vg_sides *s, uint32_t h)
{
  return vg_sides_corner(h, vg_half_from(s->tri, h) < vg_half_to(s->tri, h));
}

#endif
