/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lengths with units: random decimal numbers keep their value in their own unit
 * and are the nearest double in another one. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "io/cad/cad.h"
#include "run/settings/length.h"

/* Metric units with the exponent of ten of each in mm. */
static const struct {
  const char *name;
  int unit, exponent;
} metric[] = { { "mm", VG_CAD_UNIT_MM, 0 },
               { "cm", VG_CAD_UNIT_CM, 1 },
               { "m", VG_CAD_UNIT_M, 3 },
               { "km", VG_CAD_UNIT_KM, 6 } };

static uint64_t seed = 1;

static uint64_t next(uint64_t n)
{
  seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return (seed >> 33) % n;
}

/* A number of up to ten digits with a point and an exponent anywhere. */
static void make_number(char text[64])
{
  const int n = 1 + (int)next(10), point = (int)next((uint64_t)n + 2);
  size_t at = 0;

  if (!next(3)) text[at++] = '-';
  for (int i = 0; i < n; i++) {
    if (i == point) text[at++] = '.';
    text[at++] = (char)('0' + next(10));
  }
  text[at] = 0;
  if (!next(2)) sprintf(text + at, "e%d", (int)next(41) - 20);
}

static void random_numbers_are_exact(void **state)
{
  (void)state;
  for (int i = 0; i < 100000; i++) {
    const int from = (int)next(4), to = (int)next(4);
    char number[64], text[80], shifted[80], out[VG_LENGTH_TEXT], *e;
    double v = 0, again = 0;
    int exponent = metric[from].exponent - metric[to].exponent;

    make_number(number);
    sprintf(text, "%s%s", number, metric[from].name);
    if (vg_length_parse(text, strlen(text), &v) != 1) fail_msg("%s", text);
    assert_true(isnan(v) && vg_length_has_unit(v));
    if (vg_length_number(v) != strtod(number, NULL))
      fail_msg("%s is %.17g", text, vg_length_number(v));
    e = strchr(number, 'e');
    if (e) exponent += atoi(e + 1);
    sprintf(shifted, "%.*se%d", e ? (int)(e - number) : 60, number, exponent);
    if (vg_length_in(v, metric[to].unit) != strtod(shifted, NULL))
      fail_msg("%s is %.17g, not %s %s", text, vg_length_in(v, metric[to].unit),
               shifted, metric[to].name);
    vg_length_format(v, out);
    assert_int_equal(vg_length_parse(out, strlen(out), &again), 1);
    if (memcmp(&v, &again, sizeof v) && vg_length_number(v) != 0)
      fail_msg("%s is written as %s", text, out);
  }
}

static double in_mm(const char *text)
{
  double v = 0;

  if (vg_length_parse(text, strlen(text), &v) != 1) fail_msg("%s", text);
  return vg_length_in(v, VG_CAD_UNIT_MM);
}

static void customary_units(void **state)
{
  double v = 0;

  (void)state;
  assert_true(in_mm("1.2in") == 30.48 && in_mm("1.2inch") == 30.48);
  assert_true(in_mm("2ft") == 609.6 && in_mm("2foot") == 609.6);
  assert_int_equal(vg_length_parse("254mm", 5, &v), 1);
  assert_true(vg_length_in(v, VG_CAD_UNIT_INCH) == 10);
  assert_int_equal(vg_length_parse("1d-3m", 5, &v), 1);
  assert_true(vg_length_in(v, VG_CAD_UNIT_MM) == 1);
}

static void other_texts_are_refused(void **state)
{
  static const char *const bad[] = { "",       "mm",   "30",     "30mmm",
                                     "30 mm",  "em",   "1e5",    "30nm",
                                     "nanmm",  "infm", "1.2.3m", "1e-mm",
                                     "0x1p3m", "-mm" };
  double v = 7;

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    if (vg_length_parse(bad[i], strlen(bad[i]), &v) || v != 7)
      fail_msg("'%s' is accepted", bad[i]);
  assert_int_equal(vg_length_parse("12345678901mm", 13, &v), -1);
  assert_int_equal(vg_length_parse("1e100mm", 7, &v), -1);
  assert_false(vg_length_has_unit(NAN));
  assert_false(vg_length_has_unit(-NAN));
  assert_false(vg_length_has_unit(INFINITY));
  assert_false(vg_length_has_unit(0.0));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(random_numbers_are_exact),
    cmocka_unit_test(customary_units),
    cmocka_unit_test(other_texts_are_refused),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
