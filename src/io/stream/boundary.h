/* io/stream/boundary.h: boundary faces in the order in which some formats list
 * them. */
#ifndef VG_IO_STREAM_BOUNDARY_H
#define VG_IO_STREAM_BOUNDARY_H

#include <stddef.h>

#include "core/mesh/mesh.h"

/** Sort the boundary faces by patch: (*order)[(*start)[p]] up to, excluding,
 * (*order)[(*start)[p + 1]] are those of patch p, in their order in m;
 * triangles are numbered first, quadrilaterals from n_tri on. The caller frees
 * both. O(n). VG_ERR_MEMORY on refusal. */
vg_status vg_boundary_by_patch(const struct vg_mesh *m, size_t **start,
                               size_t **order, struct vg_error *err);

#endif
