/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The run deck: grammar, messages with line numbers and suggestions, and the
 * round trip parse(write(s)) == s. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "run/settings/deck.h"
#include "run/settings/resolved.h"

static vg_status parse(const char *text, struct vg_settings *s,
                       struct vg_error *err)
{
  return vg_deck_parse("run.deck", text, strlen(text), s, err);
}

/* The text must be refused with a message that contains `expected`. */
static void refuse(const char *text, const char *expected)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_true(parse(text, &s, &err) < 0);
  if (!strstr(err.text, expected))
    fail_msg("message '%s' lacks '%s'", err.text, expected);
  assert_null(s.source);
}

/* Compare all values that can be written, using the tables, so that a new
 * setting is compared without a change here. */
static void assert_same(const struct vg_param *p, size_t n, const void *a,
                        const void *b)
{
  char x[512], y[512];

  for (size_t i = 0; i < n; i++) {
    vg_param_format(&p[i], a, x, sizeof x);
    vg_param_format(&p[i], b, y, sizeof y);
    assert_string_equal(x, y);
  }
}

static void assert_same_settings(const struct vg_settings *a,
                                 const struct vg_settings *b)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  assert_string_equal(a->title, b->title);
  assert_same(p, n, a, b);
  for (int t = 0; t < VG_TABLE_N; t++) {
    enum vg_table_kind kind = (enum vg_table_kind)t;
    const struct vg_setting_table *table = vg_settings_table(kind);

    assert_int_equal(vg_settings_rows(a, kind), vg_settings_rows(b, kind));
    for (size_t i = 0; i < vg_settings_rows(a, kind); i++)
      assert_same(table->column, table->n_column, vg_settings_row(a, kind, i),
                  vg_settings_row(b, kind, i));
  }
}

static void round_trip(struct vg_settings *s, enum vg_deck_form form)
{
  const char *path = VG_TMP_DIR "/round_trip.deck";
  struct vg_settings back = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_deck_write(path, s, "# comment\n", form, &err), VG_OK);
  if (vg_deck_read(path, &back, &err) < 0) fail_msg("%s", err.text);
  assert_same_settings(s, &back);
  vg_settings_release(&back);
  remove(path);
}

static void defaults_survive_a_round_trip(void **state)
{
  struct vg_settings s;

  (void)state;
  vg_settings_default(&s);
  round_trip(&s, VG_DECK_ALL);
  round_trip(&s, VG_DECK_CHANGED);
  round_trip(&s, VG_DECK_EXPLAINED);
  vg_settings_release(&s);
}

static void add_source(struct vg_settings *s, int kind)
{
  struct vg_source row;

  vg_settings_row_default(VG_TABLE_SOURCES, &row);
  row.kind = (enum vg_source_kind)kind;
  for (int k = 0; k < 3; k++) {
    row.p0[k] = 0.1 * kind + k;
    row.p1[k] = 1.0 / 3 + k;
    row.p2[k] = -1e-17 * k;
    row.u[k] = k;
    row.p[k] = 7 * k;
    row.layer0[k] = 1e-5 * (k + 1);
    row.layer1[k] = 1e-6 * (k + 1);
  }
  row.h0 = 0.1;
  row.h1 = 0.2 * kind;
  row.r0 = 1;
  row.r1 = M_PI;
  row.growth = kind % 2 ? 1.15 : 0;
  row.an = 1.5;
  row.mach = kind % 2 ? 1.6 : 0;
  row.bn = 0.25;
  row.alpha = 1;
  row.stretch = 1;
  row.sp0 = 3;
  row.sp1 = 4;
  snprintf(row.group, sizeof row.group, "wing \"%d\" # tip", kind);
  assert_int_equal(vg_settings_add(s, VG_TABLE_SOURCES, &row, NULL), VG_OK);
}

static void everything_survives_a_round_trip(void **state)
{
  struct vg_settings s;
  struct vg_farfield_row far = { VG_DOMAIN_BOX,
                                 12.5,
                                 0,
                                 3,
                                 { NAN, NAN, NAN },
                                 { -1, -2, -3 },
                                 { 1, 2, 1e9 },
                                 NAN,
                                 NAN,
                                 NAN,
                                 NAN,
                                 { NAN, NAN, NAN } };
  struct vg_patch_row patch = { -7, 4000, 1, VG_PATCH_SHEET, "left wing", "" };
  struct vg_layer_row layer = {
    -7,  VG_ANSWER_YES, 1e-5, 1.15,
    NAN, NAN,           NAN,  30,
    2,   0.125,         0,    { 98, 99.9, 70, NAN, 8 },
    ""
  };
  const struct vg_wake_row wake = { .patch = VG_BC_NONE,
                                    .stretch = 4,
                                    .length = 3,
                                    .size = 0.015625,
                                    .height = 0.0625,
                                    .growth = 1.03125,
                                    .chord = 1.5,
                                    .stream = VG_STREAM_MINUS_Y,
                                    .up = VG_UP_X,
                                    .patch_name = "wing *",
                                    .alpha = "0, 2.5,-4",
                                    .beta = "1" };
  struct vg_surface_row surface = { VG_BC_NONE, 4, 0.25, 0,       0, 0,
                                    0,          0, 2,    "tail*", "" };
  struct vg_sweep_row sweep = { "1,2",         "1:4:x2", "",
                                "20000,50000", "1:3",    "advancing,octree",
                                "4,16",        3 };
  struct vg_adapt_row adapt = { "./run.sh a b", "p,Ma", "max", 5, 1e6, 1.5, NAN,
                                1e-4,           NAN,    10 };

  (void)state;
  vg_settings_default(&s);
  snprintf(s.title, sizeof s.title, "A run: \"quotes\", # and all");
  s.scale = 0.7071067811865476;
  s.growth = 1.3;
  s.hmin = 1e-5;
  s.hmax = 1e5;
  s.surface_sizes = s.d3m_sources = s.repair = 0;
  s.weld = 1e-9;
  s.optimise = 0;
  s.max_cells = 9000000000000000;
  snprintf(s.write, sizeof s.write, "vtu, meshb");
  vg_settings_add(&s, VG_TABLE_FARFIELD, &far, NULL);
  vg_settings_add(&s, VG_TABLE_PATCHES, &patch, NULL);
  patch.id = 8;
  patch.bc = VG_BC_NONE;
  strcpy(patch.name, "-");
  vg_settings_add(&s, VG_TABLE_PATCHES, &patch, NULL);
  s.layer = (struct vg_layer_settings){ .grow = VG_ANSWER_YES,
                                        .first = 1e-6,
                                        .first_field = "wall \"shear\" 2",
                                        .first_scale = 0.02,
                                        .first_bound = 2,
                                        .ratio = NAN,
                                        .rate1 = 0.15,
                                        .rate2 = 0.02,
                                        .count = 30,
                                        .most = 40,
                                        .constant = 5,
                                        .total = 2.5,
                                        .cap = 1.3,
                                        .reynolds = 5e6,
                                        .length = 1.5,
                                        .walls = "1-3,-7",
                                        .slip = "8 ,9",
                                        .fan_angle = 40,
                                        .gap = 0.3,
                                        .end = 0.8,
                                        .slope = 1.5,
                                        .jump = 3,
                                        .smooth = 7,
                                        .by_source = 1,
                                        .scale_rule = 2,
                                        .limit = { 95, NAN, 60, 1, 5.5 } };
  vg_settings_add(&s, VG_TABLE_LAYERS, &layer, NULL);
  vg_settings_add(&s, VG_TABLE_SURFACE, &surface, NULL);
  surface.adjacent = 8;
  surface.lead = surface.trail = surface.across = 0;
  surface.stretch = 12.5;
  vg_settings_add(&s, VG_TABLE_SURFACE, &surface, NULL);
  for (int kind = VG_SOURCE_VGRID_NODE; kind <= VG_SOURCE_MACHCONE; kind++)
    add_source(&s, kind);
  vg_settings_add(&s, VG_TABLE_WAKES, &wake, NULL);
  vg_settings_add(&s, VG_TABLE_SWEEP, &sweep, NULL);
  vg_settings_add(&s, VG_TABLE_ADAPT, &adapt, NULL);
  round_trip(&s, VG_DECK_ALL);
  round_trip(&s, VG_DECK_CHANGED);
  round_trip(&s, VG_DECK_EXPLAINED);
  vg_settings_release(&s);
}

static void blocks_come_in_any_order(void **state)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (parse("# not the title\n\n ONERA M6 \r\n"
            "sources   # a table\n"
            "h0   kind   x0  group\n"
            "0.1  point  1   \"le ft\"  # a comment\n"
            "# a comment does not end a table\n"
            "2    line   -   -\n"
            "\n"
            "hmax growth\n"
            "\n"
            "# values may wait\n"
            "  1.5d1\t1.25\n"
            "farfield\nkind lengths\nsphere 30\n"
            "\nrepair\nno\n",
            &s, &err) < 0)
    fail_msg("%s", err.text);
  assert_string_equal(s.title, "ONERA M6");
  assert_int_equal(s.n_source, 2);
  assert_int_equal(s.source[0].kind, VG_SOURCE_POINT);
  assert_true(s.source[0].h0 == 0.1);
  assert_true(s.source[0].p0[0] == 1);
  assert_string_equal(s.source[0].group, "le ft");
  assert_true(s.source[0].an == 1);
  assert_int_equal(s.source[1].kind, VG_SOURCE_LINE);
  assert_true(s.source[1].p0[0] == 0);
  assert_true(s.hmax == 15 && s.growth == 1.25);
  assert_int_equal(s.farfield.kind, VG_DOMAIN_SPHERE);
  assert_true(s.farfield.lengths == 30);
  assert_int_equal(s.repair, 0);
  assert_int_equal(s.surface_sizes, 1);
  vg_settings_release(&s);
}

static void messages_name_line_and_remedy(void **state)
{
  (void)state;
  refuse("", "run.deck");
  refuse("# only a comment\n", "title");
  refuse("growth scale\n1.2 1\n", "run.deck:1: this line consists of names");
  refuse("t\ngrwoth\n1.2\n", "run.deck:2: unknown name 'grwoth' in "
                             "this deck; did you mean 'growth'?");
  refuse("t\nsuorces\n", "did you mean 'sources'?");
  refuse("t\nridge_angle\n30\n", "did you mean 'feature_angle'?");
  refuse("t\nzzzzzzzz\n", "'vanguard deck' writes a deck with all names");
  refuse("t\n\ngrowth hmin\n1.2\n", "run.deck:4: 1 values for 2 names");
  refuse("t\ngrowth\n", "run.deck:2: the line of names has no line of values");
  refuse("t\ngrowth\n1.2\n1.3\n",
         "run.deck:4: expected a name, found the number '1.3'");
  refuse("t\ngrowth\n0.9\n", "run.deck:3: growth is 0.9; it must be above 1");
  refuse("t\ngrowth\nfast\n", "growth must be a number, not 'fast'");
  refuse("t\ngrowth\nnan\n", "growth must be a number");
  refuse("t\nhmin hmin\n1 1\n", "appears twice");
  refuse("t\nhmin\n1\nhmin\n2\n", "run.deck:4: 'hmin' was already set on line "
                                  "2;");
  refuse("t\noptimise\n1.5\n", "must be an integer");
  refuse("t\noptimise\n-1\n", "at least 0");
  refuse("t\nrepair\nyess\n", "did you mean 'yes'?");
  refuse("t\nhmin hmax\n2 1\n", "hmin 2 is larger than hmax 1");
  refuse("t\nwrite\n\"open\n", "run.deck:3: a quotation mark is not closed");
  refuse("t\nwrite\n\001\n", "control character");
  refuse("t\nfirst y_plus\n1 1\n", "first and y_plus are both given");
  refuse("t\ny_plus\n1\n", "y_plus requires reynolds");
  refuse("t\nfirst first_from\n1 a.vtu\n", "first and first_from are both");
  refuse("t\nfirst_from\na.vtu\n", "first_from requires y_plus, reynolds");
  refuse("t\nreynolds\n1e6\n", "reference_length must be given together");
  refuse("t\nratio rate1\n1.2 0.2\n", "ratio and rates are both given");
  refuse("t\nlayer_cap\n0.5\n", "layer_cap is 0.5; it must be at least 1");
  refuse("t\nlayers\nyse\n", "run.deck:3: unknown name 'yse' in layers");
  refuse("t\nlayers\nyes\n\nlayers\nno\n", "'layers' was already set on line "
                                           "3;");
}

static void tables_are_checked_too(void **state)
{
  (void)state;
  refuse("t\nsources kind\n", "alone on its line");
  refuse("t\nsources\n", "needs a line of column names");
  refuse("t\nsources\n\nkind h0\npoint 1\n", "needs a line of column names");
  refuse("t\nsources\nkind x0\npoint 1\n", "needs a column 'h0'");
  refuse("t\nsources\nkind h0 x9\n", "did you mean 'x");
  refuse("t\nsources\nkind h0\npiont 1\n", "run.deck:4: kind cannot be "
                                           "'piont'; did you mean 'point'?");
  refuse("t\nsources\nkind h0\npoint -\n", "h0 must be a number");
  refuse("t\nsources\nkind h0\npoint 0\n", "must be above 0");
  refuse("t\nsources\nkind h0 growth\npoint 1 0.5\n", "growth of source 1");
  refuse("t\nsources\nkind h0 mach\nmachcone 1 0.5\n", "mach of source 1");
  refuse("t\nsources\nkind h0\npoint 1\n\nsources\nkind h0\npoint 1\n",
         "run.deck:6: table 'sources' was already given on line 2;");
  refuse("t\nfarfield\nkind\nbox\nbox\n", "one line of values");
  refuse("t\nfarfield\nkind x y\nbox 1 2\n", "give all three or none");
  refuse("t\nfarfield\nkind xlo ylo zlo xhi yhi zhi\nbox 0 0 0 1 -1 1\n",
         "in y the lower corner must be below the upper corner");
  refuse("t\nfarfield\nkind xlo ylo zlo xhi yhi zhi\nsphere 0 0 0 1 1 1\n",
         "set kind to box");
  refuse("t\nfarfield\nkind\nmach\n", "requires the Mach number");
  refuse("t\nfarfield\nkind mach\nmach 1\n", "must be above 1");
  refuse("t\nfarfield\nkind mach\nmach 101\n", "at most 100");
  refuse("t\nfarfield\nkind mach\nmach nan\n", "must be a number");
  refuse("t\nfarfield\nkind mach\nsphere 2\n", "set kind to mach");
  refuse("t\nfarfield\nkind radial\nsphere 2\n", "set kind to mach");
  refuse("t\nfarfield\nkind mach radial\nmach 2 0\n", "must be above 0");
  refuse("t\nfarfield\nkind ux uy uz\nbox 1 0 0\n", "set kind to mach");
  refuse("t\nfarfield\nkind mach ux uy\nmach 2 1 0\n", "give all three");
  refuse("t\nfarfield\nkind mach size\nmach 2 3\n", "set radial");
  refuse("t\nfarfield\nkind mach lengths\nmach 2 30\n", "set radial");
  refuse("t\npatches\nid bc\n1 4\n2 3\n1 5\n", "patch 1 is listed twice");
  refuse("t\npatches\nid name\n1 a b\n", "3 values for 2 names");
  refuse("t\nlayers\nid\n3\n3\n", "layers: patch 3 is listed twice");
  refuse("t\nlayers\nid first y_plus\n3 1 1\n", "both first and y_plus");
  refuse("t\nlayers\nid ratio rate2\n3 1.1 0\n", "both ratio and rates");
  refuse("t\nlayers\nid y_plus\n3 1\n", "requires reynolds");
  refuse("t\nlayers\nid min_full\n3 101\n", "at most 100");
  refuse("t\nlayers\nid count\n3 251\n", "at most 250");
}

/* `layers` is the name of both a setting and a table. */
static void layers_are_a_setting_and_a_table(void **state)
{
  char list[VG_WRITE_MAX];
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (parse("t\nlayers\nyes\n\nlayers\nid grow first min_full\n"
            "3 auto 1e-5 98\n4 no - -\n\n"
            "walls y_plus reynolds reference_length\n3-12,15 1 5e6 2.5\n",
            &s, &err) < 0)
    fail_msg("%s", err.text);
  assert_int_equal(s.layer.grow, VG_ANSWER_YES);
  assert_int_equal(s.n_layer, 2);
  assert_int_equal(s.layer_row[0].grow, VG_ANSWER_AUTO);
  assert_true(s.layer_row[0].first == 1e-5 &&
              s.layer_row[0].limit.min_full == 98);
  assert_true(isnan(s.layer_row[0].ratio));
  assert_int_equal(s.layer_row[1].grow, VG_ANSWER_NO);
  assert_true(isnan(s.layer_row[1].first));
  assert_int_equal(s.layer_row[1].count, VG_COUNT_NONE);
  assert_string_equal(s.layer.walls, "3-12,15");
  assert_true(s.layer.y_plus == 1 && s.layer.length == 2.5);
  round_trip(&s, VG_DECK_EXPLAINED);
  vg_settings_release(&s);
  if (parse("t\ncells layers first\nmixed no 0.1\n", &s, &err) < 0)
    fail_msg("%s", err.text);
  assert_int_equal(s.layer.grow, VG_ANSWER_NO);
  assert_string_equal(s.write, "auto");
  vg_resolve_write(&s, list);
  assert_string_equal(list, "b8.ugrid");
  vg_settings_release(&s);
}

static void failure_leaves_the_settings_alone(void **state)
{
  struct vg_settings s;

  (void)state;
  vg_settings_default(&s);
  s.growth = 1.7;
  add_source(&s, VG_SOURCE_BOX);
  assert_true(parse("t\ngrowth\n1.3\nnonsense\n1\n", &s, NULL) < 0);
  assert_true(s.growth == 1.7);
  assert_int_equal(s.n_source, 1);
  vg_settings_release(&s);
}

static void patches_come_from_a_mesh(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_settings s;

  (void)state;
  vg_settings_default(&s);
  vg_mesh_add_patch(&m, 3, "wing");
  vg_mesh_add_patch(&m, 9, "far field");
  m.patch[1].bc_fun3d = 5000;
  assert_int_equal(vg_deck_patches_of(&m, &s, NULL), VG_OK);
  assert_int_equal(s.n_patch, 2);
  assert_int_equal(s.patch[0].id, 3);
  assert_int_equal(s.patch[0].bc, VG_BC_NONE);
  assert_int_equal(s.patch[1].bc, 5000);
  round_trip(&s, VG_DECK_EXPLAINED);
  vg_settings_release(&s);
  vg_mesh_release(&m);
}

/* vg_settings_given marks every setting that differs from its default; the
 * `use` of a setting says on what it has an effect. */
static void marks_given_settings(void **state)
{
  static const struct {
    const char *name;
    enum vg_use use;
    int given;
  } row[] = {
    { "growth", VG_USE_ALWAYS, 0 },         { "hmax", VG_USE_ALWAYS, 1 },
    { "cad_angle", VG_USE_CAD, 0 },         { "unit", VG_USE_ALWAYS, 1 },
    { "first", VG_USE_LAYERS, 1 },          { "ratio", VG_USE_LAYERS, 0 },
    { "min_full", VG_USE_LAYERS, 0 },       { "layers", VG_USE_ALWAYS, 0 },
    { "surface_size", VG_USE_REMESH, 1 },   { "subdomains", VG_USE_ALWAYS, 1 },
    { "coarsening", VG_USE_PARTS, 0 },      { "bisections", VG_USE_PLANES, 0 },
    { "d3m_sources", VG_USE_D3M, 0 },       { "farfield", VG_USE_ALWAYS, 0 },
    { "farfield_size", VG_USE_FARFIELD, 1 }
  };
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;
  const struct vg_param *p;
  const char *name;
  uint8_t *given;
  size_t n = 0;
  int far;

  (void)state;
  vg_settings_default(&s);
  assert_true(parse("t\nhmax unit first surface_size subdomains growth\n"
                    "3 mm 1e-5 2 4 1.2\nfarfield\nkind size\nauto 9\n",
                    &s, &err) >= 0);
  given = vg_settings_given(&s);
  assert_non_null(given);
  for (size_t i = 0; (p = vg_settings_name(i, &name, &far)); i++) {
    assert_true(vg_param_use(p, far) != VG_USE_BY_PLACE);
    for (size_t k = 0; k < sizeof row / sizeof *row; k++) {
      if (strcmp(name, row[k].name) != 0) continue;
      assert_int_equal(vg_param_use(p, far), row[k].use);
      assert_int_equal(given[i], row[k].given);
      n++;
    }
  }
  assert_int_equal(n, sizeof row / sizeof *row);
  free(given);
  vg_settings_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(defaults_survive_a_round_trip),
    cmocka_unit_test(everything_survives_a_round_trip),
    cmocka_unit_test(blocks_come_in_any_order),
    cmocka_unit_test(messages_name_line_and_remedy),
    cmocka_unit_test(tables_are_checked_too),
    cmocka_unit_test(layers_are_a_setting_and_a_table),
    cmocka_unit_test(failure_leaves_the_settings_alone),
    cmocka_unit_test(patches_come_from_a_mesh),
    cmocka_unit_test(marks_given_settings),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
