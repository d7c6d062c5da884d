/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/su2.h: writer of meshes for SU2.
 *
 * The native text format of SU2 (su2code.github.io/docs_v7/Mesh-File): cells
 * with VTK's type numbers and node order, indices from 0, markers by name.
 * Numbers are written in columns of one width, so that all ranks can write one
 * file. */
#ifndef VG_IO_MESH_SU2_H
#define VG_IO_MESH_SU2_H

#include "core/mesh/mesh.h"

/** Write cells, points and one marker per patch, with the names of
 * vg_patch_words. Cells are in the order tetrahedra, pyramids, prisms,
 * hexahedra. Reals read back to the same bits.
 * VG_ERR_INPUT: no cells; VG_ERR_IO, VG_ERR_MEMORY. No file is left on
 * failure. */
vg_status vg_su2_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err);

#define VG_SU2_ZONES "zones.su2" /* suffix of vg_su2_write_zones */

/** Write the zones of m as meshes of their own, a block IZONE for each
 * (core/mesh/zone_meshes.h): both sides of interfaces are markers, whose points
 * each zone has for itself. Comments at the beginning have the lines for SU2's
 * configuration: the pairs of MARKER_ZONE_INTERFACE and the order of the zones.
 * Memory: that of the largest zone. VG_ERR_INPUT: no zones; otherwise as
 * vg_su2_write. */
vg_status vg_su2_write_zones(const char *path, const struct vg_mesh *m,
                             struct vg_error *err);

#endif
