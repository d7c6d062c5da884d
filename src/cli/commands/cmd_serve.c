/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard serve: the portal, from which runs are started in a browser. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands/commands.h"
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "cli/look/look.h"
#include "cli/serve/portal.h"
#include "run/common/progress.h"
#include "run/common/ranges.h"

enum {
  KEY_HOST = 1,
  KEY_UPLOAD,
  KEY_JOBS,
  KEY_LAUNCHER,
  KEY_PROGRAM,
  KEY_LOOK
};

/* How long the server waits for requests, and the interval at which runs are
 * checked. */
#define STEP_MS 200

struct arguments {
  struct vg_portal_options o;
  const char *look, *project; /* of a process that the portal has started; NULL:
                                 serve */
};

static int64_t number(const char *option, const char *text, int64_t lo,
                      int64_t hi, const struct argp_state *state)
{
  int64_t v = 0;

  if (!vg_parse_count(text, strlen(text), &v) || v < lo || v > hi)
    argp_error(state, "--%s takes an integer from %lld to %lld, not '%s'",
               option, (long long)lo, (long long)hi, text);
  return v;
}

static error_t option(int key, char *arg, struct argp_state *state)
{
  struct arguments *a = state->input;
  struct vg_portal_options *o = &a->o;

  switch (key) {
  case 'p': o->port = (int)number("port", arg, 0, 65535, state); return 0;
  case 'r': o->root = arg; return 0;
  case KEY_HOST: o->host = arg; return 0;
  case KEY_UPLOAD:
    o->max_upload = number("max-upload", arg, 0, INT64_MAX / 2, state);
    return 0;
  case KEY_JOBS: o->jobs = (int)number("jobs", arg, 1, 64, state); return 0;
  case KEY_LAUNCHER: o->launcher = arg; return 0;
  case KEY_PROGRAM: o->program = arg; return 0;
  case KEY_LOOK: a->look = arg; return 0;
  case ARGP_KEY_ARG:
    if (a->look && !a->project) {
      a->project = arg;
      return 0;
    }
    argp_error(state,
               "unexpected argument '%s'; give the folder of the projects with "
               "--root",
               arg);
    return 0;
  default: return ARGP_ERR_UNKNOWN;
  }
}

static int run(const struct vg_portal_options *o)
{
  struct vg_portal *p = NULL;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;
  int n = 0;

  vg_display_watch();
  VG_TRY(vg_portal_open(o, &p, &err));
  printf("%s\n", vg_portal_url(p));
  fflush(stdout);
  fprintf(stderr, "Open this address in a browser; anyone who has it can start "
                  "runs as you. Ctrl-C\nends the portal, not its runs.\n");
  if (o->host)
    fprintf(stderr, "vanguard: warning: with --host, others on the network can "
                    "read the traffic, including\nthe token: HTTP is not "
                    "encrypted\n");
  while (st >= 0 && !vg_display_interrupted())
    st = vg_portal_step(p, STEP_MS, &err);
  n = vg_portal_active(p);
  if (st >= 0 && n)
    fprintf(stderr,
            "%d run%s still waiting or running; a new portal with the same "
            "--root shows them again\n",
            n, n > 1 ? "s" : "");
done:
  vg_portal_close(p);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}

int vg_cmd_serve(int argc, char **argv)
{
  const struct argp_option options[] = {
    { "port", 'p', "N", 0,
      "Port to listen on; 0: any free port [default "
      "8765]",
      1 },
    { "root", 'r', "DIR", 0,
      "Folder of the projects; the portal accesses no files outside it, and "
      "stores runs in DIR/vanguard-runs [default: current folder]",
      1 },
    { "host", KEY_HOST, "ADDRESS", 0,
      "Address to listen on, to allow access from other machines; the traffic "
      "is not encrypted [default 127.0.0.1: this machine only]",
      1 },
    { "jobs", KEY_JOBS, "N", 0,
      "Largest number of simultaneous runs on this machine; further runs wait "
      "[default 1]",
      1 },
    { "max-upload", KEY_UPLOAD, "BYTES", 0,
      "Largest file that can be uploaded [bytes, default 1e9]", 1 },
    { "launcher", KEY_LAUNCHER, "COMMAND", 0,
      "Command that starts the ranks, as for "
      "vanguard sweep [default 'mpirun -n {ranks} --bind-to none', none for "
      "one rank]",
      1 },
    { "program", KEY_PROGRAM, "FILE", OPTION_HIDDEN,
      "Program to run instead of this one (for tests)", 1 },
    { "look", KEY_LOOK, "KIND", OPTION_HIDDEN,
      "Examine a project for a portal: view or check", 1 },
    { 0 }
  };
  const struct argp argp = {
    .options = options,
    .parser = option,
    .doc =
      "Serve a web page from which runs are started, monitored, stopped and "
      "resumed. It shows the projects below a folder, a form with all "
      "settings, and the runs on this machine or through Slurm with their "
      "progress, logs and reports.\v"
      "The command prints the address of the page, which contains an access "
      "token; until the portal ends, the address is also in "
      "DIR/vanguard-runs/portal.url. To use it from another machine: "
      "ssh -L 8765:127.0.0.1:8765 MACHINE. Each run is a separate process with "
      "its own folder in DIR/vanguard-runs and continues when the portal ends. "
      "Exit status: 0 ended by a signal, 1 failure, 2 wrong usage."
  };
  struct arguments a = { .o = VG_PORTAL_OPTIONS_INIT };

  vg_cli_parse(&argp, argc, argv, &a);
  if (a.look && a.project)
    return vg_look(strcmp(a.look, "check") ? VG_LOOK_VIEW : VG_LOOK_CHECK,
                   a.project);
  return run(&a.o);
}
