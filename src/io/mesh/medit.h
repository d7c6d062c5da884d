/* io/mesh/medit.h: Medit / GMF .mesh (text) and .meshb (binary, versions 1 to
 * 4, either byte order; formats.md 4.6). 1-based. References of boundary faces
 * are patch ids. Pyramids have ring 1 2 3 4 and apex 5 in the file. */
#ifndef VG_IO_MESH_MEDIT_H
#define VG_IO_MESH_MEDIT_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Read a surface or a volume mesh; gzip'd input is accepted; text or binary
 * is found from the content.
 *
 * Orientation: cells are made positive and boundary faces turned into their
 * cell (vg_mesh_turn); a file without cells is kept as it is. Corners,
 * ridges, edges, required entities and unknown keywords are skipped. Points
 * that no face or cell uses are kept.
 * @param out  untouched on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT, VG_ERR_UNSUPPORTED
 * (dimension 2) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_medit_read(const char *path, struct vg_mesh *out,
                        struct vg_error *err);

/** vg_medit_read from bytes in memory. */
vg_status vg_medit_parse(struct vg_input *in, struct vg_mesh *out,
                         struct vg_error *err);

/** Write text or, when the path ends in ".meshb", little-endian binary:
 * version 2, or where the file passes 2 GB version 3 (4 if counts need it).
 * Nameless format: patch names are lost. */
vg_status vg_medit_write(const char *path, const struct vg_mesh *m,
                         struct vg_error *err);

/** Binary of a given version 1..4 (1: single precision) and byte order.
 * VG_ERR_UNSUPPORTED when the version cannot hold the mesh. */
vg_status vg_medit_write_binary(const char *path, const struct vg_mesh *m,
                                int version, int big_endian,
                                struct vg_error *err);

#endif
