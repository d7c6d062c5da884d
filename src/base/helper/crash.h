/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/helper/crash.h: the last message of a process whose library crashes.
 * A crash is an answer about the input, since it happens again; a process that
 * ends without a message was ended from outside. */
#ifndef VG_BASE_HELPER_CRASH_H
#define VG_BASE_HELPER_CRASH_H

#ifdef __cplusplus
extern "C" {
#endif

/** From now on, answer VG_HELPER_FAILED on fd before this process ends: cause
 * VG_HELPER_CRASHED on SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT, cause
 * VG_HELPER_TIME on SIGPROF. */
void vg_helper_answer_crashes(int fd);

#ifdef __cplusplus
}
#endif

#endif
