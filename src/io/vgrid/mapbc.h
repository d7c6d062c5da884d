/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/vgrid/mapbc.h: boundary conditions of patches in both layouts of .mapbc,
 * that of USM3D and that of FUN3D (formats.md 1.4 and 1.5), and the translation
 * of their codes. */
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
  } /* releasing this is a no-op */

struct vg_mapbc_match {
  size_t n_missing;      /* patches of the mesh without an entry */
  int32_t first_missing; /* id of the first such patch */
  size_t n_unused;       /* entries without a patch in the mesh */
  int32_t first_unused;
  size_t n_renamed; /* patches that got another name by their number, as none of
                       the names in the file is one of the mesh */
  int32_t first_renamed;
};

/** Read either layout. They are distinguished by their content: FUN3D's starts
 * with the number of lines that follow. *out is unchanged on failure.
 * VG_ERR_INPUT if a patch is listed twice with different codes. */
vg_status vg_mapbc_read(const char *path, struct vg_mapbc *out,
                        struct vg_error *err);
vg_status vg_mapbc_parse(struct vg_input *in, struct vg_mapbc *out,
                         struct vg_error *err);

/** *is: 1 if Vanguard has written the file next to a mesh
 * (vg_mapbc_write_output). Such a file is not an input of a surface. 0 also if
 * there is no file. VG_ERR_IO, VG_ERR_MEMORY: the file cannot be read. */
vg_status vg_mapbc_is_output(const char *path, int *is, struct vg_error *err);

void vg_mapbc_release(struct vg_mapbc *b);

/** Set codes and names of the patches of m. Patches without an entry are not
 * changed. `match` may be NULL. A symmetry plane of USM3D becomes FUN3D's 6661,
 * 6662 or 6663, depending on the axis that its faces are normal to. */
vg_status vg_mapbc_apply(const struct vg_mapbc *b, struct vg_mesh *m,
                         struct vg_mapbc_match *match, struct vg_error *err);

/** As vg_mapbc_apply, for a mesh whose patches have names, but numbers only by
 * their order. Entries are matched by name: as vg_mapbc_write writes it, or as
 * a word of vg_patch_words. A patch or an entry without a name is matched by
 * number, and so are several entries with the same name; and all of them, if
 * no entry has the name of a patch, so that the file gives other names.
 * @param path  the .mapbc, for messages
 * @param most  maximum length of a word
 * VG_ERR_INPUT, and m is unchanged: the entry with the number of a patch has
 * another name, and neither the patch has an entry nor the entry a patch of the
 * same name; or entries with the same name have different codes. */
vg_status vg_mapbc_apply_names(const char *path, const struct vg_mapbc *b,
                               size_t most, struct vg_mesh *m,
                               struct vg_mapbc_match *match,
                               struct vg_error *err);

/** Write the patches of m. White space in names becomes '_', an empty name
 * patch_ID.
 * @param title    first line of the VGRID layout; NULL: "vanguard"
 * @param n_unset  out, may be NULL: number of patches without either code; they
 *                 are written as inviscid walls (5, FUN3D 3000), which the
 *                 caller should report */
vg_status vg_mapbc_write(const char *path, const struct vg_mesh *m,
                         enum vg_mapbc_layout layout, const char *title,
                         size_t *n_unset, struct vg_error *err);

/** As vg_mapbc_write in the VGRID layout, with a mark at the end of the title
 * by which vg_mapbc_is_output recognises the file. Solvers ignore the title. */
vg_status vg_mapbc_write_output(const char *path, const struct vg_mesh *m,
                                const char *title, size_t *n_unset,
                                struct vg_error *err);

/** Translate a code for the other solver. A code without a counterpart is
 * returned unchanged, and VG_BC_NONE gives VG_BC_NONE.
 * @param axis  axis that a symmetry plane is normal to: 0 x, 1 y, 2 z; < 0:
 *              code 1 is a slip wall, FUN3D's 3000 */
int32_t vg_bc_to_fun3d(int32_t usm3d, int axis);
int32_t vg_bc_to_usm3d(int32_t fun3d);

/** Find the axis that all faces of each patch are normal to; -1 if there is
 * none.
 * @param axis  out: [n_patch] */
vg_status vg_patch_axes(const struct vg_mesh *m, int *axis,
                        struct vg_error *err);

#endif
