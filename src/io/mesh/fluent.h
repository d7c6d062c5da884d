/* io/mesh/fluent.h: meshes for Fluent, written only, as text (ANSYS Fluent
 * User's Guide, "Mesh file format"): points, faces with the cells on their two
 * sides, kinds of cells. Numbers of points, faces and cells, from 1, are
 * hexadecimal. */
#ifndef VG_IO_MESH_FLUENT_H
#define VG_IO_MESH_FLUENT_H

#include "core/mesh/mesh.h"

#define VG_FLUENT_SUFFIX "fluent.msh"

/** Write cells as zone "fluid", faces between them as "interior", and a zone
 * per patch, named as vg_patch_words has it, of a type by its condition: wall,
 * symmetry, pressure-far-field, pressure-inlet or pressure-outlet; without one
 * it is a wall. Cells keep their order: tetrahedra, pyramids, prisms,
 * hexahedra. The right-hand normal of a face points into its first cell; faces
 * of patches have no second one. Reals read back to the same bits.
 * VG_ERR_INPUT: no cells, or cells and boundary that do not close;
 * VG_ERR_UNSUPPORTED: more faces than an OpenFOAM mesh can have
 * (io/mesh/foam.h); VG_ERR_IO, VG_ERR_MEMORY. No file is left on failure.
 * O(n); memory 16 bytes per tetrahedron and 16 per point. */
vg_status vg_fluent_write(const char *path, const struct vg_mesh *m,
                          struct vg_error *err);

#endif
