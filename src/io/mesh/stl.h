/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/stl.h: STL surfaces, ASCII and binary (formats.md 3.1; the 1989
 * specification of 3D Systems). There are no indices: facets contain
 * coordinates, and points whose bits are equal (-0 as 0) are merged. Normals
 * point out of the solid, which is into the fluid outside: the orientation is
 * kept, and the normals stored in the file are ignored. Binary is
 * little-endian. */
#ifndef VG_IO_MESH_STL_H
#define VG_IO_MESH_STL_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Read a surface; gzip'd input is accepted.
 *
 * Binary and ASCII are distinguished by the size of a binary file (84 + 50 n),
 * since the header of a binary file may begin with "solid". Every `solid` is a
 * patch, numbered from 1, with its name; a binary file is one patch. Facets
 * with two equal corners are kept; vg_surface_check reports them.
 * @param out  in: released or initialised; unchanged on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT (not finite) or VG_ERR_MEMORY.
 * Threads: re-entrant. Cost: O(n). */
vg_status vg_stl_read(const char *path, struct vg_mesh *out,
                      struct vg_error *err);

/** vg_stl_read from bytes in memory. */
vg_status vg_stl_parse(struct vg_input *in, struct vg_mesh *out,
                       struct vg_error *err);

/** Write the boundary of m as ASCII, one solid per patch, with 17 digits, so
 * that reading the file gives bitwise the same points. Quadrilaterals become
 * two triangles (0 1 2, 0 2 3). The file appears complete or not at all. */
vg_status vg_stl_write(const char *path, const struct vg_mesh *m,
                       struct vg_error *err);

/** As vg_stl_write, but binary: coordinates are rounded to single precision,
 * and patches are lost. */
vg_status vg_stl_write_binary(const char *path, const struct vg_mesh *m,
                              struct vg_error *err);

#endif
