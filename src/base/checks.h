/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/checks.h: checks of the complete result of a stage, too expensive for
 * assert. The CMake option VG_CHECKS compiles them in (presets asan and fuzz);
 * without it they cost nothing. Uses nothing.
 *
 * Like assert, these checks detect our own bugs: a failed check prints the name
 * of the stage and aborts. Errors that the input can cause return a vg_status
 * instead. */
#ifndef VG_BASE_CHECKS_H
#define VG_BASE_CHECKS_H

#include <stddef.h>

#ifdef VG_CHECKS
enum { VG_CHECKS_ON = 1 };
#else
enum { VG_CHECKS_ON = 0 };
#endif

/** Return if n_defect is 0; otherwise print stage, what and n_defect to
 * standard error and abort. Threads: safe.
 *
 * @param stage  readable name of the stage: "boundary recovery"
 * @param what   expression that counted the defects */
void vg_check_none(const char *stage, const char *what, size_t n_defect);

/* Evaluate `n_defect`, a count, when checks are on; abort unless it is 0. */
#define VG_CHECK(stage, n_defect)                                              \
  do {                                                                         \
    if (VG_CHECKS_ON) vg_check_none(stage, #n_defect, n_defect);               \
  } while (0)

#endif
