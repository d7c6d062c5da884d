/* vanguard deck: a commented run deck with every setting at its default. */
#define _GNU_SOURCE
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/settings/deck.h"

struct arguments {
  const char *surface, *output;
};

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  switch (key) {
  case 'o': a->output = arg; return 0;
  case ARGP_KEY_ARG:
    if (a->surface) argp_error(state, "only one surface is accepted: %s", arg);
    a->surface = arg;
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

/* Write the deck to a temporary file and copy it to standard output. */
static vg_status to_stdout(const struct vg_settings *s, struct vg_error *err)
{
  char path[] = P_tmpdir "/vanguard-deck-XXXXXX", part[4096];
  int fd = mkstemp(path);
  FILE *f;
  size_t n;
  vg_status st;

  if (fd < 0) return vg_fail(err, VG_ERR_IO, "cannot write in " P_tmpdir);
  close(fd);
  st = vg_deck_write(path, s, NULL, 1, err);
  f = st < 0 ? NULL : fopen(path, "r");
  while (f && (n = fread(part, 1, sizeof part, f)) > 0)
    fwrite(part, 1, n, stdout);
  if (f) fclose(f);
  unlink(path);
  return st;
}

int vg_cmd_deck(int argc, char **argv)
{
  const struct argp_option options[] = {
    { "output", 'o', "FILE", 0, "File to write [default: standard output]", 0 },
    { 0 }
  };
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "[SURFACE]",
    .doc = "Write a run deck with every setting, its unit and default, and "
           "the patch table of SURFACE (a file or the stem of a project)."
  };
  struct vg_settings s;
  struct vg_error err = VG_ERROR_INIT;
  struct arguments a = { 0 };
  vg_status st = VG_OK;

  vg_cli_parse(&argp, argc, argv, &a);
  vg_settings_default(&s);
  snprintf(s.title, sizeof s.title, "Run deck");
  if (a.surface) st = describe(a.surface, &s, &err);
  if (st >= 0 && a.output && access(a.output, F_OK) == 0)
    st = vg_fail(&err, VG_ERR_INPUT,
                 "%s exists and is not overwritten; "
                 "remove it or choose another name",
                 a.output);
  if (st >= 0)
    st = a.output ? vg_deck_write(a.output, &s, NULL, 1, &err)
                  : to_stdout(&s, &err);
  vg_settings_release(&s);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
