/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/blocks.h: changes a surface in blocks, in parallel. Private to
 * core/remesh.
 *
 * Each block owns its triangles, and its border stays unchanged. Blocks can
 * therefore be changed by different threads, and the result depends on the cuts
 * only, not on the order in which blocks finish. Each phase uses other cuts, so
 * that a later phase changes the triangles along the borders of an earlier
 * one. */
#ifndef VG_CORE_REMESH_BLOCKS_H
#define VG_CORE_REMESH_BLOCKS_H

#include "core/remesh/work.h"

typedef vg_status (*vg_block_body)(void *user, struct vg_tris *w,
                                   struct vg_error *err);

/** Number of blocks for the surface, estimated from its sizing field. */
size_t vg_blocks_number(const struct vg_tris *w);

/** Cut the surface by planes into about n blocks of equal expected work, run
 * body on each and join them. With one block, body gets w itself.
 *
 * Afterwards only points near block borders and at bad triangles count as
 * changed. Points and triangles are renumbered. If a block inserts more than
 * w->churn points per expected point, w is over and can only be released.
 * @param phase  0, 1, ...: selects the planes. If several blocks fail, the
 * status of the first is returned, and w can only be released. The result is
 * the same for any number of threads. O(n log n). */
vg_status vg_blocks_run(struct vg_tris *w, size_t n, int phase, int threads,
                        vg_block_body body, void *user, struct vg_error *err);

#endif
