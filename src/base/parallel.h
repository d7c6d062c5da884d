/* base/parallel.h: loops over threads. Uses pthreads, nothing else. */
#ifndef VG_BASE_PARALLEL_H
#define VG_BASE_PARALLEL_H

#include <stddef.h>

/** Work on items first .. end - 1; `worker` < threads names scratch space. */
typedef void (*vg_loop_body)(void *context, size_t first, size_t end,
                             int worker);

/** Run body over 0 .. n - 1 in chunks of `grain` items (the last is shorter).
 *
 * Which worker takes which chunk depends on timing; chunk bounds do not. So
 * the result is the same for any number of threads as long as an item is
 * written by its own chunk only and sums are kept per chunk.
 * @param threads  1: in the calling thread, 0: one per core at hand; when a
 *                 thread cannot be started the others do its share
 * Returns when all is done. Re-entrant; bodies may not throw or exit. */
void vg_parallel_for(int threads, size_t n, size_t grain, vg_loop_body body,
                     void *context);

/** Cores this process may use (its affinity), at least 1. */
int vg_cores(void);

#endif
