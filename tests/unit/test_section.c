/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include "io/section/section.h"

static vg_status parse(const char *text, struct vg_section *out,
                       struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_memory("wing.dat", text, strlen(text), &in, err);

  assert_int_equal(st, VG_OK);
  st = vg_section_parse(&in, out, err);
  vg_input_release(&in);
  return st;
}

static void accept(const char *text, struct vg_section *out)
{
  struct vg_error err = VG_ERROR_INIT;

  if (parse(text, out, &err) < 0) fail_msg("%s", err.text);
}

/* The message must contain both parts. */
static void refuse(const char *text, vg_status code, const char *first,
                   const char *second)
{
  struct vg_section s = VG_SECTION_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(parse(text, &s, &err), code);
  if (!strstr(err.text, first) || !strstr(err.text, second))
    fail_msg("%s", err.text);
  assert_int_equal(s.n, 0);
}

static void same_points(const struct vg_section *s, size_t n,
                        const double (*x)[2])
{
  assert_int_equal(s->n, 1);
  assert_int_equal(s->n_point, n);
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 2; k++)
      if (s->x[i][k] != x[i][k])
        fail_msg("point %zu: %g %g", i, s->x[i][0], s->x[i][1]);
}

static const double kite[4][2] = {
  { 1, 0 }, { 0.5, 0.1 }, { 0, 0 }, { 0.5, -0.1 }
};

static void reads_both_orders(void **state)
{
  static const char *const text[] = {
    /* Selig, over the upper side and over the lower side first. */
    "Kite\n1 0\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n",
    "Kite\n1 0\n0.5 -0.1\n0 0\n0.5 0.1\n1 0\n",
    /* Lednicer. */
    "Kite\n3. 3.\n\n0 0\n0.5 0.1\n1 0\n\n0 0\n0.5 -0.1\n1 0\n",
    "Kite\r\n  3  3\r\n0 0\r\n.5 1D-1\r\n1 0\r\n0 0\r\n.5 -.1\r\n1. 0.",
    "# comment\n\nKite\n999 999\n1 0 # edge\n# another\n0.5 0.1\n0 0\n"
    "0.5 -0.1\n1 0"
  };

  (void)state;
  for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
    struct vg_section s = VG_SECTION_INIT;

    accept(text[i], &s);
    same_points(&s, 4, kite);
    assert_string_equal(s.element[0].name, "Kite");
    vg_section_release(&s);
  }
}

/* The first line is a title, whatever it looks like. */
static void reads_titles_like_numbers(void **state)
{
  static const char *const title[] = { "nan", "Inf", "0012 64", "0012",
                                       "2412" };

  (void)state;
  for (size_t i = 0; i < sizeof title / sizeof *title; i++) {
    struct vg_section s = VG_SECTION_INIT;
    char text[100];

    snprintf(text, sizeof text, "%s\n1 0\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n",
             title[i]);
    accept(text, &s);
    same_points(&s, 4, kite);
    assert_string_equal(s.element[0].name, title[i]);
    vg_section_release(&s);
  }
}

/* Without a closing point there is a blunt trailing edge, and both its points
 * remain. */
static void keeps_a_blunt_edge(void **state)
{
  static const double blunt[4][2] = {
    { 1, 0.01 }, { 0.5, 0.1 }, { 0, 0 }, { 1, -0.01 }
  };
  struct vg_section s = VG_SECTION_INIT;

  (void)state;
  accept("1 -0.01\n0 0\n0.5 0.1\n1 0.01\n", &s);
  same_points(&s, 4, blunt);
  assert_string_equal(s.element[0].name, "");
  assert_int_equal(s.line[0], 4);
  vg_section_release(&s);
}

static void reads_several_elements(void **state)
{
  struct vg_section s = VG_SECTION_INIT;

  (void)state;
  accept("slat\n1 0\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n"
         "\n2.5\n3 0\n2.5 0.1\n2 0\n2.5 -0.1\n3 0\n\n"
         "5 0\n4.5 0.1\n4 0\n4.5 -0.1\n5 0\n",
         &s);
  assert_int_equal(s.n, 3);
  assert_string_equal(s.element[0].name, "slat");
  assert_string_equal(s.element[1].name, "2.5");
  assert_string_equal(s.element[2].name, "2.5");
  assert_int_equal(s.element[2].first, 8);
  assert_int_equal(s.element[2].n, 4);
  vg_section_release(&s);
}

static void refuses_lines(void **state)
{
  (void)state;
  refuse("a\n1 0\n0.5 nan\n", VG_ERR_FORMAT, "wing.dat:3:", "'0.5 nan'");
  refuse("a\n1 0\nNaN 1\n", VG_ERR_FORMAT, "wing.dat:3:", "NaN");
  refuse("a\n1 0\n-inf 1\n", VG_ERR_FORMAT, "wing.dat:3:", "-inf");
  refuse("a\n1 0\n0.5\n", VG_ERR_FORMAT, "wing.dat:3:", "two finite");
  refuse("a\n1,0\n0.5,1\n", VG_ERR_FORMAT, "wing.dat:2:", "'1,0'");
  refuse("a\n1 0 0\n0.5 0 1\n", VG_ERR_FORMAT, "wing.dat:2:", "third word '0'");
  refuse("00.5 0.1\n1,0\n", VG_ERR_FORMAT, "wing.dat:2:", "'1,0'");
  refuse("nan 1\n1 0\n", VG_ERR_FORMAT, "wing.dat:1:", "'nan 1'");
  refuse("only a title\n", VG_ERR_FORMAT, "wing.dat", "no lines");
}

static void refuses_orders(void **state)
{
  (void)state;
  refuse("a\n3. 4.\n\n0 0\n0.5 0.1\n1 0\n\n0 0\n0.5 -0.1\n1 0\n", VG_ERR_FORMAT,
         "wing.dat:2:", "6 points follow");
  /* The lower side is reversed: neither order. */
  refuse("a\n3 3\n0 0\n0.5 0.1\n1 0\n1 0\n0.5 -0.1\n0 0\n", VG_ERR_FORMAT,
         "Lednicer's order", "Selig's order");
  refuse("a\n0 0\n0.5 0.1\n1 0\n\n0 0\n0.5 -0.1\n1 0\n", VG_ERR_FORMAT,
         "not clear", "'3. 3.'");
  refuse("a\n1 0\n0.5 0.1\n0 0\n\n0 0\n0.5 -0.1\n1 0\n", VG_ERR_GEOMETRY,
         "begins where it ends", "(0, 0)");
}

static void refuses_curves(void **state)
{
  (void)state;
  refuse("a\n1 0\n0.5 0.1\n0 0\n", VG_ERR_GEOMETRY, "open", "(0, 0), line 4");
  refuse("a\n1 0\n0 0\n1 0\n", VG_ERR_GEOMETRY, "wing.dat:2:", "has 2");
  refuse("a\n1 0\n0.5 0.1\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n", VG_ERR_GEOMETRY,
         "wing.dat:4:", "line 3");
  refuse("a\n1 0\n0.5 0.1\n0.5000001 0.1\n0 0\n0.5 -0.1\n1 0\n",
         VG_ERR_GEOMETRY, "wing.dat:4:", "only 1e-07 away");
  refuse("a\n1 5e-7\n0.5 0.1\n0 0\n0.5 -0.1\n1 -5e-7\n", VG_ERR_GEOMETRY,
         "only 1e-06 away", "sharp trailing edge");
  refuse("a\n1 0\n0.5 0\n0 0\n0.2 0\n0.95 0\n", VG_ERR_GEOMETRY,
         "wing.dat:2:", "no area");
  refuse("a\n1 0\n0.6 0.1\n0.3 -0.1\n0 0\n0.3 0.1\n0.6 -0.1\n1 0\n",
         VG_ERR_GEOMETRY, "crosses or touches itself", "lines 3 and 4");
  refuse("a\n1 0\n0.5 0.3\n0 0\n0.5 -0.3\n1 0\nb\n0.6 0\n0.5 0.1\n0.4 0\n"
         "0.5 -0.1\n0.6 0\n",
         VG_ERR_GEOMETRY, "element 2 b", "inside element 1 a");
  refuse("a\n1 0\n0.5 0.3\n0 0\n0.5 -0.3\n1 0\nb\n2 0\n1.5 0.1\n1 0\n"
         "1.5 -0.1\n2 0\n",
         VG_ERR_GEOMETRY, "two elements cross or touch", "(1, 0)");
}

static void knows_its_suffix(void **state)
{
  (void)state;
  assert_int_equal(vg_section_suffix_length("a/b.dat"), 4);
  assert_int_equal(vg_section_suffix_length("b.DAT.gz"), 7);
  assert_int_equal(vg_section_suffix_length(".dat"), 0);
  assert_false(vg_section_is("b.data"));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(reads_both_orders),
    cmocka_unit_test(reads_titles_like_numbers),
    cmocka_unit_test(keeps_a_blunt_edge),
    cmocka_unit_test(reads_several_elements),
    cmocka_unit_test(refuses_lines),
    cmocka_unit_test(refuses_orders),
    cmocka_unit_test(refuses_curves),
    cmocka_unit_test(knows_its_suffix),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
