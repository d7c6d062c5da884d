/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/plan/plan_output.h: the forecast of a project as text, JSON and plot.
 * Private to cli/plan. */
#ifndef VG_CLI_PLAN_PLAN_OUTPUT_H
#define VG_CLI_PLAN_PLAN_OUTPUT_H

#include "cli/plan/plan.h"
#include "run/plan/run_plan.h"

void vg_plan_text(const struct vg_plan *p, const struct vg_plan_options *o);
vg_status vg_plan_json(const struct vg_plan *p, struct vg_error *err);

/** Plots the speed-up over the number of workers into the file `plot`. */
vg_status vg_plan_draw(const struct vg_plan *p, const char *plot,
                       struct vg_error *err);

#endif
