/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/sol.h: Medit's solution files, .sol (text) and .solb (binary,
 * versions 1 to 4): values at the vertices of the mesh of the same name (the
 * GMF of libMeshb). One scalar per vertex is read. */
#ifndef VG_IO_MESH_SOL_H
#define VG_IO_MESH_SOL_H

#include "io/stream/stream.h"

/** Read the scalars of SolAtVertices.
 *
 * @param n      out: number of vertices
 * @param value  out: [n], finite; to be freed. Unchanged on failure
 * VG_ERR_FORMAT; VG_ERR_UNSUPPORTED for anything but one scalar. */
vg_status vg_sol_parse(struct vg_input *in, size_t *n, double **value,
                       struct vg_error *err);
vg_status vg_sol_read(const char *path, size_t *n, double **value,
                      struct vg_error *err);

#endif
