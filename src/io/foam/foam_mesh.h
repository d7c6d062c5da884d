/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/foam/foam_mesh.h: cells from lists of faces. Private to its module. */
#ifndef VG_IO_FOAM_FOAM_MESH_H
#define VG_IO_FOAM_FOAM_MESH_H

#include "core/mesh/mesh.h"

/** The lists of polyMesh. */
struct vg_foam_lists {
  size_t n_point, n_face, n_inner, n_cell, n_corner;
  double *point;               /* [3 * n_point] */
  size_t *first;               /* [n_face + 1] into corner */
  uint32_t *corner;            /* [n_corner] */
  uint32_t *owner, *neighbour; /* [n_face], [n_inner] */
  size_t n_patch;
  struct vg_foam_patch {
    char name[VG_NAME_MAX];
    size_t start, n;
  } * patch;
};
#define VG_FOAM_LISTS_INIT                                                     \
  {                                                                            \
    .n_point = 0                                                               \
  }

void vg_foam_lists_release(struct vg_foam_lists *l);

/** The mesh of valid lists: all numbers are in their ranges, and the patches
 * cover the faces from n_inner on.
 * @param m     empty
 * @param cell  out: [n_cell] as in struct vg_foam_case; to be freed
 * VG_ERR_UNSUPPORTED, VG_ERR_FORMAT, VG_ERR_MEMORY. */
vg_status vg_foam_mesh(const char *name, struct vg_foam_lists *l,
                       struct vg_mesh *m, uint32_t **cell,
                       struct vg_error *err);

#endif
