/* io/vgrid/cogsg_put.h: the parts of .cogsg and .bc files, for their writer and
 * for that of meshes in slices, which has them written by all ranks
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_VGRID_COGSG_PUT_H
#define VG_IO_VGRID_COGSG_PUT_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"
#include "io/vgrid/vgrid.h"

vg_status vg_cogsg_check(const char *stem, const struct vg_mesh *m,
                         const struct vg_cogsg_info *info,
                         struct vg_error *err);

/** A mesh, or a frame; the orders of vg_vgrid_order, or NULL. */
void vg_cogsg_put(struct vg_output *out, const struct vg_mesh *m,
                  const struct vg_cogsg_info *info, const uint32_t *new_to_old,
                  const uint32_t *old_to_new);

/** Content of the .bc. */
void vg_cogsg_put_faces(struct vg_output *out, const struct vg_mesh *m,
                        const struct vg_cogsg_info *info,
                        const uint32_t *old_to_new);

/** STEM.mapbc beside a .cogsg; m has the points of its triangles. */
vg_status vg_cogsg_write_mapbc(const char *stem, const struct vg_mesh *m,
                               size_t *n_unset, struct vg_error *err);

/** Go to a cell or a point in one of its four or three columns. */
enum vg_cogsg_part { VG_COGSG_CELLS, VG_COGSG_POINTS };
void vg_cogsg_seek(struct vg_output *out, uint64_t n_tet, uint64_t n_point,
                   enum vg_cogsg_part part, int column, uint64_t first);

#endif
