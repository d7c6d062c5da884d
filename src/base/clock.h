/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/clock.h: clocks for reports and progress displays. No result may depend
 * on them. */
#ifndef VG_BASE_CLOCK_H
#define VG_BASE_CLOCK_H

#include <time.h>

/** Seconds of a monotonic clock with an arbitrary origin. */
static inline double vg_clock(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/** Processor time of the calling thread in seconds. */
static inline double vg_clock_thread(void)
{
  struct timespec t;

  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/** Processor time of all threads of this process in seconds. */
static inline double vg_clock_process(void)
{
  struct timespec t;

  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
