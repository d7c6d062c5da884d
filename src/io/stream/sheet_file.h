/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/sheet_file.h: STEM.sheets, the sheets and zones of a mesh whose
 * format has neither. Text:
 *
 *   # Vanguard sheets 1
 *   mesh 1234 5678        points and cells of the mesh
 *   zone 1 fluid 5600 0 78 0 outer      number, kind, tetrahedra, pyramids,
 *                         prisms and hexahedra, name up to the end of the line;
 *                         cells of each kind are in the order of their zones
 *   sheet 7 2 disk        number, triangles, name up to the end of the line;
 *                         interface instead of sheet if it separates zones
 *   12 45 46              points of each triangle, from 1
 *   12 46 13
 *
 * Lines that begin with # are comments. Uses core/mesh/sheets.h. */
#ifndef VG_IO_STREAM_SHEET_FILE_H
#define VG_IO_STREAM_SHEET_FILE_H

#include "core/mesh/mesh.h"

#define VG_SHEET_SUFFIX "sheets"

/** Write the sheets and zones of m, which has n_point points and n_cell cells;
 * other members of m are not used. VG_ERR_IO, VG_ERR_MEMORY. */
vg_status vg_sheet_file_write(const char *path, const struct vg_mesh *m,
                              uint64_t n_point, uint64_t n_cell,
                              struct vg_error *err);

/** Append the triangles in the file to the boundary of m, with a patch for each
 * sheet, which has is_sheet, and its zones to m, which has none. VG_ERR_INPUT
 * if the file belongs to another mesh; VG_ERR_FORMAT, VG_ERR_IO, VG_ERR_MEMORY.
 * m is unchanged on failure. */
vg_status vg_sheet_file_read(const char *path, struct vg_mesh *m,
                             struct vg_error *err);

struct vg_input;
vg_status vg_sheet_file_parse(struct vg_input *in, struct vg_mesh *m,
                              struct vg_error *err);

/** Is there a file that vg_sheet_file_write wrote? */
int vg_sheet_file_is_own(const char *path);

#endif
