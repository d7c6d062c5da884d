/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/vtu_read.h: reads the points and cells of a VTK file with values at
 * the points or in the cells (.vtu, .vtp: VTK's XML, in one piece), the format
 * in which solvers export their results. Text, base64 or raw, of either byte
 * order, uncompressed or compressed by zlib. */
#ifndef VG_IO_MESH_VTU_READ_H
#define VG_IO_MESH_VTU_READ_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Is there an array `name` in a section, "PointData" or "CellData"? 0 for a
 * damaged file, too. */
int vg_vtu_has_array(struct vg_input *in, const char *section,
                     const char *name);

/** Write the names of the arrays of a section, "PointData" or "CellData", to
 * out, separated by ", "; the list ends in "..." if it is too long. A section
 * without arrays gives an empty list. */
void vg_vtu_array_names(struct vg_input *in, const char *section, char *out,
                        size_t size);

/** Read the points, the cells and faces of first order (tetrahedra, pyramids,
 * wedges, hexahedra, triangles, quadrilaterals; all others are skipped) and the
 * array `name` of a section, "PointData" or "CellData".
 *
 * @param out         empty before; points, cells and faces without patches
 * @param components  out: number of values per point or cell, 1 to 9
 * @param value       out: [n][components], which need not be finite; to be
 *                    freed. n: points, or cells in the order tetrahedra,
 *                    pyramids, prisms, hexahedra. All are unchanged on failure
 * VG_ERR_FORMAT: damaged, or there is no such array; VG_ERR_UNSUPPORTED:
 * several pieces, another compression, or values that are neither Float32 nor
 * Float64. */
vg_status vg_vtu_values_parse(struct vg_input *in, const char *section,
                              const char *name, struct vg_mesh *out,
                              int *components, double **value,
                              struct vg_error *err);

#endif
