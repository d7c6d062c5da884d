/* Part of the preset `coverage` only: gcov writes the counts of a process at
 * exit(), and child processes of Vanguard end by _exit(). The linker calls
 * __wrap__exit wherever the code calls _exit (option --wrap). */
#include <sys/prctl.h>

void __gcov_dump(void);
void __real__exit(int status) __attribute__((noreturn));
void __wrap__exit(int status) __attribute__((noreturn));

/* A child is killed when its parent ends, which would leave half a file of
 * counts: not from here on. */
void __wrap__exit(int status)
{
  prctl(PR_SET_PDEATHSIG, 0);
  __gcov_dump();
  __real__exit(status);
}
