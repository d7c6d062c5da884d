/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Which settings a resumed run may change: every value of every row of every
 * table is changed in turn, and the run directory of the unchanged settings is
 * opened with it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "partition/store/store.h"
#include "run/stages/run.h"

#define DIR VG_TMP_DIR "/resume.run"

/* The rows that do not affect the mesh; all other rows do. */
static const struct {
  const char *table, *rows;
} keeps[] = {
  { "",
    " rank_silence "
    " cad_seconds helpers max_cells max_memory write report_html ugrid_tail "
    "solver_parts schedule threads min_full min_any min_height max_first_error "
    "max_top_ratio max_non_orthogonality max_skewness min_face_weight "
    "min_orthogonal_quality median_dual min_dual_orthogonality " },
  { "layers", " min_full min_any min_height max_first_error max_top_ratio " },
  { "sources", " bn alpha group " },
  { "sweep", " ranks threads bisections leaf_cells decompose subdomains family "
             "repeat " },
  { "adapt", " solver field norm cycles cells cells_ratio growth h_min h_max "
             "aspect_max " },
};

static int is_listed(const char *table, const char *row)
{
  char word[80];

  snprintf(word, sizeof word, " %s ", row);
  for (size_t i = 0; i < sizeof keeps / sizeof *keeps; i++)
    if (!strcmp(keeps[i].table, table))
      return strstr(keeps[i].rows, word) != NULL;
  return 0;
}

/* Set a value that differs from the present one. */
static void change(const struct vg_param *p, void *base)
{
  static const char *const value[] = { "yes",      "no",     "0.25", "1.5",
                                       "2",        "7",      "20",   "3,5",
                                       "b8.ugrid", "./x.so", "4000" };
  char was[600], is[600];
  struct vg_error err = VG_ERROR_INIT;

  vg_param_format(p, base, was, sizeof was);
  for (size_t i = 0; p->words && p->words[i]; i++)
    if (strcmp(p->words[i], was) != 0) {
      assert_int_equal(vg_param_set(p, base, p->words[i], strlen(p->words[i]),
                                    &err),
                       VG_OK);
      return;
    }
  for (size_t i = 0; i < sizeof value / sizeof *value; i++) {
    if (vg_param_set(p, base, value[i], strlen(value[i]), &err) < 0) continue;
    vg_param_format(p, base, is, sizeof is);
    if (strcmp(is, was) != 0) return;
  }
  fail_msg("no other value of %s", p->name);
}

/* One row in each table. */
static void fill(struct vg_settings *s)
{
  struct vg_error err = VG_ERROR_INIT;

  vg_settings_default(s);
  for (int k = 0; k < VG_TABLE_N; k++) {
    const enum vg_table_kind kind = (enum vg_table_kind)k;
    void *row = calloc(1, vg_settings_table(kind)->row_size);

    assert_non_null(row);
    vg_settings_row_default(kind, row);
    assert_int_equal(vg_settings_add(s, kind, row, &err), VG_OK);
    free(row);
  }
}

static vg_status open_run(const struct vg_settings *s, int resume,
                          struct vg_store **out, struct vg_error *err)
{
  const struct vg_mesh empty = VG_MESH_INIT;
  struct vg_store_options o = { .dir = DIR, .resume = resume, .what = "run" };
  char *lines = vg_run_settings(s, &empty);
  vg_status st;

  assert_non_null(lines);
  o.settings = lines;
  assert_int_equal(vg_run_settings_digest(s, &o.job, err), VG_OK);
  st = vg_store_open(NULL, &o, out, err);
  free(lines);
  return st;
}

/* Check whether a run with these settings may be resumed; a refusal must name
 * the setting. */
static void resume(const struct vg_settings *s, const char *table,
                   const struct vg_param *p)
{
  struct vg_store *store = NULL;
  struct vg_error err = VG_ERROR_INIT;
  char name[80];
  vg_status st = open_run(s, 1, &store, &err);

  if (p->keeps_mesh != is_listed(table, p->name))
    fail_msg("%s %s: is it a setting that decides the mesh?", table, p->name);
  if (p->keeps_mesh) {
    if (st < 0) fail_msg("%s %s: refused: %s", table, p->name, err.text);
    vg_store_close(store, 0);
    return;
  }
  if (st >= 0) fail_msg("%s %s: not refused", table, p->name);
  snprintf(name, sizeof name, "%s%s%s was",
           !*table                      ? ""
           : !strcmp(table, "farfield") ? "farfield "
                                        : "table ",
           strcmp(table, "farfield") != 0 && *table ? table : "",
           !*table || !strcmp(table, "farfield") ? p->name : "");
  if (!strstr(err.text, name)) fail_msg("'%s' lacks '%s'", err.text, name);
}

static void every_row_obeys_its_flag(void **state)
{
  struct vg_settings s;
  struct vg_store *store = NULL;
  struct vg_error err = VG_ERROR_INIT;
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  (void)state;
  assert_int_equal(system("rm -rf " DIR), 0); /* left by a failed test */
  fill(&s);
  assert_int_equal(open_run(&s, 0, &store, &err), VG_OK);
  vg_store_keep(store, (struct vg_digest){ { 1, 2 } }, 4, "kept");
  vg_store_close(store, 0);
  assert_int_equal(open_run(&s, 1, &store, &err), VG_OK);
  vg_store_close(store, 0);
  for (size_t i = 0; i < n; i++) {
    struct vg_settings other = s;

    change(&p[i], &other);
    resume(&other, "", &p[i]);
  }
  for (int k = 0; k < VG_TABLE_N; k++) {
    const enum vg_table_kind kind = (enum vg_table_kind)k;
    const struct vg_setting_table *t = vg_settings_table(kind);

    for (size_t c = 0; c < t->n_column; c++) {
      struct vg_settings other = VG_SETTINGS_INIT;

      assert_int_equal(vg_settings_copy(&other, &s, &err), VG_OK);
      change(&t->column[c],
             (void *)(uintptr_t)vg_settings_row(&other, kind, 0));
      resume(&other, t->name, &t->column[c]);
      vg_settings_release(&other);
    }
  }
  assert_int_equal(open_run(&s, 1, &store, &err), VG_OK);
  vg_store_close(store, 1);
  vg_settings_release(&s);
}

/* An additional row in a table changes the digest. */
static void an_additional_row_changes_the_digest(void **state)
{
  struct vg_settings s, more = VG_SETTINGS_INIT;
  struct vg_digest a, b;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  fill(&s);
  assert_int_equal(vg_settings_copy(&more, &s, &err), VG_OK);
  assert_int_equal(vg_settings_add(&more, VG_TABLE_SOURCES, s.source, &err),
                   VG_OK);
  assert_int_equal(vg_run_settings_digest(&s, &a, &err), VG_OK);
  assert_int_equal(vg_run_settings_digest(&more, &b, &err), VG_OK);
  assert_true(memcmp(&a, &b, sizeof a) != 0);
  vg_settings_release(&more);
  vg_settings_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(every_row_obeys_its_flag),
    cmocka_unit_test(an_additional_row_changes_the_digest),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
