/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/picture/decimate.h: reduces the number of triangles of a surface for
 * display. Uses core/mesh/mesh.h. */
#ifndef VG_RUN_PICTURE_DECIMATE_H
#define VG_RUN_PICTURE_DECIMATE_H

#include "core/mesh/mesh.h"

struct vg_decimated {
  size_t n_point, n_tri;
  double (*point)[3]; /* [n_point] coordinates. */
  uint32_t (*tri)[3]; /* [n_tri] in the order of the surface. */
  uint32_t *from;     /* [n_tri] triangle of the surface. */
  double step;        /* Edge length of the cubes; 0: nothing was merged. */
};
#define VG_DECIMATED_INIT                                                      \
  {                                                                            \
    .n_point = 0                                                               \
  }

/** Merges the points in each cube of a lattice into one, at their mean;
 * triangles that lose an edge are removed. The lattice is coarsened until at
 * most n_most triangles are left; a surface with no more than that is
 * unchanged. Cost: O(n) for each of the few lattices tried. VG_ERR_MEMORY. */
vg_status vg_decimate(const struct vg_mesh *m, size_t n_most,
                      struct vg_decimated *out, struct vg_error *err);

void vg_decimated_release(struct vg_decimated *c);

#endif
