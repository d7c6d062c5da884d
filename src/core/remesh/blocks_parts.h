/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/blocks_parts.h: declarations shared by blocks.c, blocks_cut.c and
 * blocks_join.c. Private to core/remesh. */
#ifndef VG_CORE_REMESH_BLOCKS_PARTS_H
#define VG_CORE_REMESH_BLOCKS_PARTS_H

#include "core/remesh/blocks.h"

struct vg_block {
  double weight; /* Number of expected points, and some per triangle. */
  size_t n_tri;
  const uint32_t *tri; /* [n_tri] Triangles of the whole surface, ascending. */
  struct vg_tris w;
  size_t n_origin;
  uint32_t *origin;        /* [n_origin] Points of the whole surface that are
                              the first points of the block. */
  uint32_t *point, *place; /* Numbers in the whole surface of the block's points
                              and triangles. */
  size_t first_point, first_tri, first_line;
  vg_status st;
  struct vg_error err;
};

/** Block of each triangle: 0 to k - 1, or VG_REF_NONE for removed triangles.
 * @param of     out: [n_tri]
 * @param block  [k], in/out: their weights, 0 before */
vg_status vg_blocks_cut(const struct vg_tris *w, size_t k, int phase,
                        uint32_t *of, struct vg_block *block,
                        struct vg_error *err);

/** Replace the contents of w by the joined blocks. */
vg_status vg_blocks_join(struct vg_tris *w, size_t n, struct vg_block *b,
                         int threads, struct vg_error *err);

#endif
