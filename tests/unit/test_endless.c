/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* helpers/common/endless.h: loops that repeat a state, and long ones that do
 * not. */
#define _GNU_SOURCE
#include "common/endless.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/time.h>
#include <unistd.h>

#include <cmocka.h>

static sigjmp_buf out;

static void look(int signal, siginfo_t *info, void *context)
{
  (void)signal;
  (void)info;
  if (vg_endless_look(context)) siglongjmp(out, 1);
}

static void watch(long microseconds)
{
  struct itimerval t = { { 0, microseconds }, { 0, microseconds } };
  struct sigaction a = { .sa_sigaction = look, .sa_flags = SA_SIGINFO };

  assert_true(vg_endless_start());
  sigaction(SIGVTALRM, &a, NULL);
  setitimer(ITIMER_VIRTUAL, &t, NULL);
}

/* A ring of items, through which a lost search goes round. */
struct item {
  struct item *next;
  unsigned value;
};

static struct item *ring(size_t n)
{
  struct item *r = calloc(n, sizeof *r);

  assert_non_null(r);
  for (size_t i = 0; i < n; i++) r[i].next = &r[(i + 1) % n];
  return r;
}

/* Walk until the value of the last item of a ring of seven is 0 after it was
 * lowered in each round; `step` 0: never. Returns 1 if the walk is proven to be
 * endless. */
static int is_endless(unsigned value, unsigned step)
{
  static struct item *volatile r;
  int is_proven;

  r = ring(7);
  r[6].value = value;
  is_proven = sigsetjmp(out, 1);
  if (!is_proven) {
    struct item *at = r;

    watch(1000);
    while (at != &r[6] || (at->value -= step) != 0) at = at->next;
  }
  watch(0);
  free(r);
  return is_proven;
}

static void a_walk_that_never_ends(void **state)
{
  (void)state;
  assert_true(is_endless(1, 0));
}

/* About a second and hundreds of looks. */
static void a_long_walk_that_ends(void **state)
{
  (void)state;
  assert_false(is_endless(200000000, 1));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_walk_that_never_ends),
    cmocka_unit_test(a_long_walk_that_ends),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
