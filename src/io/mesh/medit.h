/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/medit.h: Medit / GMF .mesh (text) and .meshb (binary, versions 1 to
 * 4, either byte order; formats.md 4.6). 1-based. References of boundary faces
 * are patch ids. Pyramids have ring 1 2 3 4 and apex 5 in the file. */
#ifndef VG_IO_MESH_MEDIT_H
#define VG_IO_MESH_MEDIT_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Read a surface or a volume mesh; gzip'd input is accepted; text and binary
 * are distinguished by the content.
 *
 * Orientation: the volume of cells is made positive, and boundary faces are
 * turned to point into their cells (vg_mesh_turn); a file without cells is not
 * changed. Corners, ridges, edges, required entities and unknown keywords are
 * skipped. Points that no face or cell uses are kept.
 * @param out  unchanged on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT, VG_ERR_UNSUPPORTED (dimension
 * 2) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_medit_read(const char *path, struct vg_mesh *out,
                        struct vg_error *err);

/** vg_medit_read from bytes in memory. */
vg_status vg_medit_parse(struct vg_input *in, struct vg_mesh *out,
                         struct vg_error *err);

/** Write text or, if the path ends in ".meshb", little-endian binary: version
 * 2, or version 3 for files of more than 2 GB (4 if the counts require it). The
 * format has no names: those of patches are lost. */
vg_status vg_medit_write(const char *path, const struct vg_mesh *m,
                         struct vg_error *err);

/** Write binary of a given version 1 .. 4 (1: single precision) and byte order.
 * VG_ERR_UNSUPPORTED if the version cannot hold the mesh. */
vg_status vg_medit_write_binary(const char *path, const struct vg_mesh *m,
                                int version, int big_endian,
                                struct vg_error *err);

#endif
