/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/cell_edges.h: edges of the cells of core/mesh/mesh.h (formats.md
 * 2.3). */
#ifndef VG_CORE_MESH_CELL_EDGES_H
#define VG_CORE_MESH_CELL_EDGES_H

static const unsigned char vg_tet_edge[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 },
                                                 { 1, 2 }, { 1, 3 }, { 2, 3 } };
static const unsigned char vg_pyr_edge[8][2] = { { 0, 3 }, { 3, 4 }, { 4, 1 },
                                                 { 1, 0 }, { 0, 2 }, { 3, 2 },
                                                 { 4, 2 }, { 1, 2 } };
static const unsigned char vg_pri_edge[9][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 },
                                                 { 3, 4 }, { 4, 5 }, { 5, 3 },
                                                 { 0, 3 }, { 1, 4 }, { 2, 5 } };
static const unsigned char vg_hex_edge[12][2] = {
  { 0, 1 }, { 1, 2 }, { 2, 3 }, { 3, 0 }, { 4, 5 }, { 5, 6 },
  { 6, 7 }, { 7, 4 }, { 0, 4 }, { 1, 5 }, { 2, 6 }, { 3, 7 }
};

#endif
