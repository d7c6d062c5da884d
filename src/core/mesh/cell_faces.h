/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/cell_faces.h: faces of the cells of core/mesh/mesh.h (formats.md
 * 2.3), with normals into the cell. A triangle repeats its last node. */
#ifndef VG_CORE_MESH_CELL_FACES_H
#define VG_CORE_MESH_CELL_FACES_H

static const unsigned char vg_tet_face[4][4] = {
  { 1, 3, 2, 2 }, { 0, 2, 3, 3 }, { 0, 3, 1, 1 }, { 0, 1, 2, 2 }
};
static const unsigned char vg_pyr_face[5][4] = {
  { 0, 1, 2, 2 }, { 1, 4, 2, 2 }, { 2, 4, 3, 3 }, { 0, 2, 3, 3 }, { 0, 3, 4, 1 }
};
static const unsigned char vg_pri_face[5][4] = {
  { 0, 3, 4, 1 }, { 1, 4, 5, 2 }, { 0, 2, 5, 3 }, { 0, 1, 2, 2 }, { 3, 5, 4, 4 }
};
static const unsigned char vg_hex_face[6][4] = {
  { 0, 3, 7, 4 }, { 1, 5, 6, 2 }, { 0, 4, 5, 1 },
  { 2, 6, 7, 3 }, { 0, 1, 2, 3 }, { 4, 7, 6, 5 }
};

/* The same by kind: tetrahedra, pyramids, prisms, hexahedra. */
static const struct {
  int width, n_face; /* nodes and faces of a cell */
  const unsigned char (*face)[4];
} vg_cell_faces[4] = { { 4, 4, vg_tet_face },
                       { 5, 5, vg_pyr_face },
                       { 6, 5, vg_pri_face },
                       { 8, 6, vg_hex_face } };

#endif
