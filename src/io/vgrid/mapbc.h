/* io/vgrid/mapbc.h: boundary conditions per patch, both layouts of .mapbc,
 * USM3D's and FUN3D's (formats.md 1.4 and 1.5), and the translation of codes.
 */
#ifndef VG_IO_VGRID_MAPBC_H
#define VG_IO_VGRID_MAPBC_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

enum vg_mapbc_layout { VG_MAPBC_VGRID, VG_MAPBC_FUN3D };

struct vg_mapbc {
  enum vg_mapbc_layout layout;
  size_t n;
  struct vg_patch *entry; /* [n] in file order; both codes are set, the one
                             that the layout lacks by translation */
};
#define VG_MAPBC_INIT                                                          \
  {                                                                            \
    VG_MAPBC_VGRID, 0, NULL                                                    \
  } /* release is a no-op */

struct vg_mapbc_match {
  size_t n_missing;      /* patches of the mesh without an entry */
  int32_t first_missing; /* patch number of the first */
  size_t n_unused;       /* entries that no face of the mesh uses */
  int32_t first_unused;
};

/** Read either layout, told apart by content: FUN3D's starts with the number
 * of lines that follow. *out is untouched on failure. A patch that is listed
 * twice with different codes is VG_ERR_INPUT. */
vg_status vg_mapbc_read(const char *path, struct vg_mapbc *out,
                        struct vg_error *err);
vg_status vg_mapbc_parse(struct vg_input *in, struct vg_mapbc *out,
                         struct vg_error *err);

/** 1 when Vanguard wrote the file next to a mesh (vg_mapbc_write_output): of a
 * surface it is no input. 0 also when it cannot be read. */
int vg_mapbc_is_output(const char *path);

void vg_mapbc_release(struct vg_mapbc *b);

/** Give the patches of m their codes and names. Patches without an entry
 * keep what they have. `match` may be NULL. A symmetry plane of USM3D becomes
 * FUN3D's 6661, 6662 or 6663 by the axis that its faces are normal to. */
vg_status vg_mapbc_apply(const struct vg_mapbc *b, struct vg_mesh *m,
                         struct vg_mapbc_match *match, struct vg_error *err);

/** Write the patches of m. White space in names becomes '_', an empty name
 * patch_ID.
 * @param title    first line of the VGRID layout; NULL: "vanguard"
 * @param n_unset  out, may be NULL: patches that have neither code; they are
 *                 written as inviscid walls (5, FUN3D 3000), which a caller
 *                 should report */
vg_status vg_mapbc_write(const char *path, const struct vg_mesh *m,
                         enum vg_mapbc_layout layout, const char *title,
                         size_t *n_unset, struct vg_error *err);

/** vg_mapbc_write in the VGRID layout, with a mark at the end of the title by
 * which vg_mapbc_is_output knows the file. Solvers ignore the title. */
vg_status vg_mapbc_write_output(const char *path, const struct vg_mesh *m,
                                const char *title, size_t *n_unset,
                                struct vg_error *err);

/** Codes of the other solver; a code without a counterpart is returned as it
 * is, VG_BC_NONE for VG_BC_NONE.
 * @param axis  0 x, 1 y, 2 z: what a symmetry plane is normal to; < 0: code 1
 *              is a slip wall, which FUN3D has as 3000 */
int32_t vg_bc_to_fun3d(int32_t usm3d, int axis);
int32_t vg_bc_to_usm3d(int32_t fun3d);

/** Axis that all faces of each patch are normal to, -1 where there is none.
 * @param axis  out: [n_patch] */
vg_status vg_patch_axes(const struct vg_mesh *m, int *axis,
                        struct vg_error *err);

#endif
