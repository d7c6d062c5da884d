/* io/mesh/su2.h: meshes for SU2, written only.
 *
 * The native text format of SU2 (su2code.github.io/docs_v7/Mesh-File): cells by
 * VTK's numbers of kinds and order of nodes, indices from 0, markers by name.
 * Numbers stand in columns of one width, so that all ranks can write one
 * file. */
#ifndef VG_IO_MESH_SU2_H
#define VG_IO_MESH_SU2_H

#include "core/mesh/mesh.h"

/** Write cells, points and a marker per patch, named as vg_patch_words has it.
 * Cells: tetrahedra, pyramids, prisms, hexahedra, in that order. Reals read
 * back to the same bits.
 * VG_ERR_INPUT: no cells; VG_ERR_IO, VG_ERR_MEMORY. No file is left on
 * failure. */
vg_status vg_su2_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err);

#endif
