/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Only used by the preset `coverage`. gcov writes the counts of a process in
 * exit(), but the child processes of Vanguard end with _exit(). With the option
 * --wrap the linker replaces calls of _exit by __wrap__exit. */
#include <sys/prctl.h>

void __gcov_dump(void);
void __real__exit(int status) __attribute__((noreturn));
void __wrap__exit(int status) __attribute__((noreturn));

/* A child is killed when its parent ends. This is disabled here, since it could
 * leave an incomplete file of counts. */
void __wrap__exit(int status)
{
  prctl(PR_SET_PDEATHSIG, 0);
  __gcov_dump();
  __real__exit(status);
}
