/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/tri.h: Cart3D surfaces .tri and .triq (formats.md 3.2). 1-based;
 * triangles point out of the solid, which is into the fluid: their orientation
 * is kept. Text, or Fortran records of either byte order with 4- or 8-byte
 * reals. */
#ifndef VG_IO_MESH_TRI_H
#define VG_IO_MESH_TRI_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Read a surface; gzip'd input is accepted; the variant is recognised by the
 * content. Components become patches, sorted by their numbers; without
 * components there is one patch, 1. Scalars of a .triq are dropped.
 * @param out  unchanged on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT (index out of range,
 * coordinate not finite) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_tri_read(const char *path, struct vg_mesh *out,
                      struct vg_error *err);

/** vg_tri_read from bytes in memory. */
vg_status vg_tri_parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err);

/** Write the boundary as text with components. Quadrilaterals become two
 * triangles. The file appears complete or not at all. */
vg_status vg_tri_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err);

/** Write binary: Fortran records.
 * @param little     little-endian instead of big-endian byte order
 * @param real_size  4 or 8 bytes per coordinate */
vg_status vg_tri_write_binary(const char *path, const struct vg_mesh *m,
                              int little, int real_size, struct vg_error *err);

#endif
