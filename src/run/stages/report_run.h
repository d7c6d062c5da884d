/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/report_run.h: the report of a run as text and as JSON, for program
 * and library. Uses run/stages/run.h. */
#ifndef VG_RUN_STAGES_REPORT_RUN_H
#define VG_RUN_STAGES_REPORT_RUN_H

#include "run/stages/run.h"

/** Wall-clock seconds of the steps that struct vg_run does not measure. */
struct vg_run_times {
  double start; /* Of vg_display_now. */
  double read, check, write, digest, sync, page;
  double total; /* From the start to the printed report. The terminal and the
                   log print the same value. */
};

/** What a report describes; borrowed. */
struct vg_run_report {
  const struct vg_problem *problem;
  const struct vg_layer_stage *layers;
  const struct vg_run *run;
  const struct vg_outputs *outputs; /* NULL: no files. */
  int has_mesh;                     /* 0: the run ended with the surface. */
  struct vg_run_times time;
};

/** ok: the run has succeeded; if not, err has the reason, and the report ends
 * with the surface. */
json_t *vg_run_report_json(const struct vg_run_report *r, int ok,
                           const struct vg_error *err);

/** The text has two parts, of which the second requires a mesh: the input up to
 * the surface, and everything after it. vg_run_report_text prints both. */
void vg_run_report_surface_text(FILE *to, const struct vg_run_report *r);
void vg_run_report_text(FILE *to, const struct vg_run_report *r);

#endif
