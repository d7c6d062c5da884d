/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/plan/plan.h: the two forecasts of vanguard plan. Uses cli/common/cli.h,
 * run/common/ranges.h, partition/model/model.h. */
#ifndef VG_CLI_PLAN_PLAN_H
#define VG_CLI_PLAN_PLAN_H

#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "partition/model/model.h"
#include "run/common/ranges.h"

struct vg_plan_options {
  const char *replay;         /* a .timeline.json, or NULL */
  const char *project, *deck; /* if there is no replay */
  const char *rates;          /* a .timeline.json of this machine, or NULL */
  struct vg_cli_overrides kept;
  double target; /* seconds; 0: none */
  int cores;     /* cores of a node: `ranks` are then numbers of nodes, and all
                    combinations of ranks and threads that fill a node are
                    tried; 0: use ranks and threads as given */
  int depth;     /* levels of the tree shown in the text */
  struct vg_range_list ranks, threads;
  struct vg_machine machine; /* all members but ranks, threads and the times
                                outside the tasks */
  double serial;             /* seconds that are not parallel; below 0: phases
                                as in the record */
  const char *plot;          /* file for a plot of the speed-up, or NULL */
  int json, quiet;
};

/** Replay a timeline on all requested machines and print the forecasts,
 * beginning with the machine of the record, which shows the accuracy of the
 * model. Returns an exit status. */
int vg_plan_replay(const struct vg_plan_options *o);

/** Forecast the mesh of a project and its run on all requested machines from
 * the surface and the sizing field only, and print it. Returns an exit
 * status. */
int vg_plan_estimate(const struct vg_plan_options *o);

#endif
