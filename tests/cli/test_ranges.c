/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lists of numbers as a user types them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "run/common/ranges.h"

static void gives(const char *text, size_t n, const int64_t *v)
{
  struct vg_range_list r = VG_RANGE_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_range_parse("-n", text, 0, 1000, &r, &err) < 0)
    fail_msg("%s", err.text);
  assert_int_equal(r.n, n);
  assert_memory_equal(r.v, v, n * sizeof *v);
  vg_range_release(&r);
}

static void lists_and_ranges(void **state)
{
  (void)state;
  gives("7", 1, (const int64_t[]){ 7 });
  gives("4,1,2", 3, (const int64_t[]){ 4, 1, 2 });
  gives("3:7", 5, (const int64_t[]){ 3, 4, 5, 6, 7 });
  gives("0:100:40", 3, (const int64_t[]){ 0, 40, 80 });
  gives("1:20:x3", 3, (const int64_t[]){ 1, 3, 9 });
  gives("1:3,2,10", 4, (const int64_t[]){ 1, 2, 3, 10 });
  gives("5:5", 1, (const int64_t[]){ 5 });
  gives("1e2,2.5e2,4.0", 3, (const int64_t[]){ 100, 250, 4 });
  gives("1e2:1E3:x2", 4, (const int64_t[]){ 100, 200, 400, 800 });
  gives("1:1000:x9223372036854775807", 1, (const int64_t[]){ 1 });
}

static void refuses(const char *text, int64_t hi, const char *expected)
{
  int64_t kept = 9;
  struct vg_range_list r = { 1, 1, &kept };
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_range_parse("-n", text, 0, hi, &r, &err), VG_ERR_INPUT);
  if (!strstr(err.text, expected))
    fail_msg("'%s' lacks '%s'", err.text, expected);
  assert_ptr_equal(r.v, &kept);
}

static void typing_errors_are_reported(void **state)
{
  (void)state;
  refuses("", 1000, "not ''");
  refuses("1,", 1000, "not ''");
  refuses("a", 1000, "not 'a'");
  refuses("1.5", 1000, "not '1.5'");
  refuses("1e99", 1000, "not '1e99'");
  refuses("1:", 1000, "not '1:'");
  refuses(":3", 1000, "not ':3'");
  refuses("1:3:", 1000, "not '1:3:'");
  refuses("1:3:0", 1000, "not '1:3:0'");
  refuses("1:3:-1", 1000, "not '1:3:-1'");
  refuses("1:3:x1", 1000, "not '1:3:x1'");
  refuses("1:2:3:4", 1000, "not '1:2:3:4'");
  refuses("7:3", 1000, "the lower one first");
  refuses("1001", 1000, "from 0 to 1000");
  refuses("-1", 1000, "from 0 to 1000");
  refuses("0:8:x2", 1000, "never reaches the end");
  refuses("0:10000", 1000000, "more than 4096 numbers");
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(lists_and_ranges),
    cmocka_unit_test(typing_errors_are_reported),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
