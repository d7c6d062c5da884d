/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/engine/engine_memory.h: arrays that grow inside a task. Uses
 * engine.h. */
#ifndef VG_PARTITION_ENGINE_ENGINE_MEMORY_H
#define VG_PARTITION_ENGINE_ENGINE_MEMORY_H

#include "partition/engine/engine.h"

/** Like vg_reserve (base/memory.h), but copies large arrays in a parallel loop.
 * n: items in use; only the first n are kept. */
int vg_engine_reserve(const struct vg_engine *e, void *block, size_t *cap,
                      size_t n, size_t need, size_t size);

/** Frees n blocks in a parallel loop, because returning pages to the system is
 * slow. */
void vg_engine_free(const struct vg_engine *e, size_t n, void *const *block);

#endif
