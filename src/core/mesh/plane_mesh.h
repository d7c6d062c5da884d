/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/plane_mesh.h: a mesh in two dimensions, and the mesh one cell thick
 * that it spans. Uses core/mesh/mesh.h. */
#ifndef VG_CORE_MESH_PLANE_MESH_H
#define VG_CORE_MESH_PLANE_MESH_H

#include "core/mesh/mesh.h"

struct vg_plane_mesh {
  size_t n_point, n_tri, n_quad, n_edge, n_patch;
  size_t n_layer_tri; /* The first triangles are in layers, as are all
                         quadrilaterals. */
  double (*x)[2];     /* [n_point] */
  uint32_t (*tri)[3], (*quad)[4]; /* Cells, counter-clockwise. */
  uint32_t (*edge)[2];    /* [n_edge] boundary, with the fluid on the left. */
  uint32_t *edge_patch;   /* [n_edge] index into patch[], ascending. */
  struct vg_patch *patch; /* [n_patch] */
};
#define VG_PLANE_MESH_INIT                                                     \
  {                                                                            \
    0                                                                          \
  } /* releasing this is a no-op */

void vg_plane_mesh_release(struct vg_plane_mesh *m);

/** The mesh one cell thick: prisms on the triangles and hexahedra on the
 * quadrilaterals. Point i of the plane becomes the points i and n_point + i.
 *
 * @param axis   2: x y become x y, and the cells extend along z from 0 to
 *               `width`; 1: x y become x z, and the cells extend along y
 * @param plane  patches of the two planes, that of the points i first; they
 *               follow the patches of m
 * @param out    empty; owned by the caller
 *
 * The cells have the order of m. VG_ERR_UNSUPPORTED beyond 2^32 - 2 points;
 * VG_ERR_MEMORY. */
vg_status vg_plane_mesh_extrude(const struct vg_plane_mesh *m, int axis,
                                double width, const struct vg_patch plane[2],
                                struct vg_mesh *out, struct vg_error *err);

#endif
