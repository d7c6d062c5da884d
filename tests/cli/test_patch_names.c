/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Patches given by number, range, name and pattern, in lists and in table
 * rows. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "run/settings/deck.h"
#include "run/settings/patch_names.h"

static void refuse_list(const char *list)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_patch_list_check("walls", list, &err) != VG_ERR_INPUT)
    fail_msg("'%s' was taken", list);
  assert_non_null(strstr(err.text, "is not a list of patches"));
}

static void lists_have_numbers_and_names(void **unused)
{
  const char *at = "-3, 4-9,-2--1 wing*,\"upper, left\",'a \"b\" c' fus?lage,"
                   "\"7\"";
  static const struct {
    int64_t from, to;
    const char *name;
  } expected[] = { { -3, -3, "" },          { 4, 9, "" },
                   { -2, -1, "" },          { 0, 0, "wing*" },
                   { 0, 0, "upper, left" }, { 0, 0, "a \"b\" c" },
                   { 0, 0, "fus?lage" },    { 0, 0, "7" } };
  struct vg_patch_item item;

  (void)unused;
  for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
    assert_true(vg_patch_list_next(&at, &item));
    assert_int_equal(item.from, expected[i].from);
    assert_int_equal(item.to, expected[i].to);
    assert_string_equal(item.name, expected[i].name);
  }
  assert_false(vg_patch_list_next(&at, &item));
  assert_int_equal(*at, 0);
}

static void lists_are_checked(void **unused)
{
  char longest[VG_NAME_MAX + 1] = "";

  (void)unused;
  refuse_list("3-x");
  refuse_list("3-1");
  refuse_list("3rd");
  refuse_list("1,\"open");
  refuse_list("1,''");
  refuse_list("'a'b");
  refuse_list("99999999999999999999");
  memset(longest, 'a', VG_NAME_MAX);
  refuse_list(longest);
  longest[VG_NAME_MAX - 1] = 0;
  assert_int_equal(vg_patch_list_check("walls", longest, NULL), VG_OK);
  assert_int_equal(vg_patch_list_check("walls", "", NULL), VG_OK);
}

static void patterns_match(void **unused)
{
  static const struct {
    const char *pattern, *name;
    int does;
  } x[] = { { "wing", "wing", 1 },
            { "wing", "Wing", 0 },
            { "wing*", "wing", 1 },
            { "wing*", "wing_left", 1 },
            { "*ing", "wing", 1 },
            { "*", "", 1 },
            { "?", "", 0 },
            { "fus?lage", "fuselage", 1 },
            { "fus?lage", "fuslage", 0 },
            { "a*b*c", "aXbYbZc", 1 },
            { "a*b*c", "aXcYb", 0 },
            { "**a", "ba", 1 },
            { "*aaaaaaaab", "aaaaaaaaaaaaaaaaaaaaaaaa", 0 },
            { "[a]", "a", 0 } };

  (void)unused;
  for (size_t i = 0; i < sizeof x / sizeof *x; i++)
    if (vg_patch_name_matches(x[i].pattern, x[i].name) != x[i].does)
      fail_msg("%s on %s", x[i].pattern, x[i].name);
}

/* Patches 1 wing_l, 2 wing_r, 3 tail, and 4, whose name is "3". */
static void scene(struct vg_mesh *m)
{
  vg_mesh_add_patch(m, 1, "wing_l");
  vg_mesh_add_patch(m, 2, "wing_r");
  vg_mesh_add_patch(m, 3, "tail");
  vg_mesh_add_patch(m, 4, "3");
}

static void lists_are_marked(void **unused)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint8_t on[4] = { 0 };

  (void)unused;
  scene(&m);
  assert_int_equal(vg_patch_list_mark("walls", "wing*,3", &m, 4, on, &err),
                   VG_OK);
  assert_true(on[0] && on[1] && on[2] && !on[3]); /* a number is a number */
  memset(on, 0, sizeof on);
  assert_int_equal(vg_patch_list_mark("walls", "'3'", &m, 4, on, &err), VG_OK);
  assert_true(!on[0] && !on[1] && !on[2] && on[3]); /* unless it is quoted */
  assert_int_equal(vg_patch_list_mark("walls", "wing_m", &m, 4, on, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text,
                         "is named 'wing_m'; did you mean "
                         "'wing_l'? Patches: 1 wing_l (no condition), 2"));
  assert_int_equal(vg_patch_list_mark("walls", "8-9", &m, 4, on, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "in the range 8-9"));
  assert_int_equal(vg_patch_list_mark("walls", "tail", &m, 2, on, &err),
                   VG_ERR_INPUT); /* only the first 2 patches count */
  vg_mesh_release(&m);
}

static void read_deck(const char *text, struct vg_settings *s)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_deck_parse("run.deck", text, strlen(text), s, &err) < 0)
    fail_msg("%s", err.text);
}

static void rows_are_resolved(void **unused)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  scene(&m);
  read_deck("t\npatches\nid bc name\nwing* 4 -\ntail 5 \"rear end\"\n\n"
            "layers\nid first\n\"rear*\" 1e-3\n2 2e-3\n77 1\n",
            &s);
  for (int again = 0; again < 2; again++) {
    if (vg_patch_rows_resolve(&s, &m, &err) < 0) fail_msg("%s", err.text);
    assert_int_equal(s.n_patch, 3);
    assert_int_equal(s.patch[0].id, 1);
    assert_int_equal(s.patch[1].id, 2);
    assert_int_equal(s.patch[1].bc, 4);
    assert_int_equal(s.patch[2].id, 3);
    assert_int_equal(s.n_layer, 3);
    assert_int_equal(s.layer_row[0].id, 3); /* by its new name */
    assert_true(s.layer_row[0].first == 1e-3 && s.layer_row[1].first == 2e-3);
    assert_int_equal(s.layer_row[2].id, 77);
  }
  vg_settings_release(&s);
  vg_mesh_release(&m);
}

static void two_rows_of_a_patch_are_refused(void **unused)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)unused;
  scene(&m);
  read_deck("t\nlayers\nid first\n2 1e-3\nwing* 2e-3\n", &s);
  assert_int_equal(vg_patch_rows_resolve(&s, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "patch 2 wing_r is listed twice, as 2 and "
                                   "as wing*"));
  assert_int_equal(s.n_layer, 2); /* unchanged */
  read_deck("t\npatches\nid bc\nwnig_l 4\n", &s);
  assert_int_equal(vg_patch_rows_resolve(&s, &m, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "did you mean 'wing_l'?"));
  vg_settings_release(&s);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(lists_have_numbers_and_names),
    cmocka_unit_test(lists_are_checked),
    cmocka_unit_test(patterns_match),
    cmocka_unit_test(lists_are_marked),
    cmocka_unit_test(rows_are_resolved),
    cmocka_unit_test(two_rows_of_a_patch_are_refused),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
