/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/zone_table.h: zones of cells, from the interfaces of the closed
 * surface and the table `zones`. */
#ifndef VG_RUN_INPUT_ZONE_TABLE_H
#define VG_RUN_INPUT_ZONE_TABLE_H

#include "base/comm.h"
#include "core/sides/zone_map.h"
#include "io/cad/cad.h"
#include "run/input/input.h"

/** Add a row for each solid of a CAD file that is a zone. A row of its name
 * keeps its values, and gets the point if it has none.
 * @param z   released
 * @param st  status so far: after a failure nothing is added
 * Returns st; VG_ERR_MEMORY. */
vg_status vg_zone_rows_take(struct vg_settings *s, struct vg_cad_zones *z,
                            vg_status st, struct vg_error *err);

/** All ranks take the rows of rank 0. Collective. */
vg_status vg_zone_rows_bcast(struct vg_comm *c, struct vg_settings *s,
                             struct vg_error *err);

/** Find the zones of a surface, with names and kinds from the table `zones`.
 *
 * @param is_cut  1: without the rows of zones that have no cells, which are not
 *                part of the surface
 * @param hmax  out: [z->n] largest edges, 0: none; to be freed. NULL: not asked
 * VG_ERR_INPUT for a row without a point, a seed point outside the fluid or on
 * a triangle, two seed points in one zone, and two zones of one name; otherwise
 * as vg_zone_map_new. *z is empty on failure. */
vg_status vg_zones_make(const struct vg_settings *s,
                        const struct vg_mesh *surface, int is_cut,
                        struct vg_zone_map *z, double **hmax,
                        struct vg_error *err);

/** Whether a row of the table `zones` is a zone without cells. */
int vg_zones_lack_cells(const struct vg_settings *s);

/** A zone with a requested size, and what limits it there: the patch of the
 * longest edge among the triangles that look into the zone. */
struct vg_zone_limit {
  double hmax;  /* 0: no request */
  size_t patch; /* of the surface */
  double edge;
};

/** limit: out [z->n], from hmax [z->n] and the triangles of z. */
void vg_zones_limits(const struct vg_zone_map *z, const double *hmax,
                     struct vg_zone_limit *limit);

/** Do interfaces divide the surface into zones? */
int vg_mesh_has_interfaces(const struct vg_mesh *surface);

/** Remove the zones without cells from the closed surface of b (zone_walls.c).
 * @param map       its zones, out of date afterwards
 * @param is_empty  [map->n] 1: without cells
 * VG_ERR_INPUT for an interface that only in part is on such a zone. */
vg_status vg_boundary_cut_zones(struct vg_boundary *b,
                                const struct vg_zone_map *map,
                                const uint8_t *is_empty, struct vg_error *err);

/** Find the zones of the closed surface of b, if it has interfaces, remove
 * those without cells, and add the sizes of the others to b->map. Notes list
 * the zones. VG_ERR_INPUT also for a table `zones` without interfaces. */
vg_status vg_boundary_add_zones(struct vg_boundary *b, struct vg_error *err);

/** Release b->zones; b->map is that from before. */
void vg_boundary_forget_zones(struct vg_boundary *b);

/** VG_ERR_INPUT if the table `zones` has rows, and no patch is an interface. */
vg_status vg_zones_check(const struct vg_boundary *b, struct vg_error *err);

#endif
