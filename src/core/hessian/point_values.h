/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/hessian/point_values.h: values at the points of a mesh from values in
 * its cells. Uses base, core/mesh and core/geometry.
 *
 *       .------.------.         c  centre of a cell
 *       |  c   |   c  |         o  point: the linear function that fits the
 *       .------o------.            values at the centres c of its cells best,
 *       |  c   |   c  |            by least squares with weights 1 / |c - o|^2
 *       .------.------.
 *
 * The function is exact for linear solutions, also on the boundary. At points
 * whose centres lie in a plane or on a line (a corner with one cell), it has
 * the mean gradient of the points around them; where these have none either (a
 * mesh one cell thick), the solution is constant across the plane. */
#ifndef VG_CORE_HESSIAN_POINT_VALUES_H
#define VG_CORE_HESSIAN_POINT_VALUES_H

#include "core/mesh/mesh.h"

/** Values at the points.
 *
 * @param cell   [number of cells] in the order tetrahedra, pyramids, prisms,
 *               hexahedra; finite
 * @param point  out: [n_point]; 0 at points without a cell
 *
 * VG_ERR_MEMORY. Threads: re-entrant. Serial: the same bits always. */
vg_status vg_point_values(const struct vg_mesh *m, const double *cell,
                          double *point, struct vg_error *err);

#endif
