/* run/input/share.h: what the first rank of a node made, for the others of it.
 * Uses base/comm.h, core/mesh/mesh.h. */
#ifndef VG_RUN_INPUT_SHARE_H
#define VG_RUN_INPUT_SHARE_H

#include "base/comm.h"
#include "core/mesh/mesh.h"

/** A boundary of triangles and a number as bytes, and back: the same bit by
 * bit. VG_ERR_MEMORY; VG_ERR_FORMAT for bytes that are none. On failure
 * outputs are untouched; *m is replaced. */
vg_status vg_surface_pack(const struct vg_mesh *m, uint64_t number,
                          struct vg_bytes *out, struct vg_error *err);
vg_status vg_surface_unpack(const struct vg_bytes *bytes, struct vg_mesh *m,
                            uint64_t *number, struct vg_error *err);

#endif
