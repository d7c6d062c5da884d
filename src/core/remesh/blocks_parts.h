/* core/remesh/blocks_parts.h: what blocks.c, blocks_cut.c and blocks_join.c
 * share. Private to core/remesh. */
#ifndef VG_CORE_REMESH_BLOCKS_PARTS_H
#define VG_CORE_REMESH_BLOCKS_PARTS_H

#include "core/remesh/blocks.h"

struct vg_block {
  size_t n_tri;
  const uint32_t *tri; /* [n_tri] of the whole, rising */
  struct vg_tris w;
  size_t n_origin;
  uint32_t *origin;        /* [n_origin] points of the whole that its first
                              ones are */
  uint32_t *point, *place; /* points and triangles of the whole that those of
                              the block become */
  size_t first_point, first_tri, first_line;
  vg_status st;
  struct vg_error err;
};

/** block[n_tri]: 0 to k - 1; of removed triangles VG_REF_NONE. */
vg_status vg_blocks_cut(const struct vg_tris *w, size_t k, int phase,
                        uint32_t *block, struct vg_error *err);

/** The blocks take the place of what w was. */
vg_status vg_blocks_join(struct vg_tris *w, size_t n, struct vg_block *b,
                         int threads, struct vg_error *err);

#endif
