/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Which signals end the process, and when. Each case runs in a process of its
 * own. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

#include "cli/common/cli.h"
#include "run/common/progress.h"

enum { WENT_ON = 7, NOT_TOLD = 8 };

/* The wait status of a process that receives signal `first`, and signal
 * `second` later_ms milliseconds later. */
static int ends(int first, int second, long later_ms)
{
  const struct timespec wait = { later_ms / 1000, later_ms % 1000 * 1000000 };
  pid_t child = fork();
  int status = -1;

  if (!child) {
    vg_display_watch();
    raise(first);
    nanosleep(&wait, NULL);
    raise(second);
    _exit(vg_display_interrupted() ? WENT_ON : NOT_TOLD);
  }
  assert_true(child > 0);
  assert_int_equal(waitpid(child, &status, 0), child);
  return status;
}

static void assert_goes_on(int status)
{
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), WENT_ON);
}

static void simultaneous_signals_count_as_one(void **state)
{
  (void)state;
  assert_goes_on(ends(SIGTERM, SIGTERM, 0));
  assert_goes_on(ends(SIGTERM, SIGTERM, 50));
  assert_goes_on(ends(SIGINT, SIGTERM, 50));
  assert_goes_on(ends(SIGUSR1, SIGHUP, 50));
}

/* The process ends with its own exit status instead of that of the signal. */
static void a_later_signal_ends_the_process_at_once(void **state)
{
  int status = ends(SIGINT, SIGTERM, 1200);

  (void)state;
  assert_true(WIFEXITED(status));
  assert_int_equal(WEXITSTATUS(status), VG_EXIT_FAILED);
}

static void warnings_of_batch_systems_never_end_it(void **state)
{
  (void)state;
  assert_goes_on(ends(SIGUSR1, SIGUSR1, 1200));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(simultaneous_signals_count_as_one),
    cmocka_unit_test(a_later_signal_ends_the_process_at_once),
    cmocka_unit_test(warnings_of_batch_systems_never_end_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
