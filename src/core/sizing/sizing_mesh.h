/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_mesh.h: metrics given at the points of a background mesh,
 * as a map for vg_sizing_options. Uses core/sizing/sizing.h. */
#ifndef VG_CORE_SIZING_SIZING_MESH_H
#define VG_CORE_SIZING_SIZING_MESH_H

#include "core/sizing/sizing.h"

/** Order of the components of a symmetric tensor in a file. */
enum vg_tensor_order {
  VG_TENSOR_FILE,  /* the usual one of the format */
  VG_TENSOR_MEDIT, /* lower triangle by rows: xx, xy, yy, xz, yz, zz */
  VG_TENSOR_UPPER, /* upper triangle by rows: xx, xy, xz, yy, yz, zz */
  VG_TENSOR_VTK    /* xx, yy, zz, xy, yz, xz */
};

/** Convert metrics to the order of core/geometry/tensor.h and check them.
 *
 * @param name        of the file, for messages
 * @param x           [n] points
 * @param components  6, or 9 for full tensors by rows, which `order` does not
 *                    concern
 * @param order       not VG_TENSOR_FILE
 * @param value       [n][components]
 * @param out         out: [n]
 *
 * VG_ERR_INPUT names the first point (counted from 1) that is not finite, or
 * whose metric is not finite, not symmetric or not positive. The message says
 * with which other order all metrics would be positive. */
vg_status vg_size_metrics_read(const char *name, size_t n, const double (*x)[3],
                               int components, enum vg_tensor_order order,
                               const double *value, double (*out)[6],
                               struct vg_error *err);

/** Number of metrics whose aspect is above aspect_max. */
size_t vg_size_metrics_beyond(size_t n, const double (*metric)[6],
                              double aspect_max);

struct vg_size_mesh; /* opaque, read-only */

/** Metrics that are interpolated within the cells of a mesh: linear in the size
 * tensor on tetrahedra, into which other cells are divided. Outside of all
 * cells, the size tensor at the nearest point grows with the distance beyond
 * one edge length. Without cells, that of the nearest given point does.
 *
 * @param m       points and cells, copied; its faces are ignored
 * @param metric  [n_point] positive; copied
 * @param growth  rate > 1
 * @param out     release with vg_size_mesh_free
 *
 * Cost: O(n log n); an evaluation O(log n). VG_ERR_MEMORY. */
vg_status vg_size_mesh_new(const struct vg_mesh *m, const double (*metric)[6],
                           double growth, struct vg_size_mesh **out,
                           struct vg_error *err);

/** Accepts NULL. */
void vg_size_mesh_free(struct vg_size_mesh *s);

/** The map of the mesh; valid as long as it is. Threads: safe. */
const struct vg_size_map *vg_size_mesh_map(const struct vg_size_mesh *s);

#endif
