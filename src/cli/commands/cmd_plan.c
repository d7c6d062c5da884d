/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard plan: forecasts a run, also on other machines. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "cli/plan/plan.h"
#include "io/stream/stream.h"

enum {
  KEY_RANKS_PER_NODE = 300,
  KEY_LATENCY,
  KEY_BANDWIDTH,
  KEY_RATE,
  KEY_SERIAL,
  KEY_ROAM,
  KEY_LOOPS,
  KEY_PLOT,
  KEY_TARGET,
  KEY_DEPTH,
  KEY_RATES,
  KEY_CORES
};

enum { DEPTH_MAX = 40 };

static void number(const char *name, const char *text, double lo, double *out,
                   const struct argp_state *state)
{
  if (!vg_parse_real(text, strlen(text), out) || *out < lo)
    argp_error(state, "--%s takes a number of at least %g, not '%s'", name, lo,
               text);
}

static void range(const char *name, const char *text, struct vg_range_list *out,
                  const struct argp_state *state)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_range_parse(name, text, 1, VG_MODEL_WORKERS_MAX, out, &err) < 0)
    argp_error(state, "%s", err.text);
}

static int whole(const char *name, const char *text, int64_t lo, int64_t hi,
                 const struct argp_state *state)
{
  int64_t n;

  if (!vg_parse_int(text, strlen(text), &n) || n < lo || n > hi)
    argp_error(state, "--%s takes an integer of at least %d, not '%s'", name,
               (int)lo, text);
  return (int)n;
}

/* Whether `schedule`, which only assigns tasks to workers, is the only setting
 * given. */
static int is_schedule(const struct vg_cli_overrides *kept)
{
  for (size_t i = 0; i < kept->n; i++)
    if (kept->set[i].key != vg_cli_option_key("schedule")) return 0;
  return 1;
}

static void check_end(const struct vg_plan_options *o,
                      const struct argp_state *state)
{
  if (!o->replay && !o->project)
    argp_error(state, "no run given; use -p PROJECT, or --replay "
                      "FILE.timeline.json");
  if (o->replay && o->project)
    argp_error(state, "give either a project or --replay, not both");
  if (o->replay && o->rates)
    argp_error(state, "--rates needs a project; --replay uses the times of "
                      "its timeline");
  if (o->replay && o->cores)
    argp_error(state, "--cores needs a project; use --ranks, --threads and "
                      "--ranks-per-node with --replay");
  if (o->cores &&
      (o->threads.v[o->threads.n - 1] > 1 || o->machine.ranks_per_node > 1))
    argp_error(state, "--cores tries all combinations of ranks and threads "
                      "that fill a node; omit --threads and "
                      "--ranks-per-node");
  if (o->replay && (!is_schedule(&o->kept) || o->deck || o->target > 0))
    argp_error(state, "--replay takes no settings, deck or target other than "
                      "--schedule, since the tasks are those of the timeline");
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct vg_plan_options *o = state->input;

  switch (key) {
  case 'r': o->replay = arg; return 0;
  case 'p': o->project = arg; return 0;
  case 'd': o->deck = arg; return 0;
  case 'q': o->quiet = 1; return 0;
  case 'n': range("--ranks", arg, &o->ranks, state); return 0;
  case 't': range("--threads", arg, &o->threads, state); return 0;
  case 'j': o->json = 1; return 0;
  case KEY_PLOT: o->plot = arg; return 0;
  case KEY_RANKS_PER_NODE:
    o->machine.ranks_per_node = whole("ranks-per-node", arg, 1,
                                      VG_MODEL_WORKERS_MAX, state);
    return 0;
  case KEY_CORES: o->cores = whole("cores", arg, 1, 4096, state); return 0;
  case KEY_DEPTH: o->depth = whole("depth", arg, 0, DEPTH_MAX, state); return 0;
  case KEY_TARGET: number("target", arg, 1e-3, &o->target, state); return 0;
  case KEY_LATENCY:
    number("latency", arg, 0, &o->machine.latency, state);
    return 0;
  case KEY_BANDWIDTH:
    number("bandwidth", arg, 1, &o->machine.bandwidth, state);
    return 0;
  case KEY_RATE: number("rate", arg, 1e-6, &o->machine.rate, state); return 0;
  case KEY_RATES: o->rates = arg; return 0;
  case KEY_SERIAL: number("serial", arg, 0, &o->serial, state); return 0;
  case KEY_LOOPS:
    o->machine.loop_threads = whole("loop-threads", arg, 1,
                                    VG_MODEL_WORKERS_MAX, state);
    return 0;
  case KEY_ROAM: o->machine.joins_roam = 1; return 0;
  case 'L': key = vg_cli_option_key("bisections"); break;
  case ARGP_KEY_ARG:
    if (o->project) argp_error(state, "only one project is accepted: %s", arg);
    o->project = arg;
    return 0;
  case ARGP_KEY_END: check_end(o, state); return 0;
  default: break;
  }
  return vg_cli_add_override(&o->kept, key, arg, state);
}

static const struct argp_option own[] = {
  { "project", 'p', "PROJECT", 0,
    "Stem of the project files, or the full name of a surface file, as for "
    "'vanguard mesh'",
    VG_GROUP_COMMON },
  { "deck", 'd', "FILE", 0, "Run deck [default PROJECT.deck if it exists]",
    VG_GROUP_COMMON },
  { "replay", 'r', "FILE", 0,
    "Replay the timeline of a run, as written by 'vanguard mesh "
    "--timeline'",
    VG_GROUP_COMMON },
  { "ranks", 'n', "LIST", 0,
    "Numbers of ranks, as in 1,2,4 or 3:7 or 1:64:x2 "
    "[default 1:512:x2]",
    VG_GROUP_COMMON },
  { "threads", 't', "LIST", 0,
    "Numbers of threads per rank; idle threads help with front updates "
    "(joins), so the cores of a node perform better as one rank than as ranks "
    "with one thread each [default 1]",
    VG_GROUP_COMMON },
  { "ranks-per-node", KEY_RANKS_PER_NODE, "N", 0,
    "Number of ranks per node; there is no latency between them, and they "
    "share the surface check, sizing field and layers [default 1]",
    VG_GROUP_COMMON },
  { "cores", KEY_CORES, "N", 0,
    "Number of cores per node; --ranks are then numbers of nodes, all "
    "combinations of ranks and threads that fill a node are tried, and the "
    "best is shown with its mpirun line; for a project only",
    VG_GROUP_COMMON },
  { "latency", KEY_LATENCY, "S", 0, "Time per message [s, default 2e-6]",
    VG_GROUP_COMMON },
  { "bandwidth", KEY_BANDWIDTH, "B", 0,
    "Bandwidth of the link of a rank "
    "[bytes/s, default 1e10]",
    VG_GROUP_COMMON },
  { "rate", KEY_RATE, "X", 0,
    "Speed of a core relative to that of the timeline; without a timeline, "
    "relative to the core on which the built-in rates were measured [default "
    "1]",
    VG_GROUP_COMMON },
  { "rates", KEY_RATES, "FILE", 0,
    "Fit the times per cell and face by least squares to the timeline of a "
    "run on this machine [default: rates of the machine named in "
    "docs/lab/performance-parallel.md]",
    VG_GROUP_COMMON },
  { "target", KEY_TARGET, "S", 0,
    "Find the smallest machine that needs at most S seconds; for a project "
    "only [default: the largest machine with at least 80 % efficiency]",
    VG_GROUP_COMMON },
  { "serial", KEY_SERIAL, "S", 0,
    "Time outside the tasks that is not parallel [s, default: the phases of "
    "the timeline, parallel within a node or over all workers; without a "
    "timeline, estimated from the times of reading, checking and sizing now]",
    VG_GROUP_COMMON },
  { "joins-roam", KEY_ROAM, NULL, 0,
    "Let any rank perform front updates (joins), not only the home rank",
    VG_GROUP_COMMON },
  { "loop-threads", KEY_LOOPS, "N", 0,
    "Largest number of threads that speed up loops of front updates; they "
    "share the memory bandwidth of a rank [default 16]",
    VG_GROUP_COMMON },
  { "json", 'j', NULL, 0,
    "Write the forecast as JSON to standard output, with "
    "the whole decomposition tree",
    VG_GROUP_COMMON },
  { "depth", KEY_DEPTH, "N", 0,
    "Levels of the decomposition tree to show "
    "[default 2]",
    VG_GROUP_COMMON },
  { "quiet", 'q', NULL, 0, "Do not show progress", VG_GROUP_COMMON },
  { "plot", KEY_PLOT, "FILE", 0, "Write a plot of the speed-up (SVG)",
    VG_GROUP_COMMON },
  { NULL, 'L', "N", 0, "Same as --bisections", VG_GROUP_COMMON },
  { 0 }
};

int vg_cmd_plan(int argc, char **argv)
{
  struct vg_cli_options options;
  struct argp argp = {
    .parser = option,
    .args_doc = "-p PROJECT\n--replay FILE [--schedule dynamic|cyclic]",
    .doc =
      "Forecast the mesh of a project and the time of its run before "
      "it is meshed, or the time of a recorded run on other machines. "
      "The schedule is simulated: an idle worker takes the next task, cuts "
      "before fills, expensive tasks first.\v"
      "Columns of the forecast: speed-up is relative to one worker with the "
      "same tasks; critical is the critical path, the longest chain of "
      "dependent tasks and a lower bound of the time; cuts end is the time at "
      "which the last cut is finished; cuts is the share of the work spent on "
      "cuts, and extra the part of it that the same cells would not have "
      "cost in leaves."
  };
  struct vg_plan_options o = { .machine = VG_MACHINE_INIT,
                               .serial = -1,
                               .depth = 2 };
  struct vg_error err = VG_ERROR_INIT;
  int status;

  if (vg_range_parse("--ranks", "1:512:x2", 1, 512, &o.ranks, &err) < 0 ||
      vg_range_parse("--threads", "1", 1, 1, &o.threads, &err) < 0)
    return vg_cli_fail(&err);
  if (vg_cli_options(own, &options, &err) < 0) return vg_cli_fail(&err);
  /* --threads is a list in this command, so the setting is hidden. */
  for (size_t i = 0; i < options.n; i++)
    if (options.option[i].key == vg_cli_option_key("threads"))
      options.option[i].flags |= OPTION_HIDDEN;
  argp.options = options.option;
  vg_cli_parse(&argp, argc, argv, &o);
  status = o.replay ? vg_plan_replay(&o) : vg_plan_estimate(&o);
  vg_cli_options_free(&options);
  free(o.kept.set);
  vg_range_release(&o.ranks);
  vg_range_release(&o.threads);
  return status;
}
