/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* vanguard plan: forecasts mesh and run of a project from the surface and the
 * sizing field only. */
#include "cli/common/cli.h"
#include "cli/common/options.h"
#include "cli/plan/plan_output.h"
#include "cli/plot/timeline.h"
#include "run/report/report.h"

/* Fit the rates to the given record. */
static vg_status learn_rates(const struct vg_plan_options *o,
                             struct vg_plan_request *to, struct vg_error *err)
{
  struct vg_timeline t = VG_TIMELINE_INIT;
  struct vg_machine m = VG_MACHINE_INIT;
  vg_status st = VG_OK;

  if (!o->rates) return VG_OK;
  VG_TRY(vg_timeline_read(o->rates, &t, err));
  VG_TRY(vg_rates_of(&t.spans, to->fit, err));
  vg_timeline_outside(&t, &m);
  if (t.n_cell) to->spread_per_cell = m.by_all / (double)t.n_cell;
done:
  vg_timeline_release(&t);
  return st;
}

static vg_status read_project(const struct vg_plan_options *o,
                              struct vg_plan *p, struct vg_error *err)
{
  struct vg_problem *q = p->problem;
  vg_status st;

  vg_display_update(p->show, "read", 0, 0);
  VG_TRY(vg_problem_open(q, o->project, o->deck, err));
  VG_TRY(vg_cli_apply(&o->kept, &q->asked, err));
  VG_TRY(vg_problem_refuse_section(q, err));
  st = vg_problem_read(q, NULL, p->show, err);
done:
  return st;
}

static vg_status make(const struct vg_plan_options *o,
                      struct vg_plan_request *request, struct vg_plan *p,
                      struct vg_error *err)
{
  vg_status st;

  VG_TRY(learn_rates(o, request, err));
  request->program = vg_report_peak_memory();
  vg_plan_begin(p);
  VG_TRY(read_project(o, p, err));
  st = vg_plan_make(p, err);
done:
  return st;
}

int vg_plan_estimate(const struct vg_plan_options *o)
{
  struct vg_plan_request request = { .ranks = o->ranks,
                                     .threads = o->threads,
                                     .machine = o->machine,
                                     .cores = o->cores,
                                     .target = o->target,
                                     .serial = o->serial };
  struct vg_problem problem = VG_PROBLEM_INIT;
  struct vg_layer_stage layers = { 0 };
  struct vg_display show;
  struct vg_plan p = {
    .o = &request, .problem = &problem, .layers = &layers, .show = &show
  };
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  vg_display_init(&show, o->quiet);
  vg_display_end_at_once(1);
  st = make(o, &request, &p, &err);
  vg_display_end_at_once(0);
  vg_display_clear(&show);
  if (st >= 0 && o->json) st = vg_plan_json(&p, &err);
  else if (st >= 0) vg_plan_text(&p, o);
  if (st >= 0 && o->plot) st = vg_plan_draw(&p, o->plot, &err);
  vg_plan_release(&p);
  vg_layer_stage_release(&layers);
  vg_problem_release(&problem);
  return st < 0 ? vg_cli_fail(&err) : VG_EXIT_DONE;
}
