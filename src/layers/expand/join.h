/* layers/expand/join.h: the whole mesh from columns and field. Uses core,
 * layers.h. */
#ifndef VG_LAYERS_EXPAND_JOIN_H
#define VG_LAYERS_EXPAND_JOIN_H

#include "layers/columns/layers.h"

enum vg_layer_cells { VG_LAYER_TETS, VG_LAYER_MIXED };

struct vg_join_info {
  size_t n_boundary_point; /* they come first */
  size_t n_layer_point;    /* index behind the last layer point (npv) */
  size_t n_layer_tet, n_layer_pyr, n_layer_pri; /* first of their kind */
  double time;                                  /* wall seconds */
};

/** Layers and field in one mesh.
 *
 * Points: those of the surface that are still used, rising; points of flanks,
 * then new ones of re-meshed patches; points inside layers; field points.
 * Points of layers and flanks go column by column, upwards from level 1,
 * columns in the order in which the faces (and their corners) first have them.
 * Boundary triangles: those of the surface that stay, in their order, then, by
 * patch, flanks (border by border, upwards) and re-meshed ones; patches as they
 * were. Cells: layer cells first, face by face, upwards, then the field's.
 * So a run of faces has runs of cells and of new points: a slice (slices.h).
 *
 * VG_LAYER_TETS: the lift rule. VG_LAYER_MIXED: where three columns of a face
 * rise one prism, where two a pyramid, where one a tetrahedron (so beside a
 * column that ends the cells of its neighbours meet at its top), and flanks
 * whose two columns rise are quadrilaterals. Except at level 0 around a root
 * of several columns: there these rise last, one by one, which makes pyramids
 * and tetrahedra (a prism over an edge collapsed to a point is no cell of any
 * format), and flanks of triangles.
 *
 * @param field   mesh of the void within layers->front; its first points are
 *                those of the front
 * @param out     replaced on success, untouched on failure
 * VG_ERR_INPUT when the field is not the front's; VG_ERR_UNSUPPORTED beyond
 * 2^32 - 1 points.
 * Cost: memory speed, in parallel. Same bytes for any number of threads. */
vg_status vg_layers_join(const struct vg_mesh *surface,
                         const struct vg_layers *layers,
                         const struct vg_mesh *field, enum vg_layer_cells cells,
                         int threads, struct vg_mesh *out,
                         struct vg_join_info *info, struct vg_error *err);

/** A cell in the node order of its kind: corner k of the face at level 0 is
 * k, at level 1 it is 3 + k; of corners with one root the first stands for
 * all at level 0. */
struct vg_wall_cell {
  int n_node; /* 4, 5 or 6 */
  uint32_t node[6];
};

/** The cells that VG_LAYER_MIXED makes of a face at level 0, where they may
 * differ from those of the levels above, for checks of their shape.
 * cell out: [3]. Returns their number, 0 to 3. */
int vg_join_wall_cells(const struct vg_columns *columns, size_t face,
                       struct vg_wall_cell cell[3]);

/** Count the cells of all kinds that the columns become, as vg_layers_join
 * makes them. The front and the field may be absent. Memory speed, in
 * parallel. VG_ERR_MEMORY. */
vg_status vg_layers_count(const struct vg_layers *layers,
                          enum vg_layer_cells cells, int threads, uint64_t *n,
                          struct vg_error *err);

#endif
