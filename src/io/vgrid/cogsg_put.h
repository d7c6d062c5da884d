/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/vgrid/cogsg_put.h: functions that write parts of .cogsg and .bc files, for
 * the serial writer and for the writer of slices, in which all ranks write
 * (io/slices/slices_parts.h). */
#ifndef VG_IO_VGRID_COGSG_PUT_H
#define VG_IO_VGRID_COGSG_PUT_H

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"
#include "io/vgrid/vgrid.h"

vg_status vg_cogsg_check(const char *stem, const struct vg_mesh *m,
                         const struct vg_cogsg_info *info,
                         struct vg_error *err);

/** Write the .cogsg of a mesh, or only its frame. new_to_old and old_to_new are
 * the orders of vg_vgrid_order, or NULL. */
void vg_cogsg_put(struct vg_output *out, const struct vg_mesh *m,
                  const struct vg_cogsg_info *info, const uint32_t *new_to_old,
                  const uint32_t *old_to_new);

/** Write the content of the .bc. */
void vg_cogsg_put_faces(struct vg_output *out, const struct vg_mesh *m,
                        const struct vg_cogsg_info *info,
                        const uint32_t *old_to_new);

/** Write STEM.mapbc next to a .cogsg; m has the points of its triangles. */
vg_status vg_cogsg_write_mapbc(const char *stem, const struct vg_mesh *m,
                               size_t *n_unset, struct vg_error *err);

/** Move to cell or point `first` in a column: the record of the cells has four
 * columns, one per node, that of the points three. */
enum vg_cogsg_part { VG_COGSG_CELLS, VG_COGSG_POINTS };
void vg_cogsg_seek(struct vg_output *out, uint64_t n_tet, uint64_t n_point,
                   enum vg_cogsg_part part, int column, uint64_t first);

#endif
