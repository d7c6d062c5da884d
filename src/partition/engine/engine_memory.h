/* partition/engine/engine_memory.h: arrays that grow inside a task. Uses
 * engine.h. */
#ifndef VG_PARTITION_ENGINE_ENGINE_MEMORY_H
#define VG_PARTITION_ENGINE_ENGINE_MEMORY_H

#include "partition/engine/engine.h"

/** As vg_reserve (base/memory.h); what is large is copied in a loop.
 * n: items in use, the first ones: others are not kept. */
int vg_engine_reserve(const struct vg_engine *e, void *block, size_t *cap,
                      size_t n, size_t need, size_t size);

/** free() n blocks, in a loop: giving pages back takes its time. */
void vg_engine_free(const struct vg_engine *e, size_t n, void *const *block);

#endif
