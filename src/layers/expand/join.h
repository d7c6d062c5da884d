/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/join.h: the complete mesh from columns and field. Uses core,
 * layers.h. */
#ifndef VG_LAYERS_EXPAND_JOIN_H
#define VG_LAYERS_EXPAND_JOIN_H

#include "layers/columns/layers.h"

enum vg_layer_cells { VG_LAYER_TETS, VG_LAYER_MIXED, VG_LAYER_HEX };

struct vg_join_info {
  enum vg_layer_cells cells;
  size_t n_boundary_point; /* Boundary points; they come first. */
  size_t n_layer_point;    /* One past the index of the last layer point
                              (npv). */
  size_t n_layer_tet, n_layer_pyr, n_layer_pri, n_layer_hex; /* Number of layer
                                                   cells, which are the first of
                                                   their kind. */
  size_t n_raised_point; /* Layer points that are not on the wall. */
  double wall_quads;     /* Share of the area of the walls in quadrilaterals. */
  double time;           /* Wall-clock seconds. */
};

/** Layer cells over layer points that are not on the wall; 0 without points. */
double vg_join_density(const struct vg_join_info *info);

/** Merges layers and field into one mesh.
 *
 * Points: those of the surface still in use, in order; points of side faces;
 * new points of remeshed patches; points inside layers; points of the field.
 * Points of layers and side faces are ordered by column and level, from level 1
 * on, with the columns in the order in which the corners of the faces first
 * refer to them. Boundary faces: remaining triangles of the surface, in order;
 * then, by patch, side faces (by boundary edge and level) and remeshed
 * triangles. Patches are unchanged. Cells: layer cells, by face and level, then
 * the cells of the field. Consecutive faces therefore have consecutive cells
 * and new points: a slice (slices.h).
 *
 * VG_LAYER_TETS: cells by the lift rule. VG_LAYER_MIXED: where three columns of
 * a face have the next level one prism, where two have it a pyramid, where one
 * has it a tetrahedron. The cells around a column that ends meet at its top.
 * Side faces whose two columns have the next level are quadrilaterals. Pairs of
 * virtual faces along an edge make hexahedra, and have a point in their middle
 * (pairs.h). At level 0, the columns of a root with virtual faces that are not
 * in pairs are raised last, one at a time, which makes pyramids and tetrahedra,
 * and triangles on the side faces (a prism over an edge collapsed to a point is
 * not a valid cell in any format).
 *
 * VG_LAYER_HEX: as VG_LAYER_MIXED, but most wall triangles are in pairs too,
 * which make quadrilaterals on the wall and hexahedra above (pairs.h). They
 * follow the remaining triangles of their patch, before the side faces.
 *
 * @param field   mesh of the void within layers->front; its first points are
 *                those of the front
 * @param out     replaced on success, untouched on failure
 *
 * Returns VG_ERR_INPUT if the field does not match the front, and
 * VG_ERR_UNSUPPORTED beyond 2^32 - 1 points. Runs in parallel at memory speed.
 * The result is bitwise independent of the number of threads. */
vg_status vg_layers_join(const struct vg_mesh *surface,
                         const struct vg_layers *layers,
                         const struct vg_mesh *field, enum vg_layer_cells cells,
                         int threads, struct vg_mesh *out,
                         struct vg_join_info *info, struct vg_error *err);

/** A cell in the node order of its kind. Corner k of the face is node k at
 * level 0 and 3 + k at level 1. Corners with the same root are represented by
 * the first of them at level 0. */
struct vg_wall_cell {
  int n_node; /* 4, 5 or 6. */
  uint32_t node[6];
};

/** The cells that VG_LAYER_MIXED makes on a face at level 0, which may differ
 * from those of higher levels, for checks of their shape. cell out: [3].
 * Returns the number of cells, 0 to 3. */
int vg_join_wall_cells(const struct vg_columns *columns, size_t face,
                       struct vg_wall_cell cell[3]);

/** Counts the cells of all kinds that vg_layers_join would make of the columns.
 * Front and field are not needed. Runs in parallel at memory speed.
 * VG_ERR_MEMORY. */
vg_status vg_layers_count(const struct vg_mesh *surface,
                          const struct vg_layers *layers,
                          enum vg_layer_cells cells, int threads, uint64_t *n,
                          struct vg_error *err);

#endif
