/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/boundary.h: boundary faces sorted by patch, as some formats list
 * them. */
#ifndef VG_IO_STREAM_BOUNDARY_H
#define VG_IO_STREAM_BOUNDARY_H

#include <stddef.h>

#include "core/mesh/mesh.h"

/** Sort the boundary faces by patch. The faces of patch p, in their order in m,
 * are (*order)[i] with (*start)[p] <= i < (*start)[p + 1]. Triangles are
 * numbered first, quadrilaterals from n_tri on. The caller frees both arrays.
 * O(n). VG_ERR_MEMORY if there is not enough memory. */
vg_status vg_boundary_by_patch(const struct vg_mesh *m, size_t **start,
                               size_t **order, struct vg_error *err);

#endif
