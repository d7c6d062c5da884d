/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/hessian/hessian.h: second derivatives of a solution that is given at the
 * points of a mesh. Uses base, core/mesh and core/geometry.
 *
 * Two projections in L2 with a lumped mass matrix (Alauzet and Loseille,
 * Comput. Fluids 39, 2010): the gradient at a point is the mean of the
 * gradients of its cells, weighted by their volumes, and the Hessian is the
 * gradient of that gradient, made symmetric.
 *
 *       .------.------.         o  point
 *       | \  g1|g2  / |         g  gradient of a cell
 *       |g6 \  | /  g3|
 *       .------o------.   gradient at o = sum(V g) / sum(V)
 *       |g5 /  | \ g4 |
 *
 * On the boundary the mean is one-sided. Points there, and their neighbours,
 * take the mean of the Hessians of their neighbours inside. */
#ifndef VG_CORE_HESSIAN_HESSIAN_H
#define VG_CORE_HESSIAN_HESSIAN_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"

/** The part of a mesh on which errors are estimated. */
struct vg_estimate {
  const struct vg_mesh *m; /* borrowed */
  int n_kind;              /* kinds of cells in it, from VG_SLICE_TET on */
  size_t first_tet;        /* the first tetrahedra may be layers */
  size_t n_left_out;       /* cells that are not in it */
  double *volume;          /* [n_point] volume of the cells in it at each
                              point, shared among their corners */
  uint8_t *ring;           /* [n_point] 0: at its boundary, or not in it; 1: has
                              a neighbour there; 2: further inside */
  size_t n_edge;
  uint32_t (*edge)[2]; /* [n_edge] edges of all cells of m */
};
#define VG_ESTIMATE_INIT                                                       \
  {                                                                            \
    .m = NULL                                                                  \
  }

/** Prepare a mesh. Layers are left out, since a mesher grows them again
 * whatever the metric: the first n_layer tetrahedra and, if there are others,
 * all cells of other kinds.
 *
 * VG_ERR_INPUT: no cells, or no point off the boundary; VG_ERR_UNSUPPORTED: too
 * many cells; VG_ERR_MEMORY. Threads: re-entrant, as all functions here. */
vg_status vg_estimate_open(struct vg_estimate *e, const struct vg_mesh *m,
                           size_t n_layer, struct vg_error *err);
void vg_estimate_release(struct vg_estimate *e);

/** The Hessian at each point.
 *
 * @param value    [n_point] finite
 * @param hessian  out: [n_point] as in core/geometry/tensor.h. Exact for
 *                 polynomials of degree 1 everywhere. Zero at points that no
 *                 path of edges joins to the part
 *
 * + - * / only: the same bits on all processors. VG_ERR_MEMORY. */
vg_status vg_hessian(const struct vg_estimate *e, const double *value,
                     double (*hessian)[6], struct vg_error *err);

#endif
