/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/section/section_mesh.h: the mesh in two dimensions on the plane z = 0 of
 * a slab. Uses layers/columns, run/section/section_surface.h. */
#ifndef VG_RUN_SECTION_SECTION_MESH_H
#define VG_RUN_SECTION_SECTION_MESH_H

#include "core/mesh/plane_mesh.h"
#include "core/mesh/slices.h"
#include "layers/columns/layers.h"

/** The cells in the plane: quadrilaterals between the columns that slide in it,
 * triangles where one of two columns ends below the other and at the roots of
 * fans, and the triangles of the front.
 *
 * @param layers  NULL: none; the triangles are those of the slab
 * @param out     empty; points: those of walls and farfield, of the columns,
 *                of the field; patches: those of the slab but its planes.
 *                Patches in which columns slide lose the points under these
 * @param top     out: [columns.n_column] points at the tops of the columns in
 *                the plane; VG_NO_INDEX: others. Owned by the caller; unchanged
 *                without layers
 * VG_ERR_MEMORY. */
vg_status vg_section_mesh(const struct vg_mesh *slab,
                          const struct vg_layers *layers,
                          struct vg_plane_mesh *out, uint32_t **top,
                          struct vg_error *err);

/** Ratios of the areas across the tops of the layers.
 * @param top    as from vg_section_mesh
 * @param ratio  out: [columns.n_face] the larger over the smaller area of the
 *               two cells at the top of the wall edge of a face; 0 for virtual
 *               faces and faces without layers. Owned by the caller
 * VG_ERR_MEMORY. */
vg_status vg_section_tops(const struct vg_mesh *slab,
                          const struct vg_layers *layers,
                          const struct vg_plane_mesh *m, const uint32_t *top,
                          double **ratio, struct vg_error *err);

/** The mesh of a section, in the plane and one cell thick. */
struct vg_section_mesh {
  struct vg_plane_mesh plane;
  struct vg_mesh solid;
  struct vg_mesh
    frame;          /* Boundary of `solid`, borrowed: no points and cells. */
  uint32_t *id;     /* [solid.n_point] 0, 1, ... */
  uint32_t *top;    /* As from vg_section_mesh; NULL without layers. */
  uint64_t n_front; /* Faces of the field that have no other cell in it. */
};
#define VG_SECTION_MESH_INIT                                                   \
  {                                                                            \
    VG_PLANE_MESH_INIT, VG_MESH_INIT, VG_MESH_INIT, NULL, NULL, 0              \
  } /* releasing this is a no-op */

void vg_section_mesh_release(struct vg_section_mesh *m);

/** Makes both meshes. axis and width as in vg_plane_mesh_extrude; the planes
 * have the patches "back" and "front" of the slab, with FUN3D's condition of a
 * plane normal to the axis. VG_ERR_MEMORY,
 * VG_ERR_UNSUPPORTED. */
vg_status vg_section_mesh_new(const struct vg_mesh *slab,
                              const struct vg_layers *layers, int axis,
                              double width, struct vg_section_mesh *out,
                              struct vg_error *err);

/** The mesh one cell thick as slices: one of the layers, one of the field.
 * is_served 0: this rank serves none. m is borrowed. */
void vg_section_mesh_slices(const struct vg_section_mesh *m, int is_served,
                            struct vg_slices *out);

#endif
