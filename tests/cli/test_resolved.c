/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Requested, read and resolved settings: the steps of a run leave `asked`
 * unchanged, and a run with resolved settings resolves to the same settings. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/flow/flow.h"
#include "run/layers/layers.h"
#include "run/settings/plan_options.h"

#define TEXT (2 * VG_LIST_MAX + 4)
#define MOST 120 /* settings */

static struct vg_mesh cube(void)
{
  static const double at[8][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 },
                                   { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
                                   { 1, 1, 1 }, { 0, 1, 1 } };
  static const uint32_t tri[12][3] = { { 0, 2, 1 }, { 0, 3, 2 }, { 4, 5, 6 },
                                       { 4, 6, 7 }, { 0, 1, 5 }, { 0, 5, 4 },
                                       { 1, 2, 6 }, { 1, 6, 5 }, { 2, 3, 7 },
                                       { 2, 7, 6 }, { 3, 0, 4 }, { 3, 4, 7 } };
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = 8;
  m.n_tri = 12;
  m.point = malloc(sizeof at);
  m.tri = malloc(sizeof tri);
  m.tri_patch = calloc(12, sizeof *m.tri_patch);
  assert_true(m.point && m.tri && m.tri_patch);
  memcpy(m.point, at, sizeof at);
  memcpy(m.tri, tri, sizeof tri);
  for (size_t i = 2; i < 4; i++) m.tri_patch[i] = 1;
  assert_int_equal(vg_mesh_add_patch(&m, 1, "sides"), 0);
  assert_int_equal(vg_mesh_add_patch(&m, 2, "roof"), 1);
  return m;
}

/* All steps up to the resolved settings, including the layer stage. */
static void run(struct vg_problem *p)
{
  const struct vg_shape_options o = { .threads = 1 };
  struct vg_layer_stage layers = VG_LAYER_STAGE_INIT;
  struct vg_mesh m = cube();
  struct vg_display show;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_display_init(&show, 1);
  VG_TRY(vg_problem_given(p, "cube", &m, &err));
  VG_TRY(vg_boundary_shape(&p->read, &o, &show, &p->boundary, &err));
  VG_TRY(vg_boundary_close(&p->boundary, &show, &err));
  VG_TRY(vg_layer_stage_plan(&layers, &p->boundary, &err));
  VG_TRY(vg_problem_settle(p, &layers, &err));
done:
  if (st < 0) fail_msg("%s", err.text);
  vg_layer_stage_release(&layers);
}

static void ask(struct vg_settings *s)
{
  static const struct {
    const char *name, *value;
  } want[] = { { "y_plus", "1" },
               { "reynolds", "1e6" },
               { "reference_length", "1" },
               { "walls", "sides" },
               { "farfield_lengths", "3" } };
  struct vg_error err = VG_ERROR_INIT;

  vg_settings_default(s);
  for (size_t i = 0; i < sizeof want / sizeof *want; i++)
    assert_int_equal(vg_settings_set(s, want[i].name, want[i].value, &err),
                     VG_OK);
}

static size_t take(const struct vg_settings *s, char text[MOST][TEXT])
{
  struct vg_error err = VG_ERROR_INIT;
  const char *name;
  size_t n = 0;
  int far;

  for (; vg_settings_name(n, &name, &far); n++) {
    assert_true(n < MOST);
    assert_int_equal(vg_settings_get(s, name, text[n], TEXT, &err), VG_OK);
  }
  return n;
}

static void requested_settings_stay_unchanged(void **state)
{
  static char before[MOST][TEXT], after[MOST][TEXT];
  struct vg_problem p = VG_PROBLEM_INIT;
  size_t n;

  (void)state;
  ask(&p.asked);
  n = take(&p.asked, before);
  run(&p);
  assert_int_equal(take(&p.asked, after), n);
  for (size_t i = 0; i < n; i++) assert_string_equal(before[i], after[i]);
  assert_int_equal(p.asked.n_patch + p.asked.n_layer + p.asked.n_source, 0);
  vg_problem_release(&p);
}

static void decisions_are_resolved(void **state)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  const struct vg_settings *s = &p.resolved.settings;

  (void)state;
  ask(&p.asked);
  run(&p);
  assert_int_equal(s->flow, VG_FLOW_EXTERNAL);
  assert_int_equal(s->half, VG_HALF_NO);
  assert_int_equal(s->farfield.kind, VG_DOMAIN_SPHERE);
  assert_int_equal(s->remesh, VG_ANSWER_NO);
  assert_int_not_equal(s->swap, VG_ANSWER_AUTO);
  assert_string_equal(s->write, "cogsg,b8.ugrid");
  assert_int_equal(s->layer.grow, VG_ANSWER_YES);
  assert_true(s->layer.first > 0 && s->layer.y_plus == 0);
  assert_true(s->layer.cap == VG_LAYER_CAP);
  assert_string_equal(s->layer.walls, "");
  assert_int_equal(s->n_patch, 2);
  assert_int_equal(s->n_layer, 2);
  assert_int_equal(s->layer_row[0].grow, VG_ANSWER_YES);
  assert_int_equal(s->layer_row[1].grow, VG_ANSWER_NO);
  vg_problem_release(&p);
}

static void assert_same_rows(const struct vg_settings *a,
                             const struct vg_settings *b,
                             enum vg_table_kind kind)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  char x[TEXT], y[TEXT];

  assert_int_equal(vg_settings_rows(a, kind), vg_settings_rows(b, kind));
  for (size_t i = 0; i < vg_settings_rows(a, kind); i++)
    for (size_t c = 0; c < t->n_column; c++) {
      vg_param_format(&t->column[c], vg_settings_row(a, kind, i), x, sizeof x);
      vg_param_format(&t->column[c], vg_settings_row(b, kind, i), y, sizeof y);
      if (strcmp(x, y) != 0)
        fail_msg("%s, row %zu, %s: %s, %s", t->name, i, t->column[c].name, x,
                 y);
    }
}

static void resolved_settings_resolve_to_themselves(void **state)
{
  static char once[MOST][TEXT], twice[MOST][TEXT];
  struct vg_problem p = VG_PROBLEM_INIT, q = VG_PROBLEM_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t n;

  (void)state;
  ask(&p.asked);
  run(&p);
  assert_int_equal(vg_settings_copy(&q.asked, &p.resolved.settings, &err),
                   VG_OK);
  run(&q);
  n = take(&p.resolved.settings, once);
  assert_int_equal(take(&q.resolved.settings, twice), n);
  for (size_t i = 0; i < n; i++) assert_string_equal(once[i], twice[i]);
  for (int k = 0; k < VG_TABLE_N; k++)
    assert_same_rows(&p.resolved.settings, &q.resolved.settings,
                     (enum vg_table_kind)k);
  vg_problem_release(&q);
  vg_problem_release(&p);
}

/* Options that several stages derive from the settings. */
static void options_follow_from_settings(void **state)
{
  struct vg_settings s;
  struct vg_partition_options o;

  (void)state;
  vg_settings_default(&s);
  s.leaf_cells = 7000;
  s.split_direction = 2;
  o = vg_options_partition(&s);
  assert_true(o.rule.leaf_cells == 7000 && o.rule.first_axis == 1);
  assert_int_equal(o.decomposition.n_part, 0);
  s.bisections = 3;
  s.subdomains = 5;
  o = vg_options_partition(&s);
  assert_true(o.rule.leaf_cells == 0 && o.levels == 3);
  assert_int_equal(o.decomposition.n_part, 5);
  s.hmax = 0.5;
  s.surface_size = 0.2;
  s.scale = 2;
  assert_true(vg_options_remesh(&s).h_max == 0.2);
  assert_true(vg_options_gaps(&s, 0).h_max == 0.4);
  assert_true(vg_options_gaps(&s, 0).most_tri == 0);
  s.max_cells = 1000;
  assert_true(vg_options_gaps(&s, 1).most_tri == 1000);
  s.surface_size = 0.7;
  assert_true(vg_options_remesh(&s).h_max == 0.5);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(requested_settings_stay_unchanged),
    cmocka_unit_test(decisions_are_resolved),
    cmocka_unit_test(resolved_settings_resolve_to_themselves),
    cmocka_unit_test(options_follow_from_settings),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
