/* base/clock.h: seconds, for reports and displays; nothing that is made may
 * follow from them. */
#ifndef VG_BASE_CLOCK_H
#define VG_BASE_CLOCK_H

#include <time.h>

/** Seconds of a clock that only goes forward, from any start. */
static inline double vg_clock(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/** Seconds of processor time that the calling thread has had. */
static inline double vg_clock_thread(void)
{
  struct timespec t;

  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/** The same of all threads of this process together. */
static inline double vg_clock_process(void)
{
  struct timespec t;

  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

#endif
