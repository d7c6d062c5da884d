/* io/mesh/obj.h: Wavefront OBJ surfaces (formats.md 3.3). 1-based text,
 * negative indices count back from the last vertex; faces point out of the
 * solid, hence into the fluid: kept as they are. */
#ifndef VG_IO_MESH_OBJ_H
#define VG_IO_MESH_OBJ_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Read a surface; gzip'd input is accepted.
 *
 * `v` and `f` (corners a, a/t, a//n, a/t/n) are read, polygons become a fan
 * about their first corner, `g` and `o` name patches (equal names are one
 * patch; a group without faces is none), other lines are skipped.
 * @param out  untouched on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT (index out of range,
 * coordinate not finite) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_obj_read(const char *path, struct vg_mesh *out,
                      struct vg_error *err);

/** vg_obj_read from bytes in memory. */
vg_status vg_obj_parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err);

/** Write the boundary, one group per patch; quadrilaterals stay. Patches
 * without a name are called patch_ID. */
vg_status vg_obj_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err);

#endif
