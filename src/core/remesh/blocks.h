/* core/remesh/blocks.h: a surface that changes, in blocks at a time. Private to
 * core/remesh.
 *
 * A block has its triangles for itself; its border stays as it is. So blocks
 * are changed on threads of their own, and what becomes of them follows from
 * where the cuts are, not from who was first. Another phase has other borders:
 * there what was one before is reached. */
#ifndef VG_CORE_REMESH_BLOCKS_H
#define VG_CORE_REMESH_BLOCKS_H

#include "core/remesh/work.h"

typedef vg_status (*vg_block_body)(void *user, struct vg_tris *w,
                                   struct vg_error *err);

/** How many blocks a surface of so many triangles falls into, by the sizes. */
size_t vg_blocks_number(const struct vg_tris *w);

/** Cut the surface by planes into about n blocks with as much to do each, run
 * body on every one, and put them together. With one block, body gets w.
 *
 * Afterwards only points near borders count as changed. Numbers of points and
 * triangles are others than before.
 * @param phase  0, 1, ...: where the planes are
 * Of several blocks that fail the first one's status is returned; w can only be
 * released then. The same for any number of threads. O(n log n). */
vg_status vg_blocks_run(struct vg_tris *w, size_t n, int phase, int threads,
                        vg_block_body body, void *user, struct vg_error *err);

#endif
