/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/zone_cells.h: the zone of each cell of a mesh in slices. */
#ifndef VG_CORE_SIDES_ZONE_CELLS_H
#define VG_CORE_SIDES_ZONE_CELLS_H

#include "base/comm.h"
#include "core/mesh/slices.h"
#include "core/sides/zone_map.h"

struct vg_zone_slices;

/** Sort the cells of a mesh by their zones.
 *
 * Cells that share a point which is on no interface are in one zone. In a
 * slice, a face on an interface decides for all cells that are connected with
 * it in this way; else the place of the largest cell does
 * (vg_zone_map_at). Slices need nothing of each other, so that the zones depend
 * on the mesh only. Collective.
 *
 * @param z     of the surface whose interfaces are the sheets of s->boundary,
 *              with its triangles in the same order; used in this call only
 * @param s     must stay valid until vg_zone_slices_close
 * @param out   slices that have the same points and cells, and zones in their
 *              boundary. A slice has cells of one zone. Layer cells are not the
 *              first ones any more: n_layer_cell is 0
 * @param keep  to be closed after the last use of *out
 *
 * VG_ERR_GEOMETRY, with the place, if cells without an interface between them
 * are in two zones. VG_ERR_MEMORY. Memory: two bytes per cell. O(n). */
vg_status vg_zone_slices_open(struct vg_comm *comm, const struct vg_zone_map *z,
                              const struct vg_slices *s, int threads,
                              struct vg_slices *out,
                              struct vg_zone_slices **keep,
                              struct vg_error *err);

/** Accepts NULL. */
void vg_zone_slices_close(struct vg_zone_slices *keep);

#endif
