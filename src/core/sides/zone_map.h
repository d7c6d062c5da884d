/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/zone_map.h: the zones into which interfaces divide a fluid.
 *
 *        ___________________
 *       |    _______        |     Walls (single lines) and interfaces (double)
 *       |   ||  _  ||       |     enclose zones. A triangle of a wall looks
 *       | 1 || |_| || 2     |     into one zone, the sides of an interface
 *       |   ||_____||       |     look into different ones.
 *       |___________________|
 *
 * Zones follow from the sides of triangles (core/sides/sides.h): half-faces
 * that are neighbours look into the same region. Components of the surface
 * without a common edge are connected by straight lines: two triangles that
 * follow each other on a line bound the same region. */
#ifndef VG_CORE_SIDES_ZONE_MAP_H
#define VG_CORE_SIDES_ZONE_MAP_H

#include "base/status.h"
#include "core/mesh/zones.h"
#include "core/search/box_tree.h"

struct vg_zone_map {
  const struct vg_mesh *surface; /* borrowed */
  size_t n;                      /* zones, by volume, the largest first */
  uint32_t *of;         /* [surface->n_tri] zone into which a triangle looks */
  double *volume;       /* [n] enclosed by the triangles */
  struct vg_zone *zone; /* [n] numbers from 1, names; no cells are counted */
  struct vg_box_tree tree; /* of the triangles */
};
#define VG_ZONE_MAP_INIT                                                       \
  {                                                                            \
    NULL, 0, NULL, NULL, NULL, VG_BOX_TREE_INIT                                \
  }

/** Places that are in no zone. */
#define VG_ZONE_OUTSIDE UINT32_MAX
#define VG_ZONE_ON (UINT32_MAX - 1) /* on a triangle, as far as lines tell */

/** Find the zones of a closed surface, with doubled inner surfaces
 * (core/sides/inner.h), that has interfaces (is_interface of its patches).
 *
 * A zone has the name of the interfaces between it and the largest zone next to
 * it, if that zone is larger and they have one name. Others have the name
 * zone_N with their number.
 *
 * VG_ERR_GEOMETRY if an interface has the same zone on both sides: the message
 * names the place, and the free edges of the interface, if it has any.
 * VG_ERR_MEMORY. *z is empty on failure. O(n log n), and O(n) for each
 * component of the surface. */
vg_status vg_zone_map_new(const struct vg_mesh *surface, struct vg_zone_map *z,
                          struct vg_error *err);
void vg_zone_map_release(struct vg_zone_map *z);

/** The zone at x, VG_ZONE_OUTSIDE or VG_ZONE_ON. Exact, except for x within
 * rounding errors of a triangle. Threads: re-entrant. O(log n). */
uint32_t vg_zone_map_at(const struct vg_zone_map *z, const double x[3]);

/** Does a triangle touch the box? Threads: re-entrant. O(log n). */
int vg_zone_map_touches(const struct vg_zone_map *z, const double lo[3],
                        const double hi[3]);

#endif
