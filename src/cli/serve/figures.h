/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: results of a run, from the report that it has
 * written. */
#ifndef VG_CLI_SERVE_FIGURES_H
#define VG_CLI_SERVE_FIGURES_H

#include <stdio.h>

#include "cli/http/http.h"
#include "cli/serve/runs.h"
#include "run/common/json_build.h"

/** Path of the result whose name ends with `suffix`, relative to the folder of
 * the run, as in "mesh/wing.report.json"; free it. NULL: no result has
 * this suffix. */
char *vg_run_result(const struct vg_serve_run *run, const char *suffix);

/** The report of a mesh, or the table of a sweep; json_decref. NULL: there is
 * none. */
json_t *vg_run_report(const struct vg_serve_run *run);

/** Read the figures of a run that has ended, once. */
void vg_figures_read(struct vg_serve_run *run);

/** Number of pictures that can be taken from a report: the surface, and a
 * section of the mesh. */
enum { VG_PICTURES = 2 };

/** Answer with a picture of the report of a run as PNG. */
void vg_reply_picture(const struct vg_serve_run *run, int which,
                      struct vg_reply *a);

/** A figure of a report for comparisons. */
struct vg_figure {
  const char *path; /* as in "field.angle_min" */
  const char *name, *unit;
  int decimals;  /* -1: a count; -2: yes or no; -3: bytes */
  int is_better; /* 1: larger is better, -1: smaller, 0: neither */
};
extern const struct vg_figure vg_figure[];
extern const size_t vg_n_figure;

/** The value at a path; NULL: absent. Borrowed. */
const json_t *vg_figure_of(const json_t *report, const char *path);

/** Print a value, or a dash for NULL. */
void vg_figure_print(FILE *to, const struct vg_figure *f, const json_t *v);

#endif
