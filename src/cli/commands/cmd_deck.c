/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard deck: a commented run deck with every setting at its default, as
 * text or JSON; the JSON Schema of decks. */
#define _GNU_SOURCE
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/settings/deck.h"
#include "run/settings/deck_json.h"

struct arguments {
  const char *surface, *output, *deck;
  int json, schema;
};

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case 'o': a->output = arg; return 0;
  case 'd': a->deck = arg; return 0;
  case 'j': a->json = 1; return 0;
  case 's': a->schema = 1; return 0;
  case ARGP_KEY_ARG:
    if (a->surface) argp_error(state, "only one surface is accepted: %s", arg);
    a->surface = arg;
    return 0;
  case ARGP_KEY_END:
    if (a->deck && a->surface)
      argp_error(state, "give either a surface or --deck");
    if (a->schema && (a->deck || a->surface || a->json))
      argp_error(state, "--schema takes no surface, deck or --json");
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

/* Add the patches of the surface to the settings; its sources stay in the
 * .d3m. */
static vg_status describe(const char *name, struct vg_settings *out,
                          struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  const char *base;
  vg_status st;

  VG_TRY(vg_problem_open(&p, name, "", err));
  VG_TRY(vg_problem_read(&p, NULL, NULL, err));
  base = strrchr(p.read.files.stem, '/');
  snprintf(out->title, sizeof out->title, "Run deck of %s",
           base ? base + 1 : p.read.files.stem);
  vg_text_trim_end(out->title);
  st = vg_deck_patches_of(vg_problem_surface(&p), out, err);
done:
  vg_problem_release(&p);
  return st;
}

static vg_status write_json(const char *path, json_t *o, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (!o) return vg_fail_memory(err, "the settings");
  if (path) st = vg_json_write(path, o, "the settings", err);
  else st = vg_json_print(stdout, o, vg_json_digits(o), "the settings", err);
  json_decref(o);
  return st;
}

/* Write the deck to a temporary file and copy it to standard output. */
static vg_status to_stdout(const struct vg_settings *s, enum vg_deck_form form,
                           struct vg_error *err)
{
  char path[] = P_tmpdir "/vanguard-deck-XXXXXX", part[4096];
  int fd = mkstemp(path);
  FILE *f;
  size_t n;
  vg_status st;

  if (fd < 0) return vg_fail(err, VG_ERR_IO, "cannot write in " P_tmpdir);
  close(fd);
  st = vg_deck_write(path, s, NULL, form, err);
  f = st < 0 ? NULL : fopen(path, "r");
  while (f && (n = fread(part, 1, sizeof part, f)) > 0)
    fwrite(part, 1, n, stdout);
  if (st >= 0 && (!f || ferror(f)))
    st = vg_fail(err, VG_ERR_IO, "%s: cannot read: %s", path, strerror(errno));
  if (f) fclose(f);
  unlink(path);
  return st;
}

static vg_status refuse_existing(const char *path, struct vg_error *err)
{
  if (!path || access(path, F_OK)) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s exists and is not overwritten; remove it or choose "
                 "another name",
                 path);
}

/* A deck that was read is converted; a new one explains its settings. */
static vg_status write_deck(const struct arguments *a, struct vg_error *err)
{
  struct vg_settings s;
  const enum vg_deck_form form = a->deck ? VG_DECK_ALL : VG_DECK_EXPLAINED;
  vg_status st = VG_OK;

  vg_settings_default(&s);
  snprintf(s.title, sizeof s.title, "Run deck");
  if (a->deck) VG_TRY(vg_deck_read(a->deck, &s, err));
  if (a->surface) VG_TRY(describe(a->surface, &s, err));
  if (a->json) st = write_json(a->output, vg_deck_json(&s), err);
  else if (a->output) st = vg_deck_write(a->output, &s, NULL, form, err);
  else st = to_stdout(&s, form, err);
done:
  vg_settings_release(&s);
  return st;
}

static const struct argp_option options[] = {
  { "deck", 'd', "FILE", 0, "Convert this deck, a text or a JSON document", 0 },
  { "json", 'j', NULL, 0, "Write the deck as a JSON document", 0 },
  { "output", 'o', "FILE", 0, "File to write [default: standard output]", 0 },
  { "schema", 's', NULL, 0,
    "Write the JSON Schema of decks: all settings and tables with types, "
    "ranges, units and defaults",
    0 },
  { 0 }
};

int vg_cmd_deck(int argc, char **argv)
{
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "[SURFACE]",
    .doc = "Write a run deck with every setting, its unit and default, and "
           "the patch table of SURFACE (a file or the stem of a project); or "
           "convert a deck."
  };
  struct vg_error err = VG_ERROR_INIT;
  struct arguments a = { 0 };
  vg_status st;

  vg_cli_parse(&argp, argc, argv, &a);
  st = refuse_existing(a.output, &err);
  if (st >= 0)
    st = a.schema ? write_json(a.output, vg_deck_schema(), &err)
                  : write_deck(&a, &err);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
