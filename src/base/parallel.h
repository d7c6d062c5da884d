/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/parallel.h: loops over threads. Uses only pthreads. */
#ifndef VG_BASE_PARALLEL_H
#define VG_BASE_PARALLEL_H

#include <stddef.h>

/** Process items first .. end - 1. `worker` < threads selects scratch
 * memory. */
typedef void (*vg_loop_body)(void *context, size_t first, size_t end,
                             int worker);

/** Run body over 0 .. n - 1 in chunks of `grain` items (the last is shorter).
 *
 * Timing decides which worker processes which chunk, but not the bounds of the
 * chunks. The result is therefore the same for any number of threads, provided
 * that each item is written by its own chunk only and sums are kept per chunk.
 * @param threads  1: use the calling thread; 0: one per available core. If a
 *                 thread cannot be started, the others do its share.
 * Returns when all items are done. Re-entrant; a body must not throw or
 * exit. */
void vg_parallel_for(int threads, size_t n, size_t grain, vg_loop_body body,
                     void *context);

/** Data of the calling thread, NULL at first, for functions that are too deep
 * in the call tree to receive it. The threads of vg_parallel_for and of the
 * task scheduler inherit it from the thread that starts them. */
void *vg_thread_data(void);
void vg_thread_data_set(void *data);

/** Number of cores that this process may use (its affinity), at least 1. */
int vg_cores(void);

#endif
