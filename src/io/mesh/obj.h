/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/obj.h: Wavefront OBJ surfaces (formats.md 3.3). 1-based text;
 * negative indices count back from the last vertex. Faces point out of the
 * solid, which is into the fluid: their orientation is kept. */
#ifndef VG_IO_MESH_OBJ_H
#define VG_IO_MESH_OBJ_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Read a surface; gzip'd input is accepted.
 *
 * `v` and `f` (corners a, a/t, a//n, a/t/n) are read. Polygons become triangles
 * around their first corner. `g` and `o` give the names of patches; equal names
 * are one patch, and groups without faces are ignored. Other lines are skipped.
 * @param out  unchanged on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT (index out of range,
 * coordinate not finite) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_obj_read(const char *path, struct vg_mesh *out,
                      struct vg_error *err);

/** vg_obj_read from bytes in memory. */
vg_status vg_obj_parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err);

/** Write the boundary with one group per patch; quadrilaterals are kept.
 * Patches without a name are called patch_ID. */
vg_status vg_obj_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err);

#endif
