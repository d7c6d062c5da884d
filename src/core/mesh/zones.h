/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/zones.h: zones, named sets of cells of which each cell belongs to
 * exactly one. Interfaces, which are sheets, walls and other parts of the
 * boundary enclose them.
 *
 * Cells of each kind are in the order of their zones, so that a zone is a run
 * of cells of each kind, and its counts describe it. Uses mesh.h. */
#ifndef VG_CORE_MESH_ZONES_H
#define VG_CORE_MESH_ZONES_H

#include "core/mesh/mesh.h"

enum { VG_ZONE_KINDS = 4 };

/** "fluid", "rotating", "porous", "solid", in the order of VG_ZONE_...; NULL at
 * the end. */
extern const char *const vg_zone_kind_word[VG_ZONE_KINDS + 1];

/** Index of the zone of a cell, 0 without zones.
 * @param kind  0 tetrahedra, 1 pyramids, 2 prisms, 3 hexahedra
 * @param cell  its number among the cells of its kind in the mesh
 * O(n_zone). */
size_t vg_mesh_zone_of(const struct vg_mesh *m, int kind, uint64_t cell);

/** Number of the first cell of a kind in zone z; z = n_zone: after the last
 * one. O(n_zone). */
uint64_t vg_mesh_zone_start(const struct vg_mesh *m, size_t z, int kind);

/** Walk along the zones of the cells of a kind, in their order: *z, 0 at first,
 * becomes the zone of `cell`, and *end, 0 at first, the number after the last
 * cell of that zone. O(1) per cell. */
static inline void vg_mesh_zone_walk(const struct vg_mesh *m, int kind,
                                     uint64_t cell, size_t *z, uint64_t *end)
{
  if (!*end && m->n_zone) *end = m->zone[*z].n_cell[kind];
  while (cell >= *end && *z + 1 < m->n_zone) *end += m->zone[++*z].n_cell[kind];
}

/** *id: numbers of the zones of all cells, in the order of kinds, to be freed;
 * NULL without zones. O(n). VG_ERR_MEMORY. */
vg_status vg_mesh_zone_numbers(const struct vg_mesh *m, int32_t **id,
                               struct vg_error *err);

/** Cells of all kinds in zone z. */
uint64_t vg_mesh_zone_cells(const struct vg_mesh *m, size_t z);

/** Sort the cells of each kind by their zones, stably, and count them.
 * is_resorted of m becomes 1 if this changes their order.
 * @param of  zone of each cell, < m->n_zone: tetrahedra, pyramids, prisms,
 *            hexahedra
 * O(n). VG_ERR_MEMORY: m is unchanged. */
vg_status vg_mesh_sort_zones(struct vg_mesh *m, const uint32_t *of,
                             struct vg_error *err);

/** Zones on both sides of the triangles of sheets, which may also be those of
 * vg_quad_low_corners (base/tri_key.h).
 * @param zone  out: [m->n_sheet_tri] before (in the direction of the normal)
 *              and behind; UINT32_MAX: no cell is there
 * O(n). VG_ERR_MEMORY. */
vg_status vg_mesh_zone_sides(const struct vg_mesh *m, uint32_t (*zone)[2],
                             struct vg_error *err);

/** Set is_interface of the sheets of which every triangle lies between two
 * zones; others keep it. Nothing without zones. VG_ERR_MEMORY. */
vg_status vg_mesh_mark_interfaces(struct vg_mesh *m, struct vg_error *err);

/** Number of triangles of sheets that are interfaces. */
size_t vg_mesh_interface_triangles(const struct vg_mesh *m);

/** Remove the zones; cells stay. */
void vg_mesh_drop_zones(struct vg_mesh *m);

/** Make the zones of m from a tag per cell: a zone for each tag, ascending,
 * with the tag as number and no name. A single tag makes no zones if `one` is
 * 0. Cells are sorted by their zones.
 * @param m    without zones
 * @param tag  of all cells, in the order of vg_mesh_sort_zones; those below 1
 *             are replaced by the lowest free numbers
 * O(n log n). VG_ERR_MEMORY: m is unchanged. */
vg_status vg_mesh_zones_from_tags(struct vg_mesh *m, const int32_t *tag,
                                  int one, struct vg_error *err);

/** The name of a zone, or zone_NUMBER if it has none. */
void vg_zone_name(const struct vg_zone *z, char name[VG_NAME_MAX]);

#endif
