/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard sweep: runs vanguard mesh over a grid of parameters. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "cli/sweep/sweep.h"
#include "io/stream/stream.h"
#include "run/common/folder.h"
#include "run/common/progress.h"
#include "run/common/text.h"
#include "run/input/input.h"
#include "run/settings/deck.h"

enum {
  KEY_LEAF_CELLS = 300,
  KEY_REPEAT,
  KEY_LAUNCHER,
  KEY_KEEP,
  KEY_PROGRAM,
  KEY_DECOMPOSE,
  KEY_PARTS,
  KEY_FAMILY,
  KEY_PLANNED
};

/* Lists that are given by an option or by the deck. */
enum { RANKS, THREADS, LEVELS, LEAF_CELLS, PARTS, FAMILY, N_LIST };
static const struct {
  const char *option, *column;
  int64_t lo, hi;
} lists[N_LIST] = { { "--ranks", "ranks", 1, 1000000 },
                    { "--threads", "threads", 1, 1000 },
                    { "--bisections", "bisections", 0, 40 },
                    { "--leaf-cells", "leaf_cells", 1, 1000000000000 },
                    { "--subdomains", "subdomains", 1, 1000000 },
                    { "--family", "family", 1, 100 } };

static struct vg_range_list *list_of(struct vg_sweep_options *o, int k)
{
  return k == RANKS      ? &o->ranks
       : k == THREADS    ? &o->threads
       : k == LEVELS     ? &o->bisections
       : k == LEAF_CELLS ? &o->leaf_cells
       : k == FAMILY     ? &o->family
                         : &o->subdomains;
}

static void range(int k, const char *text, struct vg_sweep_options *o,
                  const struct argp_state *state)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_range_parse(lists[k].option, text, lists[k].lo, lists[k].hi,
                     list_of(o, k), &err) < 0)
    argp_error(state, "%s", err.text);
}

static void ways(const char *text, struct vg_sweep_options *o,
                 const struct argp_state *state)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_sweep_ways("--decompose", text, o, &err) < 0)
    argp_error(state, "%s", err.text);
}

static void family(const char *text, struct vg_sweep_options *o,
                   const struct argp_state *state)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_sweep_take_family("--family", text, o, &err) < 0)
    argp_error(state, "%s", err.text);
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct vg_sweep_options *o = state->input;
  int64_t n;

  switch (key) {
  case 'p': o->project = arg; return 0;
  case 'd': o->deck = arg; return 0;
  case 'o': o->dir = arg; return 0;
  case 'L': range(LEVELS, arg, o, state); return 0;
  case KEY_LEAF_CELLS: range(LEAF_CELLS, arg, o, state); return 0;
  case KEY_PARTS: range(PARTS, arg, o, state); return 0;
  case KEY_DECOMPOSE: ways(arg, o, state); return 0;
  case KEY_FAMILY: family(arg, o, state); return 0;
  case KEY_PLANNED: o->levels_planned = arg; return 0;
  case 'n': range(RANKS, arg, o, state); return 0;
  case 't': range(THREADS, arg, o, state); return 0;
  case KEY_REPEAT:
    if (!vg_parse_int(arg, strlen(arg), &n) || n < 1 || n > 1000)
      argp_error(state, "--repeat takes an integer from 1 to 1000, not '%s'",
                 arg);
    o->repeat = (int)n;
    return 0;
  case KEY_LAUNCHER: o->launcher = arg; return 0;
  case KEY_PROGRAM: o->program = arg; return 0;
  case KEY_KEEP: o->keep = 1; return 0;
  case 'j': o->json = 1; return 0;
  case 'q': o->quiet = 1; return 0;
  case ARGP_KEY_ARG:
    if (o->project)
      argp_error(state,
                 "only one project is accepted: %s; put options "
                 "for vanguard mesh after '--'",
                 arg);
    o->project = arg;
    return 0;
  case ARGP_KEY_END:
    if (!o->project) argp_error(state, "no project given; use -p PROJECT");
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

/* --- the deck ------------------------------------------------------------ */

/* Read list k from the deck. */
static vg_status take_list(const char *deck, int k, const char *text,
                           struct vg_sweep_options *o, struct vg_error *err)
{
  char what[400];

  if (!*text) return VG_OK;
  snprintf(what, sizeof what, "%.300s: sweep: %s", deck, lists[k].column);
  if (k == FAMILY) return vg_sweep_take_family(what, text, o, err);
  return vg_range_parse(what, text, lists[k].lo, lists[k].hi, list_of(o, k),
                        err);
}

/* Take the lists of the deck that no option gives. Levels, leaf sizes, methods
 * and numbers of subdomains are alternatives: if an option gives one of them,
 * none of them is taken from the deck. */
static vg_status take_row(const char *deck, const struct vg_sweep_row *row,
                          struct vg_sweep_options *o, struct vg_error *err)
{
  const char *text[N_LIST] = { row->ranks,      row->threads,
                               row->bisections, row->leaf_cells,
                               row->subdomains, row->family };
  char what[400];
  int given[N_LIST];
  vg_status st = VG_OK;

  for (int k = 0; k < N_LIST; k++) given[k] = list_of(o, k)->n > 0;
  given[LEVELS] = given[LEAF_CELLS] = given[PARTS] = given[LEVELS] ||
                                                     given[LEAF_CELLS] ||
                                                     given[PARTS] || o->n_way;
  snprintf(what, sizeof what, "%.300s: sweep: decompose", deck);
  if (!given[PARTS] && *row->decompose)
    st = vg_sweep_ways(what, row->decompose, o, err);
  for (int k = 0; k < N_LIST && st >= 0; k++)
    if (!given[k]) st = take_list(deck, k, text[k], o, err);
  if (!o->repeat) o->repeat = (int)row->repeat;
  return st;
}

/* Read the sweep table of the deck. If the project is not found, the runs will
 * report it. */
static vg_status take_deck(struct vg_sweep_options *o, struct vg_error *err)
{
  struct vg_problem p = VG_PROBLEM_INIT;
  const char *deck = o->deck;
  vg_status st = VG_OK;

  vg_settings_default(&p.asked);
  if (vg_input_find(o->project, NULL, &p.read.files, NULL) >= 0) {
    if (!deck) deck = p.read.files.deck;
    o->is_plane = p.read.files.is_section;
  }
  if (deck && *deck) st = vg_deck_read(deck, &p.asked, err);
  if (st >= 0 && vg_settings_unit(&p.asked))
    vg_settings_convert(&p.asked, vg_settings_unit(&p.asked));
  if (st >= 0 && p.read.files.surface && *p.read.files.surface)
    o->is_plane |= vg_problem_is_section(&p);
  o->scale = p.asked.scale;
  o->reynolds = p.asked.layer.reynolds;
  o->length = p.asked.layer.length;
  o->layer_count = p.asked.layer.count;
  o->sets_farfield = p.asked.farfield.kind != VG_DOMAIN_NONE &&
                     p.asked.farfield.kind != VG_DOMAIN_MACH;
  if (st >= 0 && p.asked.n_sweep) st = take_row(deck, &p.asked.sweep, o, err);
  if (st >= 0 && !o->ranks.n)
    st = vg_range_parse("--ranks", "1", 1, 1, &o->ranks, err);
  if (st >= 0 && !o->threads.n)
    st = vg_range_parse("--threads", "1", 1, 1, &o->threads, err);
  if (st >= 0 && o->levels_planned)
    st = vg_sweep_take_planned(o->levels_planned, o, err);
  if (o->rule != VG_FAMILY_PLAIN) o->keep = 1;
  if (!o->repeat) o->repeat = 1;
  vg_problem_release(&p);
  return st;
}

static void print_value(double v, int width, int digits)
{
  if (isfinite(v)) printf(" %*.*f", width, digits, v);
  else printf(" %*s", width, "-");
}

/* Width of the column of names. */
static int name_width(const struct vg_sweep *s)
{
  int width = 4;

  for (size_t i = 0; i < s->n; i++)
    if ((int)strlen(s->item[i].name) > width)
      width = (int)strlen(s->item[i].name);
  return width;
}

static void print_head(int width)
{
  printf("%-*s ranks threads   seconds speed-up  eff. %% cut+fill imbal. "
         "idle %%       cells digest\n",
         width, "case");
}

static void print_case(const struct vg_sweep *s, const struct vg_sweep_case *c,
                       int width)
{
  double seconds = c->is_done ? vg_sweep_seconds(c) : NAN;
  double speedup = vg_sweep_speedup(s, seconds);
  const struct vg_spans *t = c->has_timeline ? &c->t.spans : NULL;
  char cells[32];

  printf("%-*s %5d %7d", width, c->name, c->ranks, c->threads);
  if (!c->is_done) {
    printf(" %s, status %d: %s\n", c->is_run ? "failed" : "not run",
           c->exit_status, c->note);
    return;
  }
  print_value(seconds, 9, 2);
  print_value(speedup, 8, 2);
  print_value(100 * speedup / (c->ranks * c->threads), 7, 1);
  print_value(t ? t->wall : NAN, 8, 2);
  print_value(t ? vg_spans_imbalance(t) : NAN, 6, 3);
  print_value(t ? 100 * (1 - vg_spans_busy(t)) : NAN, 6, 1);
  printf(" %11s %.8s%s%s\n", t ? vg_text_count(c->t.n_cell, cells) : "-",
         c->digest[0] ? c->digest : "-", c->note[0] ? "  " : "", c->note);
}

/* Comparison of the decompositions. */
static void print_parts(const struct vg_sweep *s, int width)
{
  printf("\n%-*s subdom. balance decomp. s cut+fill critical  idle %%    cells "
         "/ adv.  1st perc. near  of all\n",
         width, "case");
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_sweep_case *c = &s->item[i];
    const struct vg_sweep_parts *m = &c->parts_made;
    const struct vg_spans *t = c->has_timeline ? &c->t.spans : NULL;

    if (!c->is_done) continue;
    printf("%-*s", width, c->name);
    print_value(m->n_part, 6, 0);
    print_value(m->balance, 7, 3);
    print_value(m->seconds, 9, 2);
    print_value(t ? t->wall : NAN, 8, 2);
    print_value(c->critical, 8, 2);
    print_value(t ? 100 * (1 - vg_spans_busy(t)) : NAN, 7, 1);
    print_value(vg_sweep_cells_ratio(s, c), 15, 4);
    print_value(m->near_p1, 15, 2);
    print_value(m->all_p1, 7, 2);
    printf("\n");
  }
}

/* Returns the exit status. */
static int conclude(const struct vg_sweep *s)
{
  const struct vg_sweep_case *a, *b;
  size_t n_done = 0, compared;
  char file[64];
  FILE *to = s->o->json ? stderr : stdout;

  for (size_t i = 0; i < s->n; i++) n_done += (size_t)s->item[i].is_done;
  fprintf(to, "\n%zu of %zu cases done; tables and figures in %s\n", n_done,
          s->n, s->o->dir);
  if (vg_sweep_differ(s, &compared, &a, &b, file)) {
    fprintf(to, "Digests DIFFER: %s differs between %s and %s\n", file, a->name,
            b->name);
    return VG_EXIT_LIMIT;
  }
  if (compared)
    fprintf(to,
            "Digests agree: equal mesh options gave identical files "
            "(%zu compared)\n",
            compared);
  else
    fprintf(to, "Digests were not compared: no two cases have equal mesh "
                "options and digests\n");
  if (n_done == s->n) return VG_EXIT_DONE;
  fprintf(stderr,
          "vanguard: %zu of %zu cases of the sweep are not done; the log of "
          "each is %s/CASE/run.log\n",
          s->n - n_done, s->n, s->o->dir);
  return VG_EXIT_FAILED;
}

static vg_status run_all(struct vg_sweep *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->n && st >= 0; i++) {
    struct vg_sweep_case *c = &s->item[i];

    if (!s->o->quiet) fprintf(stderr, "%zu of %zu: %s\n", i + 1, s->n, c->name);
    st = vg_sweep_run(s->o, c, err);
    if (c->is_run) vg_sweep_collect(s->o, c);
  }
  return st;
}

/* A sweep that was stopped reports the cases that it has finished. */
static int run(struct vg_sweep_options *o)
{
  struct vg_sweep s = { .n = 0 };
  struct vg_display show;
  struct vg_error err = VG_ERROR_INIT, why = VG_ERROR_INIT;
  int status = VG_EXIT_FAILED;
  vg_status st, ran;

  vg_display_init(&show, o->quiet);
  VG_TRY(take_deck(o, &err));
  VG_TRY(vg_sweep_plan(o, &s, &err));
  VG_TRY(vg_make_folder(o->dir, &err));
  ran = run_all(&s, &why);
  VG_TRY(vg_sweep_write(&s, &err));
  VG_TRY(vg_sweep_draw(&s, &err));
  if (!o->json) {
    int width = name_width(&s);

    print_head(width);
    for (size_t i = 0; i < s.n; i++) print_case(&s, &s.item[i], width);
    if (o->n_way || o->subdomains.n) print_parts(&s, width);
    vg_sweep_family_text(stdout, &s);
    vg_sweep_named_text(stdout, &s);
  }
  status = conclude(&s);
  if (ran < 0) status = vg_cli_fail(&why);
done:
  vg_sweep_release(&s);
  return st < 0 ? vg_cli_fail(&err) : status;
}

static const struct argp_option options[] = {
  { "project", 'p', "PROJECT", 0,
    "Stem of the project files, or the full name of a surface file, as for "
    "'vanguard mesh'",
    1 },
  { "deck", 'd', "FILE", 0,
    "Run deck, also passed to vanguard mesh; lists that no "
    "option gives are taken from its table sweep [default PROJECT.deck if it "
    "exists]",
    1 },
  { "bisections", 'L', "LIST", 0,
    "Numbers of successive bisections, as in 1,2,4 or 3:7 or "
    "2:10:2",
    2 },
  { "leaf-cells", KEY_LEAF_CELLS, "LIST", 0,
    "Cells per subdomain; these cases are run in addition to those of "
    "--bisections [default: as for vanguard mesh]",
    2 },
  { "decompose", KEY_DECOMPOSE, "LIST", 0,
    "Decomposition methods, as in advancing,discrete,octree; each is run with "
    "every entry of --subdomains, in addition to the cases of the other lists "
    "[default: as for vanguard mesh]",
    2 },
  { "subdomains", KEY_PARTS, "LIST", 0, "Numbers of subdomains", 2 },
  { "ranks", 'n', "LIST", 0, "Numbers of ranks [default 1]", 2 },
  { "threads", 't', "LIST", 0, "Numbers of threads per rank [default 1]", 2 },
  { "family", KEY_FAMILY, "LIST", 0,
    "Levels of a grid family, as in 1:3: "
    "all edge lengths are multiplied by 2/(level + 1), and layers follow the "
    "rule of the AIAA Drag Prediction Workshops (--scale, --scale-layers "
    "workshop). dpw:1-6 and hlpw:A-F: with y+, growth, farfield and files of "
    "these workshops and their form of grid metrics",
    2 },
  { "planned", KEY_PLANNED, "LEVELS", 0,
    "Levels of such a workshop's family that are planned rather than meshed, "
    "as in E,F",
    2 },
  { "repeat", KEY_REPEAT, "K", 0,
    "Number of runs of each case [default "
    "1]",
    2 },
  { "launcher", KEY_LAUNCHER, "COMMAND", 0,
    "Command that starts the ranks, as in "
    "'srun -n {ranks} -c {threads}' [default 'mpirun -n {ranks} --bind-to "
    "none', none for one rank]",
    3 },
  { "out", 'o', "DIR", 0,
    "Folder for tables, figures and one folder per "
    "case [default sweep]",
    3 },
  { "keep", KEY_KEEP, NULL, 0,
    "Keep all meshes [default: keep only reports, timelines "
    "and logs]",
    3 },
  { "json", 'j', NULL, 0, "Write the table as JSON to standard output", 3 },
  { "quiet", 'q', NULL, 0, "Do not show progress", 3 },
  { "program", KEY_PROGRAM, "FILE", OPTION_HIDDEN,
    "Program to run instead of this one (for tests)", 3 },
  { 0 }
};

int vg_cmd_sweep(int argc, char **argv)
{
  const struct argp argp = {
    .options = options,
    .parser = option,
    .args_doc = "-p PROJECT [-- MESH-OPTION...]",
    .doc =
      "Run vanguard mesh for all combinations of decompositions (--bisections, "
      "--leaf-cells or --decompose), ranks and threads, and compare them. The "
      "results are sweep.csv and sweep.json with times, balance and digests, "
      "and plots of the speed-up, the phases, the timeline of each run and "
      "the sizes of its leaves.\v"
      "Options after '--' are passed to vanguard mesh. Speed-ups are relative "
      "to the first case with one worker or, if no case has one worker, to "
      "the one with the fewest workers, whose efficiency is taken as 100 %. "
      "A case that fails "
      "is listed with its message; its log is DIR/CASE/run.log. Exit status: "
      "0 success, 1 a case failed, 2 wrong usage, 4 equal mesh options gave "
      "different files."
  };
  struct vg_sweep_options o = { .dir = "sweep" };
  int status;

  o.n_extra = vg_cli_split(&argc, argv, &o.extra);
  vg_cli_parse(&argp, argc, argv, &o);
  status = run(&o);
  for (int k = 0; k < N_LIST; k++) vg_range_release(list_of(&o, k));
  vg_range_release(&o.planned);
  return status;
}
