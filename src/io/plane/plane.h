/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/plane/plane.h: writers of meshes in two dimensions: SU2 (NDIME= 2), Gmsh
 * 4.1 (text) and CGNS (cell and physical dimension 2). Uses
 * core/mesh/plane_mesh.h. */
#ifndef VG_IO_PLANE_PLANE_H
#define VG_IO_PLANE_PLANE_H

#include "core/mesh/plane_mesh.h"

/** 1 if the word of a write list is a format that holds a mesh in two
 * dimensions: su2, msh, cgns. */
int vg_plane_can_write(const char *word);

/** Writes m in the format of `word`. The cells are written in the order of m,
 * quadrilaterals first. VG_ERR_IO, VG_ERR_MEMORY; VG_ERR_UNSUPPORTED: CGNS in a
 * build without HDF5. No file is left on failure. */
vg_status vg_plane_write(const char *path, const char *word,
                         const struct vg_plane_mesh *m, struct vg_error *err);

vg_status vg_su2_plane_write(const char *path, const struct vg_plane_mesh *m,
                             struct vg_error *err);
vg_status vg_gmsh_plane_write(const char *path, const struct vg_plane_mesh *m,
                              struct vg_error *err);

#endif
