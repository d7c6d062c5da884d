/* vanguard plan: what a run would take on other machines. */
#include <stdio.h>
#include <string.h>

#include "cli/cli.h"
#include "cli/plan.h"
#include "io/stream.h"

enum { KEY_RANKS_PER_NODE = 300, KEY_LATENCY, KEY_BANDWIDTH, KEY_RATE,
       KEY_SERIAL, KEY_ROAM, KEY_PLOT };

static void number(const char *name, const char *text, double lo, double *out,
                   const struct argp_state *state)
{
  if (!vg_parse_real(text, strlen(text), out) || *out < lo)
    argp_error(state, "--%s takes a number from %g, not '%s'", name, lo,
               text);
}

static void range(const char *name, const char *text, struct vg_range *out,
                  const struct argp_state *state)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_range_parse(name, text, 1, VG_MODEL_WORKERS_MAX, out, &err) < 0)
    argp_error(state, "%s", err.text);
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct vg_plan_options *o = state->input;
  int64_t n;

  switch (key) {
  case 'r': o->replay = arg; return 0;
  case 'n': range("--ranks", arg, &o->ranks, state); return 0;
  case 't': range("--threads", arg, &o->threads, state); return 0;
  case 'j': o->json = 1; return 0;
  case KEY_PLOT: o->plot = arg; return 0;
  case KEY_RANKS_PER_NODE:
    if (!vg_parse_int(arg, strlen(arg), &n) || n < 1 ||
        n > VG_MODEL_WORKERS_MAX)
      argp_error(state, "--ranks-per-node takes a whole number from 1, not "
                 "'%s'", arg);
    o->machine.ranks_per_node = (int)n;
    return 0;
  case KEY_LATENCY:
    number("latency", arg, 0, &o->machine.latency, state);
    return 0;
  case KEY_BANDWIDTH:
    number("bandwidth", arg, 1, &o->machine.bandwidth, state);
    return 0;
  case KEY_RATE: number("rate", arg, 1e-6, &o->machine.rate, state); return 0;
  case KEY_SERIAL: number("serial", arg, 0, &o->serial, state); return 0;
  case KEY_ROAM: o->machine.joins_roam = 1; return 0;
  case ARGP_KEY_ARG:
    argp_error(state, "what is '%s'? a record is given with --replay", arg);
    return 0;
  case ARGP_KEY_END:
    if (!o->replay)
      argp_error(state, "which run? give --replay FILE.timeline.json");
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

int vg_cmd_plan(int argc, char **argv)
{
  const struct argp_option options[] = {
    { "replay", 'r', "FILE", 0, "record of a run, as 'vanguard mesh "
      "--timeline' writes it", 1 },
    { "ranks", 'n', "LIST", 0, "numbers of ranks: 1,2,4 or 3:7 or 1:64:x2 "
      "[default 1:512:x2]", 2 },
    { "threads", 't', "LIST", 0, "threads of each rank [default 1]", 2 },
    { "ranks-per-node", KEY_RANKS_PER_NODE, "N", 0, "ranks that share a "
      "node: no latency between them [default 1]", 2 },
    { "latency", KEY_LATENCY, "S", 0, "seconds per message [default 2e-6]",
      2 },
    { "bandwidth", KEY_BANDWIDTH, "B", 0, "bytes per second of a rank's link "
      "[default 1e10]", 2 },
    { "rate", KEY_RATE, "X", 0, "speed of a core over the recorded one "
      "[default 1]", 2 },
    { "serial", KEY_SERIAL, "S", 0, "seconds done once, before and after the "
      "tasks [default as in the record]", 2 },
    { "joins-roam", KEY_ROAM, NULL, 0, "joins are done by any rank, not at "
      "their home", 2 },
    { "json", 'j', NULL, 0, "forecast as JSON on standard output", 3 },
    { "plot", KEY_PLOT, "FILE", 0, "figure of the speed-up (SVG)", 3 },
    { 0 }
  };
  const struct argp argp = { .options = options, .parser = option,
    .args_doc = "--replay FILE",
    .doc = "Forecast the time of a run on other machines, by simulating the "
      "tasks of a recorded one: who is idle takes the next task, cuts before "
      "fills, heavy ones first.\v"
      "Speed-up is against one worker of the same tasks; critical is the "
      "longest chain of tasks that wait for each other, which no machine can "
      "go below; cuts end is when the last cut has been made." };
  struct vg_plan_options o = { .machine = VG_MACHINE_INIT, .serial = -1 };
  struct vg_error err = VG_ERROR_INIT;
  int status;

  if (vg_range_parse("--ranks", "1:512:x2", 1, 512, &o.ranks, &err) < 0 ||
      vg_range_parse("--threads", "1", 1, 1, &o.threads, &err) < 0)
    return vg_cli_fail(&err);
  vg_cli_parse(&argp, argc, argv, &o);
  status = vg_plan_replay(&o);
  vg_range_release(&o.ranks);
  vg_range_release(&o.threads);
  return status;
}
