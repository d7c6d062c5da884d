/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/html/html.h: PROJECT.report.html, the report of a run as a web page: one
 * file that loads no other, with pictures that need no scripts. Uses
 * run/stages. */
#ifndef VG_CLI_HTML_HTML_H
#define VG_CLI_HTML_HTML_H

#include "run/common/json_build.h"
#include "run/input/input.h"
#include "run/layers/layers.h"
#include "run/stages/run.h"

/** Contents of a page; borrowed. */
struct vg_html {
  const json_t *report; /* as STEM.report.json */
  const struct vg_problem *problem;
  const struct vg_layer_stage *layers;
  const struct vg_run *run; /* with its pictures */
  const char *timeline;     /* an SVG file, embedded in the page; NULL: none */
};

/** Write the page to `path`. On rank 0. Contents that differ between runs
 * (times, memory, hosts of tasks, folders of files) are between the comments
 * <!--run--> and <!--/run-->; the rest depends on the input only.
 * VG_ERR_IO, VG_ERR_MEMORY. */
vg_status vg_html_write(const char *path, const struct vg_html *h,
                        struct vg_error *err);

#endif
