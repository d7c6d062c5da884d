/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/accuracy/volumes.h: control volumes around points or of cells, in one
 * form, so that a scheme is written once. Private to core/accuracy. */
#ifndef VG_CORE_ACCURACY_VOLUMES_H
#define VG_CORE_ACCURACY_VOLUMES_H

#include "core/accuracy/accuracy.h"
#include "core/mesh/cell_links.h"

/** Control volumes, their common faces and their faces on the boundary. */
struct vg_volumes {
  enum vg_unknowns in;
  size_t n, n_face, n_border;
  double (*x)[3]; /* [n] positions of the unknowns */
  double *volume; /* [n] */
  size_t room[3]; /* of the arrays of faces */
  /* Common faces: both volumes, area vector from the first to the second, and
   * weight of the second one in the linear interpolation. */
  uint32_t (*side)[2];
  double (*area)[3], *weight;
  /* Faces on the boundary: their volume, area vector out of it, and the centre
   * (cells) or the points with the owner first (nodes; VG_NO_CELL: triangle).
   */
  uint32_t *owner;
  double (*out)[3], (*at)[3];
  uint32_t (*corner)[4];
  /* Faces at a volume i: entry[first[i]] .. entry[first[i + 1] - 1]; 2 f + k
   * for side k of face f, 2 n_face + b for face b on the boundary. */
  size_t *first; /* [n + 1] */
  uint32_t *entry;
};
#define VG_VOLUMES_INIT                                                        \
  {                                                                            \
    .n = 0                                                                     \
  }

/** The median dual of a mesh: centres are means of corners. Release also after
 * a failure, as for the next function. VG_ERR_MEMORY, VG_ERR_UNSUPPORTED. */
vg_status vg_volumes_dual(struct vg_volumes *v, const struct vg_cell_links *l,
                          struct vg_error *err);

/** The cells of a mesh, with centres as in OpenFOAM. */
vg_status vg_volumes_cells(struct vg_volumes *v, const struct vg_cell_links *l,
                           struct vg_error *err);

void vg_volumes_release(struct vg_volumes *v);

/** Nodes of a cell of any kind. Returns their number. */
int vg_volume_nodes(const struct vg_cell_links *l, uint32_t cell,
                    const uint32_t **node);

#endif
