/* vanguard plan: what a run would take on other machines. */
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
    argp_error(state, "--%s takes a number from %g, not '%s'", name, lo, text);
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
    argp_error(state, "--%s takes a whole number from %d, not '%s'", name,
               (int)lo, text);
  return (int)n;
}

/* Does nothing else decide than who does which task? */
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
    argp_error(state, "which run? give -p PROJECT, or --replay "
                      "FILE.timeline.json");
  if (o->replay && o->project)
    argp_error(state, "either a project or a --replay, not both");
  if (o->replay && o->rates)
    argp_error(state, "--rates are for a project: a --replay has its own "
                      "times");
  if (o->replay && o->cores)
    argp_error(state, "--cores are for a project: a --replay takes --ranks, "
                      "--threads and --ranks-per-node");
  if (o->cores &&
      (o->threads.v[o->threads.n - 1] > 1 || o->machine.ranks_per_node > 1))
    argp_error(state, "--cores tries all ranks per node and threads that fill "
                      "a node: leave --threads and --ranks-per-node out");
  if (o->replay && (!is_schedule(&o->kept) || o->deck || o->target > 0))
    argp_error(state, "a --replay takes no settings, deck or target, but for "
                      "--schedule: the tasks are those of the record");
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
  case 'L': key = vg_cli_option_key("levels"); break;
  case ARGP_KEY_ARG:
    if (o->project) argp_error(state, "one project at a time: %s", arg);
    o->project = arg;
    return 0;
  case ARGP_KEY_END: check_end(o, state); return 0;
  default: break;
  }
  return vg_cli_add_override(&o->kept, key, arg, state);
}

static const struct argp_option own[] = {
  { "project", 'p', "PROJECT", 0,
    "path and name without extension, or one "
    "surface file, as for 'vanguard mesh'",
    1 },
  { "deck", 'd', "FILE", 0, "run deck [default PROJECT.deck if it exists]", 1 },
  { "replay", 'r', "FILE", 0,
    "record of a run, as 'vanguard mesh "
    "--timeline' writes it",
    1 },
  { "ranks", 'n', "LIST", 0,
    "numbers of ranks: 1,2,4 or 3:7 or 1:64:x2 "
    "[default 1:512:x2]",
    1 },
  { "threads", 't', "LIST", 0,
    "threads of each rank [default 1]; those "
    "that are idle help with joins, so that a node's cores as one rank do "
    "more than as ranks of one thread",
    1 },
  { "ranks-per-node", KEY_RANKS_PER_NODE, "N", 0,
    "ranks that share a "
    "node: no latency between them, check, sizes and layers made together "
    "[default 1]",
    1 },
  { "cores", KEY_CORES, "N", 0,
    "cores of a node: --ranks are numbers of "
    "nodes, and of all ways to share their cores among ranks and threads "
    "the best is named with its mpirun line; of a project only",
    1 },
  { "latency", KEY_LATENCY, "S", 0, "seconds per message [default 2e-6]", 1 },
  { "bandwidth", KEY_BANDWIDTH, "B", 0,
    "bytes per second of a rank's link "
    "[default 1e10]",
    1 },
  { "rate", KEY_RATE, "X", 0,
    "speed of a core over the recorded one; "
    "without a record over the one that the times were measured on "
    "[default 1]",
    1 },
  { "rates", KEY_RATES, "FILE", 0,
    "take the seconds per cell and face of "
    "this machine from the record of a run on it, by least squares "
    "[default: those of the machine that docs/lab/performance-parallel.md "
    "names]",
    1 },
  { "target", KEY_TARGET, "S", 0,
    "find the smallest machine that needs no "
    "more than S seconds; of a project only, a --replay shows all of "
    "--ranks and --threads [default: the largest that is 80 % efficient]",
    1 },
  { "serial", KEY_SERIAL, "S", 0,
    "seconds outside the tasks, which no "
    "workers share [default: phases of the record, shared by a node or by "
    "all; without one by the times of reading, checking and sizes now]",
    1 },
  { "joins-roam", KEY_ROAM, NULL, 0,
    "joins are done by any rank, not at "
    "their home",
    1 },
  { "loop-threads", KEY_LOOPS, "N", 0,
    "most threads that make loops of "
    "joins faster, since they share the memory of a rank [default 16]",
    1 },
  { "json", 'j', NULL, 0,
    "forecast as JSON on standard output, with "
    "the whole tree",
    1 },
  { "depth", KEY_DEPTH, "N", 0,
    "levels of the tree of cuts that are shown "
    "[default 2]",
    1 },
  { "quiet", 'q', NULL, 0, "no progress", 1 },
  { "plot", KEY_PLOT, "FILE", 0, "figure of the speed-up (SVG)", 1 },
  { NULL, 'L', "N", 0, "the same as --levels", 1 },
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
      "anything is meshed, or the time of a recorded run on other machines. "
      "Tasks are simulated: who is idle takes the next one, cuts before "
      "fills, heavy ones first.\v"
      "Speed-up is against one worker of the same tasks; critical is the "
      "longest chain of tasks that wait for each other, which no machine of "
      "such ranks can go below; cuts end is when the last cut has been made, "
      "cuts the share of the work that cuts are, extra the share beyond what "
      "their cells "
      "would have taken in leaves."
  };
  struct vg_plan_options o = { .machine = VG_MACHINE_INIT,
                               .serial = -1,
                               .depth = 2 };
  struct vg_error err = VG_ERROR_INIT;
  int status;

  if (vg_range_parse("--ranks", "1:512:x2", 1, 512, &o.ranks, &err) < 0 ||
      vg_range_parse("--threads", "1", 1, 1, &o.threads, &err) < 0)
    return vg_cli_fail(&err);
  if (vg_cli_options(own, &options) < 0) {
    vg_fail_memory(&err, "the options");
    return vg_cli_fail(&err);
  }
  /* --threads is a list here */
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
