/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard adapt: the loop of mesh, flow solver and metric. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/lock/lock.h"
#include "cli/adapt/adapt.h"
#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "io/stream/stream.h"
#include "run/common/folder.h"
#include "run/common/json_file.h"
#include "run/common/progress.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/settings/deck.h"

enum { KEY_COLUMN = 500, KEY_LAUNCHER = 400, KEY_PROGRAM };

/* Columns of the table adapt that are options too, in the order of their
 * keys. */
static const char *const columns[] = { "solver",    "field", "norm",
                                       "cycles",    "cells", "cells_ratio",
                                       "growth",    "h_min", "h_max",
                                       "aspect_max" };
enum { N_COLUMN = sizeof columns / sizeof *columns };

struct arguments {
  struct vg_adapt_options o;
  const char *value[N_COLUMN]; /* by options; NULL: not given */
  char *stem;                  /* of a deck in place of the project */
};

/* --- options -------------------------------------------------------------- */

/* LOOP.deck stands for the project LOOP with this deck. */
static void take_project(char *arg, struct arguments *a,
                         const struct argp_state *state)
{
  if (vg_text_ends(arg, ".deck") && !a->o.deck) {
    a->o.deck = arg;
    return;
  }
  if (a->o.project)
    argp_error(state,
               "only one project is accepted: %s; put options for vanguard "
               "mesh after '--'",
               arg);
  a->o.project = arg;
}

static int whole(const char *arg, const char *name, int most,
                 const struct argp_state *state)
{
  int64_t n = 0;

  if (!vg_parse_int(arg, strlen(arg), &n) || n < 1 || n > most)
    argp_error(state, "--%s takes an integer from 1 to %d, not '%s'", name,
               most, arg);
  return (int)n;
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;

  if (key >= KEY_COLUMN && key < KEY_COLUMN + N_COLUMN) {
    a->value[key - KEY_COLUMN] = arg;
    return 0;
  }
  switch (key) {
  case 'p': a->o.project = arg; return 0;
  case 'd': a->o.deck = arg; return 0;
  case 'o': a->o.dir = arg; return 0;
  case 'n': a->o.ranks = whole(arg, "ranks", 1000000, state); return 0;
  case 't': a->o.threads = whole(arg, "threads", 1000, state); return 0;
  case KEY_LAUNCHER: a->o.launcher = arg; return 0;
  case KEY_PROGRAM: a->o.program = arg; return 0;
  case 'j': a->o.json = 1; return 0;
  case 'q': a->o.quiet = 1; return 0;
  case ARGP_KEY_ARG: take_project(arg, a, state); return 0;
  case ARGP_KEY_END:
    if (!a->o.project && !a->o.deck)
      argp_error(state, "no project given; use -p PROJECT or LOOP.deck");
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

static vg_status set_column(const char *name, const char *text,
                            struct vg_adapt_row *row, struct vg_error *err)
{
  const struct vg_setting_table *t = vg_settings_table(VG_TABLE_ADAPT);
  struct vg_error why = VG_ERROR_INIT;
  vg_status st = VG_ERR_USAGE;

  for (size_t c = 0; c < t->n_column; c++)
    if (!strcmp(t->column[c].name, name))
      st = vg_param_set(&t->column[c], row, text, strlen(text), &why);
  return st < 0 ? vg_fail(err, VG_ERR_USAGE, "%s", why.text) : VG_OK;
}

/* The table of the deck, then the options. */
static vg_status take_row(struct arguments *a, struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  vg_status st = VG_OK;

  vg_settings_default(&p.asked);
  if (!a->o.project) {
    a->stem = strndup(a->o.deck, strlen(a->o.deck) - strlen(".deck"));
    a->o.project = a->stem;
    if (!a->stem) VG_TRY(vg_fail_memory(err, "a file name"));
  }
  if (a->o.deck) VG_TRY(vg_deck_read(a->o.deck, &p.asked, err));
  a->o.row = p.asked.adapt;
  for (int k = 0; k < N_COLUMN; k++)
    if (a->value[k])
      VG_TRY(set_column(columns[k], a->value[k], &a->o.row, err));
done:
  vg_problem_release(&p);
  return st;
}

/* --- the loop ------------------------------------------------------------- */

static vg_status write_all(const struct vg_adapt *a, struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_adapt_write_csv(a, err));
  st = vg_adapt_write_page(a, err);
done:
  return st;
}

static vg_status claim(const struct vg_adapt *a, char **path, int *fd,
                       struct vg_error *err)
{
  char holder[VG_LOCK_HOLDER] = "";
  vg_status st = vg_folder_path(a->dir, "adapt.lock", path, err);

  if (st < 0) return st;
  st = vg_lock_take(AT_FDCWD, *path, fd, holder);
  if (st == VG_BLOCKED)
    return vg_fail(err, VG_ERR_IO, "another loop runs in %s: %s", a->dir,
                   holder);
  return st < 0 ? vg_fail(err, VG_ERR_IO, "%s: cannot be created", *path)
                : VG_OK;
}

static int show(const struct vg_adapt *a, struct vg_error *err)
{
  json_t *o;
  vg_status st = VG_OK;

  if (a->o->json) {
    o = vg_adapt_json(a);
    st = vg_json_print(stdout, o, 0, "the record of the loop", err);
    json_decref(o);
  } else {
    vg_adapt_print(stdout, a);
    printf("\n  %s/adapt.html\n  %s/adapt.csv\n  %s/adapt.json\n", a->o->dir,
           a->o->dir, a->o->dir);
  }
  return st < 0 ? vg_cli_fail(err) : VG_EXIT_DONE;
}

static int run(struct arguments *args)
{
  struct vg_adapt a = { .o = NULL };
  struct vg_display display;
  struct vg_error err = VG_ERROR_INIT, why = VG_ERROR_INIT;
  char *lock = NULL;
  int fd = -1, status = VG_EXIT_FAILED;
  vg_status st, ran;

  vg_display_init(&display, args->o.quiet);
  VG_TRY(take_row(args, &err));
  VG_TRY(vg_adapt_open(&args->o, &a, &err));
  VG_TRY(claim(&a, &lock, &fd, &err));
  ran = vg_adapt_run(&a, &why);
  VG_TRY(write_all(&a, &err));
  status = show(&a, &err);
  if (ran < 0) status = vg_cli_fail(&why);
done:
  if (fd >= 0) vg_lock_drop(AT_FDCWD, lock, fd);
  free(lock);
  vg_adapt_release(&a);
  free(args->stem);
  return st < 0 ? vg_cli_fail(&err) : status;
}

static const struct argp_option options[] = {
  { "project", 'p', "PROJECT", 0,
    "Stem of the project files, or the full name of a surface file, as for "
    "'vanguard mesh'",
    1 },
  { "deck", 'd', "FILE", 0,
    "Run deck, also passed to vanguard mesh; its table adapt has the settings "
    "of the loop, which options override",
    1 },
  { "solver", KEY_COLUMN, "COMMAND", 0,
    "Program that computes the flow on the mesh of a cycle, with its "
    "arguments; {ranks} and {threads} are replaced",
    2 },
  { "field", KEY_COLUMN + 1, "LIST", 0,
    "Fields of the solution that the metric resolves, as for 'vanguard "
    "metric'; without it only first heights follow the solution",
    2 },
  { "norm", KEY_COLUMN + 2, "P", 0, "Norm L^P of the error [default 2]", 2 },
  { "cycles", KEY_COLUMN + 3, "N", 0,
    "Number of meshes and solutions; more than before continue a loop [default "
    "4]",
    2 },
  { "cells", KEY_COLUMN + 4, "N", 0,
    "Number of cells outside of layers of the second mesh [default: that of "
    "the first]",
    2 },
  { "cells-ratio", KEY_COLUMN + 5, "RATIO", 0,
    "Factor on this number from cycle to cycle [default 2]", 2 },
  { "metric-growth", KEY_COLUMN + 6, "RATE", 0,
    "Growth of the metric [default 1.5]", 2 },
  { "h-min", KEY_COLUMN + 7, "LENGTH", 0, "Least edge length", 2 },
  { "h-max", KEY_COLUMN + 8, "LENGTH", 0, "Largest edge length", 2 },
  { "aspect-max", KEY_COLUMN + 9, "RATIO", 0,
    "Largest ratio of two edge lengths at a point [default 100]", 2 },
  { "ranks", 'n', "N", 0, "Ranks of the mesher [default 1]", 3 },
  { "threads", 't', "N", 0, "Threads per rank of the mesher", 3 },
  { "launcher", KEY_LAUNCHER, "COMMAND", 0,
    "Command that starts the ranks of the mesher, as in 'srun -n {ranks} -c "
    "{threads}' [default 'mpirun -n {ranks} --bind-to none', none for one "
    "rank]",
    3 },
  { "out", 'o', "DIR", 0,
    "Folder of the loop, with one folder per cycle [default adapt]", 3 },
  { "json", 'j', NULL, 0, "Write the record as JSON to standard output", 3 },
  { "quiet", 'q', NULL, 0, "Do not show progress", 3 },
  { "program", KEY_PROGRAM, "FILE", OPTION_HIDDEN,
    "Program to run instead of this one (for tests)", 3 },
  { 0 }
};

int vg_cmd_adapt(int argc, char **argv)
{
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "LOOP.deck [-- MESH-OPTION...]\n-p PROJECT [-- MESH-OPTION...]",
    .doc =
      "Run cycles of vanguard mesh, a flow solver and vanguard metric: each "
      "mesh follows the solution on the previous one. The results are one "
      "folder per cycle, adapt.csv, adapt.json and adapt.html with the output "
      "quantities over the number of cells.\v"
      "Options after '--' are passed to vanguard mesh. A loop that was stopped "
      "or failed is continued by the same command. Exit status: 0 success, 1 "
      "a step failed, 2 wrong usage."
  };
  struct arguments a = { .o = { .dir = "adapt", .ranks = 1 } };

  a.o.n_extra = vg_cli_split(&argc, argv, &a.o.extra);
  vg_cli_parse(&argp, argc, argv, &a);
  return run(&a);
}
