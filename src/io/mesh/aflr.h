/* io/mesh/aflr.h: surfaces and layer settings of AFLR3: .surf, .tags and
 * AFLR's .bc (formats.md 2.5 and 2.6). All are text; 1-based. */
#ifndef VG_IO_MESH_AFLR_H
#define VG_IO_MESH_AFLR_H

#include <stddef.h>
#include <stdint.h>

#include "core/mesh/mesh.h"
#include "io/stream/stream.h"

/** The grid-BC flag of a face where the file gives none. */
#define VG_AFLR_NONE INT32_MIN

/** What is said of one patch. What a file leaves open: 0, flag VG_AFLR_NONE.
 * id: of .surf and .tags; name: of .tags and .bc.
 *
 * Grid-BC flags of AFLR3: 1 standard surface, far field or inviscid wall; 0
 * plain; 2 cuts the layers (a symmetry plane, ...); 3 source surface; 4, 5, 6
 * transparent; 7 fixed; a minus: layers grow on it. */
struct vg_aflr_patch {
  int32_t id;             /* 0 in a .bc, which has names only */
  char name[VG_NAME_MAX]; /* "" in a .surf */
  int32_t flag;           /* grid BC; .tags has properties instead, of which
                             the last in a line counts */
  int is_viscous;         /* layers grow here */
  double spacing;         /* first height; 0: not given. In a .surf: where
                             all points of the patch have the same one */
  double thickness;       /* of all layers; as spacing */
  int32_t n_layer;        /* 0: not given */
};

struct vg_aflr {
  size_t n;
  struct vg_aflr_patch *patch; /* [n]; .surf: one per patch of the mesh, in
                                  its order; else in file order */
  size_t n_point;
  double *spacing;   /* [n_point] .surf with 4 columns or more; else
                        NULL. 0 or less: not given at this point */
  double *thickness; /* [n_point] .surf with 5 columns; else NULL */
};
#define VG_AFLR_INIT                                                           \
  {                                                                            \
    .n = 0                                                                     \
  } /* releasing this is a no-op */

void vg_aflr_release(struct vg_aflr *a);

/** Read a surface. Tags become patch ids, patches are sorted by id. The flag
 * of a patch gives its condition: below 0 viscous wall (4, 4000), 1 far field
 * (3, 5000; AFLR3 knows it for inviscid walls too, which need a .mapbc), else
 * none. Where faces of a patch differ, its flag is that of most of its faces,
 * the lower one at par. Columns behind the tag may be missing.
 * @param a  may be NULL; both outputs are untouched on failure
 * Returns VG_ERR_IO, VG_ERR_FORMAT, VG_ERR_INPUT (index out of range, value
 * not finite) or VG_ERR_MEMORY. Threads: re-entrant. O(n). */
vg_status vg_aflr_surf_read(const char *path, struct vg_mesh *m,
                            struct vg_aflr *a, struct vg_error *err);
vg_status vg_aflr_surf_parse(struct vg_input *in, struct vg_mesh *m,
                             struct vg_aflr *a, struct vg_error *err);

/** Read a .tags: 'id group visc recon rebuild fixed source trans delete
 * spacing thickness layers'; older ones lack `layers`, or that and `fixed`.
 * An id listed twice is VG_ERR_INPUT. */
vg_status vg_aflr_tags_read(const char *path, struct vg_aflr *a,
                            struct vg_error *err);
vg_status vg_aflr_tags_parse(struct vg_input *in, struct vg_aflr *a,
                             struct vg_error *err);

/** Read an AFLR .bc: 'name flag [spacing [thickness]]'. A VGRID .bc, whose
 * first line is four integers, is VG_ERR_FORMAT; vg_aflr_is_bc tells before.
 * A name listed twice is VG_ERR_INPUT. */
vg_status vg_aflr_bc_read(const char *path, struct vg_aflr *a,
                          struct vg_error *err);
vg_status vg_aflr_bc_parse(struct vg_input *in, struct vg_aflr *a,
                           struct vg_error *err);

/** 1 when the file is text whose first entry is no line of four integers. */
int vg_aflr_is_bc(const char *path);

/** Give the patches of m what a .tags (by id) or a .bc (by name) says:
 * the name where m has none, a viscous wall (4, 4000) where layers grow.
 * A viscous wall on which they do not grow becomes inviscid (5, 3000). What
 * is not listed keeps what it has.
 * @param n_unused  out, may be NULL: entries that no patch of m has */
vg_status vg_aflr_apply(const struct vg_aflr *a, struct vg_mesh *m,
                        size_t *n_unused, struct vg_error *err);

#endif
