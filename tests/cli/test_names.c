/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Suggestions for unknown names: the words of other mesh generators, and
 * misspellings of them and of the names of settings. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "cli/commands/commands.h"
#include "run/settings/deck.h"
#include "run/settings/names.h"
#include "run/settings/settings.h"

#define DECK VG_TMP_DIR "/names.deck"
#define HELP VG_TMP_DIR "/names.help"

static const char *setting_at(const void *user, size_t i)
{
  const char *name = NULL;
  int in_farfield;

  (void)user;
  vg_settings_name(i, &name, &in_farfield);
  return name;
}

static struct vg_names settings(void)
{
  struct vg_names names = { 0, setting_at, NULL };

  while (setting_at(NULL, names.n)) names.n++;
  return names;
}

/* The first suggestion for a word, or "". */
static const char *suggested(const char *word)
{
  static struct vg_suggestion s;

  vg_suggest_setting(word, &s);
  return s.n ? s.name[0] : "";
}

static void words_of_other_programs_are_known(void **state)
{
  static const char *const expect[][2] = {
    { "first_height", "first" },
    { "first-layer-thickness", "first" },
    { "firstLayerThickness", "first" },
    { "nSurfaceLayers", "layer_count" },
    { "num_layers", "layer_count" },
    { "expansionRatio", "ratio" },
    { "growth_rate", "ratio" },
    { "max_size", "hmax" },
    { "format", "write" },
    { "clmax", "hmax" },
    { "Mesh.MeshSizeMin", "hmin" },
    { "maxGlobalCells", "max_cells" },
    { "TotalThickness", "layer_total" },
    { "blds", "first" },
    { "reynolds number", "reynolds" },
    { "levels", "bisections" },
    { "cells per gap", "gap_edges" },
    { "BoundaryDecay", "growth" },
  };

  (void)state;
  for (size_t i = 0; i < sizeof expect / sizeof *expect; i++)
    assert_string_equal(suggested(expect[i][0]), expect[i][1]);
}

static void a_word_with_two_meanings_has_two_suggestions(void **state)
{
  char hint[VG_HINT_SIZE];
  struct vg_suggestion s;

  (void)state;
  vg_suggest_setting("growth-rate", &s);
  assert_string_equal(vg_hint(&s, "--", "none", hint),
                      "did you mean '--ratio' or '--growth'?");
  s.n = 0;
  assert_string_equal(vg_hint(&s, "--", "none", hint), "none");
}

/* --- every target exists ------------------------------------------------- */

static int is_option_of(const char *target,
                        int (*command)(int argc, char **argv))
{
  char title[] = "vanguard x", help[] = "--help", line[512], wanted[80];
  char *argv[] = { title, help, NULL };
  int found = 0, status;
  pid_t child;
  FILE *f;

  fflush(NULL);
  child = fork();
  assert_true(child >= 0);
  if (!child) {
    if (!freopen(HELP, "w", stdout)) _exit(1);
    command(2, argv);
    _exit(1);
  }
  waitpid(child, &status, 0);
  assert_true(WIFEXITED(status) && !WEXITSTATUS(status));
  snprintf(wanted, sizeof wanted, "--%s", target);
  for (char *c = wanted; *c; c++)
    if (*c == '_') *c = '-';
  f = fopen(HELP, "r");
  assert_non_null(f);
  while (fgets(line, sizeof line, f)) {
    const char *at = strstr(line, wanted);

    found |= at && strchr("= \n", at[strlen(wanted)]) != NULL;
  }
  fclose(f);
  remove(HELP);
  return found;
}

static int is_word(const struct vg_param *p, const char *target)
{
  int found = !strcmp(p->name, target) ||
              (p->type == VG_PARAM_FLAG &&
               (!strcmp(target, "yes") || !strcmp(target, "no")));

  for (size_t i = 0; p->words && p->words[i]; i++)
    found |= !strcmp(p->words[i], target);
  return found;
}

static int is_in_a_deck(const char *target)
{
  const struct vg_param *p;
  const char *name;
  int in_farfield;

  for (size_t i = 0; (p = vg_settings_name(i, &name, &in_farfield)); i++)
    if (!strcmp(name, target) || is_word(p, target)) return 1;
  for (int k = 0; k < VG_TABLE_N; k++) {
    const struct vg_setting_table *t = vg_settings_table(k);

    if (!strcmp(t->name, target)) return 1;
    for (size_t c = 0; c < t->n_column; c++)
      if (is_word(&t->column[c], target)) return 1;
  }
  return 0;
}

static void every_target_exists(void **state)
{
  static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
  } command[] = {
    { "mesh", vg_cmd_mesh },           { "surface", vg_cmd_surface },
    { "check", vg_cmd_check },         { "plan", vg_cmd_plan },
    { "partition", vg_cmd_partition }, { "sweep", vg_cmd_sweep },
    { "deck", vg_cmd_deck },           { "demo", vg_cmd_demo },
    { "serve", vg_cmd_serve },
  };
  const char *word, *target;
  size_t n = 0;

  (void)state;
  for (; (word = vg_field_word(n, &target)); n++) {
    int found = is_in_a_deck(target);

    for (size_t c = 0; c < sizeof command / sizeof *command && !found; c++)
      found = !strcmp(command[c].name, target) ||
              is_option_of(target, command[c].run);
    if (!found) fail_msg("%s: there is no '%s'", word, target);
  }
  assert_true(n > 100);
}

/* --- misspellings -------------------------------------------------------- */

static uint32_t next(uint32_t *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return *seed >> 8;
}

/* One random edit of a word: a letter inserted, omitted, replaced or exchanged
 * with the next one. */
static void misspell(uint32_t *seed, const char *word, char out[96])
{
  size_t n = strlen(word), at = next(seed) % n;
  const char letter = (char)('a' + next(seed) % 26);
  const uint32_t kind = next(seed) % 4;

  snprintf(out, 96, "%s", word);
  if (kind == 0) {
    memmove(out + at + 1, out + at, n - at + 1);
    out[at] = letter;
  } else if (kind == 1) {
    memmove(out + at, out + at + 1, n - at);
  } else if (kind == 2) {
    out[at] = letter;
  } else if (at + 1 < n) {
    out[at] = word[at + 1];
    out[at + 1] = word[at];
  }
}

/* Reference implementation of the edit distance, by recursion. */
static size_t edits(const char *a, const char *b, size_t limit)
{
  size_t best, d;

  if (!*a && !*b) return 0;
  if (!limit) return strcmp(a, b) ? 1 : 0;
  if (*a && *a == *b) return edits(a + 1, b + 1, limit);
  best = limit + 1;
  if (*a && (d = 1 + edits(a + 1, b, limit - 1)) < best) best = d;
  if (*b && (d = 1 + edits(a, b + 1, limit - 1)) < best) best = d;
  if (*a && *b && (d = 1 + edits(a + 1, b + 1, limit - 1)) < best) best = d;
  if (*a && *b && a[1] && b[1] && *a == b[1] && a[1] == *b &&
      (d = 1 + edits(a + 2, b + 2, limit - 1)) < best)
    best = d;
  return best;
}

static int is_field_word_for(const char *text, const char *target)
{
  const struct vg_names names = settings();
  struct vg_suggestion s;

  vg_suggest_field(text, &names, &s);
  for (size_t i = 0; i < s.n; i++)
    if (!strcmp(s.name[i], target)) return 1;
  return 0;
}

/* The suggestion for a misspelt setting is no farther from it than the setting
 * itself, or is what the misspelling means elsewhere. */
static void misspelt_settings_are_recognised(void **state)
{
  const struct vg_names names = settings();
  uint32_t seed = 7;
  size_t same = 0, n = 0;

  (void)state;
  for (int round = 0; round < 4000; round++) {
    const char *name = setting_at(NULL, next(&seed) % names.n), *found;
    char text[96];
    struct vg_suggestion s;

    if (strlen(name) < 4) continue;
    misspell(&seed, name, text);
    vg_suggest_setting(text, &s);
    if (!s.n) fail_msg("'%s' for '%s': no suggestion", text, name);
    found = s.name[0];
    same += !strcmp(found, name);
    n++;
    if (edits(text, found, 1) > 1 && !is_field_word_for(text, found))
      fail_msg("'%s' for '%s': '%s' is suggested", text, name, found);
  }
  print_message("%zu of %zu misspellings lead to the intended name\n", same, n);
  assert_true(same > 0.99 * (double)n);
}

/* The suggestion for a misspelt word of another program is its meaning, or a
 * name that is as near. */
static void misspelt_words_of_other_programs_too(void **state)
{
  uint32_t seed = 11;
  size_t n_word = 0, n = 0, meant = 0;
  const char *word, *target;

  (void)state;
  while (vg_field_word(n_word, &target)) n_word++;
  for (int round = 0; round < 4000; round++) {
    char text[96];
    struct vg_suggestion s;
    int is_target;

    word = vg_field_word(next(&seed) % n_word, &target);
    if (strlen(word) < 8 || !is_field_word_for(word, target)) continue;
    misspell(&seed, word, text);
    vg_suggest_setting(text, &s);
    n++;
    is_target = s.n && (!strcmp(s.name[0], target) ||
                        (s.n > 1 && !strcmp(s.name[1], target)));
    meant += is_target;
  }
  print_message("%zu of %zu misspellings lead to the meaning\n", meant, n);
  assert_true(meant > 0.98 * (double)n);
}

/* Random letters are rarely a misspelling of anything. */
static void nonsense_has_no_suggestion(void **state)
{
  uint32_t seed = 3;
  size_t some = 0, n = 5000;

  (void)state;
  for (size_t round = 0; round < n; round++) {
    char text[16] = "";
    size_t length = 3 + next(&seed) % 10;

    for (size_t i = 0; i < length; i++)
      text[i] = (char)('a' + next(&seed) % 26);
    some += *suggested(text) != 0;
  }
  print_message("%zu of %zu random words have a suggestion\n", some, n);
  assert_true(some < n / 20);
}

/* --- where suggestions are made ------------------------------------------ */

static void expect_refused(const char *deck, const char *message)
{
  struct vg_settings s = VG_SETTINGS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  FILE *f = fopen(DECK, "w");

  assert_non_null(f);
  fputs(deck, f);
  fclose(f);
  assert_true(vg_deck_read(DECK, &s, &err) < 0);
  remove(DECK);
  if (!strstr(err.text, message))
    fail_msg("'%s' lacks '%s'", err.text, message);
}

static void decks_suggest(void **state)
{
  (void)state;
  expect_refused("T\nnum_layers\n3\n", "did you mean 'layer_count'?");
  expect_refused("T\nfarfield_lengths\n3\n",
                 "did you mean the column lengths of the table farfield?");
  expect_refused("T\nfarfield.lengths\n3\n",
                 "did you mean the column lengths of the table farfield?");
  expect_refused("T\nsources\ntype x y\n", "did you mean 'kind'?");
  expect_refused("T\nrepair\ntrue\n", "did you mean 'yes'?");
}

static void json_decks_suggest(void **state)
{
  (void)state;
  expect_refused("{\"settings\":{\"first_height\":1}}",
                 "did you mean 'first'?");
  expect_refused("{\"grwoth\":2}", "did you mean 'settings.growth'?");
  expect_refused("{\"growth\":2}", "give it as a member of 'settings'");
  expect_refused("{\"settings\":{\"farfield\":\"box\"}}",
                 "'farfield' is a table; give it outside of 'settings'");
  expect_refused("{\"settings\":{\"farfield_mach\":2}}",
                 "did you mean 'farfield.mach'?");
  expect_refused("{\"farfield\":{\"radius\":2}}", "did you mean 'lengths'?");
  expect_refused("{\"refinement_regions\":[]}", "did you mean 'sources'?");
}

static void rows_and_settings_suggest(void **state)
{
  static const char *const column[] = { "type" }, *const value[] = { "box" };
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  vg_settings_default(&s);
  assert_true(vg_settings_set(&s, "growth-rate", "2", &err) < 0);
  assert_non_null(strstr(err.text, "did you mean 'ratio' or 'growth'?"));
  assert_true(vg_settings_add_named(&s, "sources", 1, column, value, &err) < 0);
  assert_non_null(strstr(err.text, "did you mean 'kind'?"));
  assert_true(vg_settings_add_named(&s, "source", 1, column, value, &err) < 0);
  assert_non_null(strstr(err.text, "did you mean 'sources'?"));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(words_of_other_programs_are_known),
    cmocka_unit_test(a_word_with_two_meanings_has_two_suggestions),
    cmocka_unit_test(every_target_exists),
    cmocka_unit_test(misspelt_settings_are_recognised),
    cmocka_unit_test(misspelt_words_of_other_programs_too),
    cmocka_unit_test(nonsense_has_no_suggestion),
    cmocka_unit_test(decks_suggest),
    cmocka_unit_test(json_decks_suggest),
    cmocka_unit_test(rows_and_settings_suggest),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
