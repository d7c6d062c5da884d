/* io/mesh/sol.h: Medit's solution files, .sol (text) and .solb (binary,
 * versions 1 to 4): numbers at the vertices of the mesh that stands beside
 * (the GMF of libMeshb). One scalar per vertex is read. */
#ifndef VG_IO_MESH_SOL_H
#define VG_IO_MESH_SOL_H

#include "io/stream/stream.h"

/** The scalars of SolAtVertices.
 *
 * @param n      out: vertices
 * @param value  out: [n], finite; to be freed. Untouched on failure
 * VG_ERR_FORMAT; VG_ERR_UNSUPPORTED for anything but one scalar. */
vg_status vg_sol_parse(struct vg_input *in, size_t *n, double **value,
                       struct vg_error *err);
vg_status vg_sol_read(const char *path, size_t *n, double **value,
                      struct vg_error *err);

#endif
