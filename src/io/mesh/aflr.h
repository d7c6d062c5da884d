/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/mesh/aflr.h: surfaces and layer settings of AFLR3: .surf, .tags and AFLR's
 * .bc (formats.md 2.5 and 2.6). All are text; 1-based. */
#ifndef VG_IO_MESH_AFLR_H
#define VG_IO_MESH_AFLR_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** Grid-BC flag of a face for which the file gives none. */
#define VG_AFLR_NONE INT32_MIN

/** Settings of one patch. Values that the file does not give are 0, and flag is
 * VG_AFLR_NONE. The patch is identified by id in .surf and .tags, by name in
 * .tags and .bc.
 *
 * Grid-BC flags of AFLR3: 1 standard surface, farfield or inviscid wall; 0
 * plain; 2 cuts the layers (such as a symmetry plane); 3 source surface; 4, 5,
 * 6 transparent; 7 fixed; negative: layers grow on it. */
struct vg_aflr_patch {
  int32_t id;             /* 0 in a .bc, which contains names only */
  char name[VG_NAME_MAX]; /* "" in a .surf */
  int32_t flag;   /* grid BC; a .tags has properties instead, of which the last
                     in a line counts */
  int is_viscous; /* layers grow here */
  double spacing; /* first height; 0: not given. In a .surf it is set if all
                     points of the patch have the same value */
  double thickness; /* total layer thickness; as spacing */
  int32_t n_layer;  /* number of layers; 0: not given */
};

struct vg_aflr {
  size_t n;
  struct vg_aflr_patch *patch; /* [n] entries: in a .surf one per patch of
                                  the mesh, in the order of its patches;
                                  otherwise in file order */
  size_t n_point;
  double *spacing;   /* [n_point] for a .surf with 4 or more columns, else
                        NULL; 0 or less: not given at this point */
  double *thickness; /* [n_point] for a .surf with 5 columns, else NULL */
};
#define VG_AFLR_INIT                                                           \
  {                                                                            \
    .n = 0                                                                     \
  } /* releasing this is a no-op */

void vg_aflr_release(struct vg_aflr *a);

/** Read a surface. Tags become patch ids; patches are sorted by id. The flag of
 * a patch determines its boundary condition: negative is a viscous wall (4,
 * 4000); 1 is a farfield (3, 5000; AFLR3 also uses it for inviscid walls, which
 * need a .mapbc); others give none. If the faces of a patch have different
 * flags, the most frequent one counts, in case of a tie the lowest. Columns
 * after the tag may be missing.
 * @param a  may be NULL; both outputs are unchanged on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT (index out of range, value not
 * finite) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_aflr_surf_read(const char *path, struct vg_mesh *m,
                            struct vg_aflr *a, struct vg_error *err);
vg_status vg_aflr_surf_parse(struct vg_input *in, struct vg_mesh *m,
                             struct vg_aflr *a, struct vg_error *err);

/** Read a .tags with lines 'id group visc recon rebuild fixed source trans
 * delete spacing thickness layers'. Older files lack `layers`, or both `layers`
 * and `fixed`. VG_ERR_INPUT if an id is listed twice. */
vg_status vg_aflr_tags_read(const char *path, struct vg_aflr *a,
                            struct vg_error *err);
vg_status vg_aflr_tags_parse(struct vg_input *in, struct vg_aflr *a,
                             struct vg_error *err);

/** Read an AFLR .bc with lines 'name flag [spacing [thickness]]'. A VGRID .bc,
 * whose first line is four integers, gives VG_ERR_FORMAT; vg_aflr_is_bc detects
 * this in advance. VG_ERR_INPUT if a name is listed twice. */
vg_status vg_aflr_bc_read(const char *path, struct vg_aflr *a,
                          struct vg_error *err);
vg_status vg_aflr_bc_parse(struct vg_input *in, struct vg_aflr *a,
                           struct vg_error *err);

/** Returns 1 if the file is text and its first entry is not a line of four
 * integers. */
int vg_aflr_is_bc(const char *path);

/** Apply the settings of a .tags (by id) or a .bc (by name) to the patches of
 * m. A patch without a name gets that of the file, and a patch on which layers
 * grow becomes a viscous wall (4, 4000). A viscous wall on which they do not
 * grow becomes inviscid (5, 3000). Patches that are not listed are not changed.
 * @param n_unused  out, may be NULL: number of entries for which m has no
 * patch */
vg_status vg_aflr_apply(const struct vg_aflr *a, struct vg_mesh *m,
                        size_t *n_unused, struct vg_error *err);

#endif
