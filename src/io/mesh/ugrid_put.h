/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/ugrid_put.h: functions that write parts of a .ugrid file, for the
 * serial writer and for the writer of slices, in which all ranks write
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_UGRID_PUT_H
#define VG_IO_MESH_UGRID_PUT_H

#include "core/mesh/mesh.h"
#include "io/mesh/ugrid.h"
#include "io/stream/narrow.h"
#include "io/stream/stream.h"

/** Check the counts. VG_ERR_UNSUPPORTED: they exceed the integers of the kind;
 * VG_ERR_INPUT: more layer tetrahedra than tetrahedra. n_layer_tet NULL: no
 * tail. */
vg_status vg_ugrid_check(const char *path, const struct vg_ugrid_kind *kind,
                         const struct vg_mesh *m, const size_t *n_layer_tet,
                         struct vg_error *err);

/** VG_ERR_GEOMETRY if rounding to the reals of this kind damages the mesh. */
vg_status vg_ugrid_accept(const struct vg_ugrid_kind *kind,
                          const struct vg_narrow *n, struct vg_error *err);

/** Write a mesh, or a frame of a binary kind. */
void vg_ugrid_put(struct vg_output *out, const struct vg_ugrid_kind *kind,
                  const struct vg_mesh *m, const size_t *n_layer_tet);

/** Move to an element of a binary file. item: as in the header, 0 points, 3
 * tetrahedra, 4 pyramids, 5 prisms, 6 hexahedra. */
void vg_ugrid_seek(struct vg_output *out, const struct vg_ugrid_kind *kind,
                   const uint64_t count[7], int item, uint64_t first);

/** Write n point numbers, given 0-based; NULL: skip them. */
void vg_ugrid_put_nodes(struct vg_output *out, const struct vg_ugrid_kind *kind,
                        size_t n, const uint32_t *node);
void vg_ugrid_put_points(struct vg_output *out,
                         const struct vg_ugrid_kind *kind, size_t n,
                         const double (*x)[3]);

#endif
