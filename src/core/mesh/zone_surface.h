/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/zone_surface.h: faces between the zones of a mesh as a surface.
 * Uses zones.h, cell_links.h. */
#ifndef VG_CORE_MESH_ZONE_SURFACE_H
#define VG_CORE_MESH_ZONE_SURFACE_H

#include "core/mesh/mesh.h"

/** Append the faces between zones to the boundary of m: patches with
 * is_interface, which have the names of their sheets, or A_to_B between the
 * zones A and B where no sheet with a name has the face. Quadrilaterals become
 * two triangles. Each face occurs once. Cells, sheets and zones stay.
 * VG_ERR_INPUT, with the name of the mesh: its boundary does not close the
 * cells. VG_ERR_UNSUPPORTED: no number for a patch. VG_ERR_MEMORY. m is
 * unchanged on failure. O(n log n). */
vg_status vg_mesh_add_interfaces(struct vg_mesh *m, const char *name,
                                 struct vg_error *err);

/** The centroid of the largest cell of zone z, which has cells. O(n). */
void vg_mesh_zone_seed(const struct vg_mesh *m, size_t z, double seed[3]);

#endif
