/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The displayed progress never decreases. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "run/common/progress.h"

struct told {
  char stage[40];
  size_t done, expected;
  int n, stops;
};

static int tell(void *user, const char *stage, size_t done, size_t expected)
{
  struct told *t = user;

  strncpy(t->stage, stage, sizeof t->stage - 1);
  t->done = done;
  t->expected = expected;
  t->n++;
  return t->stops;
}

static void counts_and_shares_only_rise(void **state)
{
  static const size_t step[][2] = {
    { 10, 100 },  { 5, 100 },   /* work was discarded */
    { 20, 400 },                /* the estimate has grown */
    { 90, 100 },  { 120, 100 }, /* more than expected */
    { 60, 1000 }, { 150, 150 }
  };
  struct told t = { .n = 0 };
  struct vg_display d = { .quiet = 1, .tell = tell, .user = &t };
  size_t before = 0;
  double share = 0;

  (void)state;
  for (size_t i = 0; i < sizeof step / sizeof *step; i++) {
    double now;

    vg_display_update(&d, "fill", step[i][0], step[i][1]);
    assert_int_equal(vg_display_stop(&d), 0);
    assert_true(t.done >= before && t.expected >= t.done);
    now = (double)t.done / (double)t.expected;
    assert_true(now >= share);
    share = now;
    before = t.done;
  }
  assert_int_equal(t.done, 150);
  /* Another stage starts again from zero. */
  vg_display_update(&d, "judge", 1, 0);
  assert_string_equal(t.stage, "judge");
  assert_int_equal(t.done, 1);
  assert_int_equal(t.expected, 0);
}

static void the_progress_callback_can_stop_a_run(void **state)
{
  struct told t = { .stops = 1 };
  struct vg_display d = { .quiet = 1, .tell = tell, .user = &t };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_display_stopped(&d, &err), VG_OK);
  vg_display_update(&d, "fill", 1, 2);
  assert_int_equal(vg_display_stop(&d), 1);
  assert_int_equal(vg_display_stopped(&d, &err), VG_ERR_STOPPED);
  assert_int_equal(vg_display_stop(NULL), 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(counts_and_shares_only_rise),
    cmocka_unit_test(the_progress_callback_can_stop_a_run),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
