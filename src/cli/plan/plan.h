/* cli/plan/plan.h: what vanguard plan computes. Uses cli/common/cli.h,
 * run/common/ranges.h, partition/model/model.h. */
#ifndef VG_CLI_PLAN_PLAN_H
#define VG_CLI_PLAN_PLAN_H

#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "partition/model/model.h"
#include "run/common/ranges.h"

struct vg_plan_options {
  const char *replay;         /* a .timeline.json, or NULL */
  const char *project, *deck; /* without a replay */
  const char *rates;          /* a .timeline.json of this machine, or NULL */
  struct vg_cli_overrides kept;
  double target; /* s; 0: none */
  int cores;     /* of a node: ranks are numbers of nodes, with
                    all ways to share its cores; 0: as ranks and
                    threads say */
  int depth;     /* of the tree as text */
  struct vg_range_list ranks, threads;
  struct vg_machine machine; /* all but ranks, threads and what is
                                outside the tasks */
  double serial;             /* s that nobody shares; below 0: phases as
                                in the record */
  const char *plot;          /* file for a figure of speed-up, or NULL */
  int json, quiet;
};

/** Replay a record on all machines asked for, and print what comes out; the
 * machine it was recorded on first, to show how well the model fits.
 * Returns an exit status. */
int vg_plan_replay(const struct vg_plan_options *o);

/** Forecast the mesh of a project and its run on all machines asked for, from
 * surface and sizes alone, and print it. Returns an exit status. */
int vg_plan_estimate(const struct vg_plan_options *o);

#endif
