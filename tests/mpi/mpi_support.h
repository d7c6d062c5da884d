/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Open and close the job around a program of cmocka tests. */
#ifndef VG_TESTS_MPI_SUPPORT_H
#define VG_TESTS_MPI_SUPPORT_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/comm.h"
#include "base/memory.h"

static struct vg_comm *job;

static inline int open_job(void **state)
{
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (vg_comm_open(&job, &err) == VG_OK) return 0;
  fprintf(stderr, "%s\n", err.text);
  return -1;
}

static inline int close_job(void **state)
{
  (void)state;
  vg_comm_close(job);
  job = NULL;
  return 0;
}

#define RUN_IN_JOB(tests) cmocka_run_group_tests(tests, open_job, close_job)

#endif
