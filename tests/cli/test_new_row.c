/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A new setting is one row of run/settings/setting_rows.h: this program
 * compiles the settings with three additional rows (tests/cli/new_row) and no
 * other change. Default, deck, command line, help, digest and the check of a
 * resumed run must include them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "cli/common/options.h"
#include "run/settings/deck.h"
#include "run/stages/run.h"

#define DECK VG_TMP_DIR "/new_row.deck"

static void has_its_default(void **state)
{
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;
  char text[80];

  (void)state;
  vg_settings_default(&s);
  assert_true(s.tip_size == 0.125);
  assert_int_equal(s.layer.tip_sweeps, 3);
  assert_string_equal(s.tip_name, "none");
  assert_int_equal(vg_settings_get(&s, "tip_size", text, sizeof text, &err),
                   VG_OK);
  assert_string_equal(text, "0.125");
}

static void set(struct vg_settings *s)
{
  struct vg_error err = VG_ERROR_INIT;

  vg_settings_default(s);
  assert_int_equal(vg_settings_set(s, "tip-size", "0.5", &err), VG_OK);
  assert_int_equal(vg_settings_set(s, "tip_sweeps", "7", &err), VG_OK);
  assert_int_equal(vg_settings_set(s, "tip_name", "left wing", &err), VG_OK);
  assert_true(vg_settings_set(s, "tip_size", "2", &err) < 0);
  assert_non_null(strstr(err.text, "at most 1"));
}

static void is_in_the_deck(void **state)
{
  struct vg_settings s, back = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  char text[65536];
  size_t n;
  FILE *f;

  (void)state;
  set(&s);
  assert_int_equal(vg_deck_write(DECK, &s, NULL, VG_DECK_EXPLAINED, &err),
                   VG_OK);
  assert_int_equal(vg_deck_read(DECK, &back, &err), VG_OK);
  assert_true(back.tip_size == 0.5);
  assert_int_equal(back.layer.tip_sweeps, 7);
  assert_string_equal(back.tip_name, "left wing");
  f = fopen(DECK, "r");
  assert_non_null(f);
  n = fread(text, 1, sizeof text - 1, f);
  text[n] = 0;
  fclose(f);
  remove(DECK);
  assert_non_null(strstr(text, "edge at the tip [length, default 0.125]"));
  assert_non_null(strstr(text, "sweeps at the tip [sweeps, default 3]"));
  vg_settings_release(&back);
}

static void is_an_option(void **state)
{
  static const struct argp_option none[] = { { 0 } };
  struct vg_cli_options options;
  struct vg_cli_overrides kept = { 0 };
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;
  int key = vg_cli_option_key("tip_size"), found = 0;

  (void)state;
  assert_true(vg_cli_options(none, &options, NULL) >= 0);
  for (size_t i = 0; i < options.n; i++)
    if (options.option[i].key == key) {
      found++;
      assert_string_equal(options.option[i].name, "tip-size");
      assert_string_equal(options.option[i].arg, "LENGTH");
      assert_string_equal(options.option[i].doc,
                          "edge at the tip [length, default 0.125]");
    }
  assert_int_equal(found, 1);
  vg_cli_options_free(&options);
  assert_int_equal(vg_cli_add_override(&kept, key, "0.25", NULL), 0);
  vg_settings_default(&s);
  assert_int_equal(vg_cli_apply(&kept, &s, &err), VG_OK);
  assert_true(s.tip_size == 0.25);
  free(kept.set);
}

static struct vg_digest digest_of(const struct vg_settings *s)
{
  struct vg_digest d;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_run_settings_digest(s, &d, &err), VG_OK);
  return d;
}

static int same(struct vg_digest a, struct vg_digest b)
{
  return !memcmp(&a, &b, sizeof a);
}

/* The value of a setting in the file of settings in a run directory; "" if it
 * has no line. */
static const char *line_of(const struct vg_settings *s, const char *name,
                           char *out, size_t size)
{
  const struct vg_mesh empty = VG_MESH_INIT;
  char *text = vg_run_settings(s, &empty), key[80], *at;

  assert_non_null(text);
  snprintf(key, sizeof key, "\n%s=", name);
  at = strstr(text, key);
  *out = 0;
  if (at)
    snprintf(out, size, "%.*s", (int)strcspn(at + strlen(key), "\n"),
             at + strlen(key));
  free(text);
  return out;
}

static void affects_the_mesh_as_its_row_declares(void **state)
{
  struct vg_settings s;
  struct vg_digest plain;
  char line[80];

  (void)state;
  vg_settings_default(&s);
  plain = digest_of(&s);
  assert_string_equal(line_of(&s, "tip_size", line, sizeof line), "0.125");
  assert_string_equal(line_of(&s, "tip_sweeps", line, sizeof line), "");
  s.layer.tip_sweeps = 4;
  assert_true(same(plain, digest_of(&s)));
  s.tip_size = 0.25;
  assert_false(same(plain, digest_of(&s)));
  assert_string_equal(line_of(&s, "tip_size", line, sizeof line), "0.25");
  s.tip_size = 0.125;
  snprintf(s.tip_name, sizeof s.tip_name, "tail");
  assert_false(same(plain, digest_of(&s)));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(has_its_default),
    cmocka_unit_test(is_in_the_deck),
    cmocka_unit_test(is_an_option),
    cmocka_unit_test(affects_the_mesh_as_its_row_declares),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
