/* cli/html/html.h: PROJECT.report.html, the run as a page to look at: one file
 * that loads nothing, with pictures that need no scripts. Uses run/stages. */
#ifndef VG_CLI_HTML_HTML_H
#define VG_CLI_HTML_HTML_H

#include <jansson.h>

#include "run/input/input.h"
#include "run/input/layers.h"
#include "run/stages/run.h"

/** What a page is made of; borrowed. */
struct vg_html {
  const json_t *report; /* as STEM.report.json */
  const struct vg_problem *problem;
  const struct vg_layer_stage *layers;
  const struct vg_run *run; /* with its pictures */
  const char *timeline;     /* an SVG file, put into the page; NULL: none */
};

/** Write the page to `path`. On rank 0. What differs from run to run (times,
 * memory, hosts of tasks, files' folders) stands between the comments
 * <!--run--> and <!--/run-->; the rest follows from the input alone.
 * VG_ERR_IO, VG_ERR_MEMORY. */
vg_status vg_html_write(const char *path, const struct vg_html *h,
                        struct vg_error *err);

#endif
