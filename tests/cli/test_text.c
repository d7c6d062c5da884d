/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Names as displayed: valid UTF-8, width in columns, where a name is cut. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "run/common/text.h"

static void test_characters(void **state)
{
  const struct {
    const char *text;
    size_t n;
  } row[] = { { "a", 1 },
              { "\xc3\xbc", 2 },
              { "\xe6\x9c\xba", 3 },
              { "\xf0\x9f\x9b\xa9", 4 },
              { "\xfc", 0 },
              { "\xc3", 0 },
              { "\xe6\x9c", 0 },
              { "\xbc", 0 },
              { "\xc0\xaf", 0 },
              { "\xe0\x80\xaf", 0 },
              { "\xed\xa0\x80", 0 },
              { "\xef\xbf\xbe", 0 },
              { "\xef\xbf\xbd", 3 },
              { "\xf4\x90\x80\x80", 0 },
              { "\xf5\x80\x80\x80", 0 } };

  (void)state;
  for (size_t i = 0; i < sizeof row / sizeof *row; i++)
    assert_int_equal(vg_text_character(row[i].text), row[i].n);
}

static void test_clean(void **state)
{
  char out[40], *copy;

  (void)state;
  assert_string_equal(vg_text_clean("Fl\xfcgel \xc3\xbc\t1", out, sizeof out),
                      "Fl?gel \xc3\xbc 1");
  /* Cut before a character that does not fit as a whole. */
  assert_string_equal(vg_text_clean("ab\xc3\xbc", out, 4), "ab");
  assert_string_equal(vg_text_clean("ab\xc3\xbc", out, 5), "ab\xc3\xbc");
  copy = vg_text_copy("\xff\xfe");
  assert_string_equal(copy, "??");
  free(copy);
}

static void test_column(void **state)
{
  char out[40];

  (void)state;
  assert_string_equal(vg_text_column("wing", 6, out, sizeof out), "wing  ");
  assert_string_equal(vg_text_column("\xc3\xbc\xc3\xbc", 4, out, sizeof out),
                      "\xc3\xbc\xc3\xbc  ");
  assert_string_equal(vg_text_column("\xc3\xbc\xc3\xbc", 1, out, sizeof out),
                      "\xc3\xbc");
  /* Each character takes two columns, so that one of three is padding. */
  assert_string_equal(vg_text_column("\xe6\x9c\xba\xe7\xbf\xbc", 3, out,
                                     sizeof out),
                      "\xe6\x9c\xba ");
  /* A combining mark takes no column of its own. */
  assert_string_equal(vg_text_column("u\xcc\x88x", 3, out, sizeof out),
                      "u\xcc\x88x ");
}

static void test_end(void **state)
{
  const struct {
    const char *text, *mended;
  } row[] = { { "", "" },
              { "ab", "ab" },
              { "a\xc3\xbc", "a\xc3\xbc" },
              { "a\xc3", "a" },
              { "a\xe6\x9c", "a" },
              { "a\xe6\x9c\xba", "a\xe6\x9c\xba" },
              { "\xf0\x9f\x9b", "" },
              { "\xbc\xbc", "\xbc\xbc" } };
  char text[16];

  (void)state;
  for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
    strcpy(text, row[i].text);
    vg_text_trim_end(text);
    assert_string_equal(text, row[i].mended);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(test_characters),
                                      cmocka_unit_test(test_clean),
                                      cmocka_unit_test(test_column),
                                      cmocka_unit_test(test_end) };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
