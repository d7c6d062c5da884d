/* io/mesh/vtu_read.h: the points of a VTK file (.vtu, .vtp: VTK's XML, in one
 * piece) with a number at each; what a solver's results are exported as. Text,
 * base64 or raw, of either byte order, plain or packed by zlib. */
#ifndef VG_IO_MESH_VTU_READ_H
#define VG_IO_MESH_VTU_READ_H

#include "io/stream/stream.h"

/** Points and the scalar point array `name`.
 *
 * @param n      out: points, at least one
 * @param x      out: [n], finite; to be freed
 * @param value  out: [n], finite; to be freed. All untouched on failure
 * VG_ERR_FORMAT: damaged, or no such array; VG_ERR_UNSUPPORTED: several
 * pieces, another packing, or numbers that are neither Float32 nor Float64. */
vg_status vg_vtu_points_parse(struct vg_input *in, const char *name, size_t *n,
                              double (**x)[3], double **value,
                              struct vg_error *err);
vg_status vg_vtu_points_read(const char *path, const char *name, size_t *n,
                             double (**x)[3], double **value,
                             struct vg_error *err);

#endif
