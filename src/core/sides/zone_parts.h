/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/zone_parts.h: zones of the cells of a slice. Private to
 * core/sides. */
#ifndef VG_CORE_SIDES_ZONE_PARTS_H
#define VG_CORE_SIDES_ZONE_PARTS_H

#include "core/mesh/sheets.h"
#include "core/mesh/slices.h"
#include "core/sides/zone_map.h"

/* The interfaces of a mesh. */
struct vg_zone_faces {
  const struct vg_zone_map *z;
  struct vg_mesh m; /* their triangles, as sheets */
  struct vg_sheet_table table;
  uint32_t (*zone)[2]; /* [m.n_sheet_tri] zones before and behind */
};

/** boundary: of the mesh, as for vg_zone_slices_open. VG_ERR_MEMORY. */
vg_status vg_zone_faces_new(const struct vg_zone_map *z,
                            const struct vg_mesh *boundary,
                            struct vg_zone_faces *f, struct vg_error *err);
void vg_zone_faces_release(struct vg_zone_faces *f);

/** of: out, zone of each cell of the slice, in the order of kinds. Threads:
 * re-entrant. VG_ERR_GEOMETRY, VG_ERR_MEMORY. */
vg_status vg_zone_of_cells(const struct vg_zone_faces *f,
                           const struct vg_slice *slice, uint16_t *of,
                           struct vg_error *err);

#endif
