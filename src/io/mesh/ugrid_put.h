/* io/mesh/ugrid_put.h: the parts of a .ugrid file, for its writer and for that
 * of meshes in slices, which has them written by all ranks
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_MESH_UGRID_PUT_H
#define VG_IO_MESH_UGRID_PUT_H

#include "core/mesh/mesh.h"
#include "io/mesh/ugrid.h"
#include "io/stream/narrow.h"
#include "io/stream/stream.h"

/** VG_ERR_UNSUPPORTED: counts beyond the kind's integers; VG_ERR_INPUT: more
 * layer tetrahedra than there are. n_layer_tet NULL: no tail. */
vg_status vg_ugrid_check(const char *path, const struct vg_ugrid_kind *kind,
                         const struct vg_mesh *m, const size_t *n_layer_tet,
                         struct vg_error *err);

/** Is what rounding to the kind's reals left of a mesh fit for a file? */
vg_status vg_ugrid_accept(const struct vg_ugrid_kind *kind,
                          const struct vg_narrow *n, struct vg_error *err);

/** A mesh, or a frame of a binary kind. */
void vg_ugrid_put(struct vg_output *out, const struct vg_ugrid_kind *kind,
                  const struct vg_mesh *m, const size_t *n_layer_tet);

/** Go to an item of a binary file. item: as in the header, 0 points, 3
 * tetrahedra, 4 pyramids, 5 prisms. */
void vg_ugrid_seek(struct vg_output *out, const struct vg_ugrid_kind *kind,
                   const uint64_t count[7], int item, uint64_t first);

/** n numbers of points, 0-based; NULL: skipped. */
void vg_ugrid_put_nodes(struct vg_output *out, const struct vg_ugrid_kind *kind,
                        size_t n, const uint32_t *node);
void vg_ugrid_put_points(struct vg_output *out,
                         const struct vg_ugrid_kind *kind, size_t n,
                         const double (*x)[3]);

#endif
