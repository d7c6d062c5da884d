/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/sol.h: Medit's solution files, .sol (text) and .solb (binary,
 * versions 1 to 4): values at the vertices of the mesh of the same name (the
 * GMF of libMeshb). One scalar or one symmetric tensor per vertex is read. */
#ifndef VG_IO_MESH_SOL_H
#define VG_IO_MESH_SOL_H

#include "io/stream/stream.h"

/** Read SolAtVertices.
 *
 * @param n           out: number of vertices
 * @param components  out: 1 for scalars (kind 1), 6 for tensors (kind 3), in
 *                    the order of the file: Medit's is xx, xy, yy, xz, yz, zz
 * @param value       out: [n][components], scalars finite; to be freed. All
 *                    are unchanged on failure
 * VG_ERR_FORMAT; VG_ERR_UNSUPPORTED for anything else. */
vg_status vg_sol_parse(struct vg_input *in, size_t *n, int *components,
                       double **value, struct vg_error *err);
vg_status vg_sol_read(const char *path, size_t *n, int *components,
                      double **value, struct vg_error *err);

/** Write metrics at vertices: text or, if the path ends in ".solb",
 * little-endian binary of version 2 (3 above 2 GB).
 *
 * @param metric  [n] as in core/geometry/tensor.h */
vg_status vg_sol_write(const char *path, size_t n, const double (*metric)[6],
                       struct vg_error *err);

#endif
