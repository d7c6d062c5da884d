/* Private to cli/serve: the form of a run. It has a field for every setting and
 * for every column of the one-line tables; the other tables are text areas. */
#ifndef VG_CLI_SERVE_FORM_H
#define VG_CLI_SERVE_FORM_H

#include <stdio.h>

#include "cli/serve/fields.h"
#include "cli/serve/runs.h"
#include "run/settings/settings.h"

/** Read settings from the fields "s.NAME", "farfield.COLUMN", "sweep.COLUMN",
 * "title", and "patches", "layers", "sources" (a line of columns above lines of
 * values, as in a deck). An empty field sets the default, an absent field
 * leaves the setting unchanged.
 *
 * @param root  paths in settings must be below this folder; relative paths
 *              start from it. Plug-ins are rejected, since they are programs
 * @param s     in, out; the caller releases it, also on failure
 * VG_ERR_INPUT: a value is invalid, or values contradict each other. */
vg_status vg_form_settings(const struct vg_fields *f, const char *root,
                           struct vg_settings *s, struct vg_error *err);

/** Read how to run it: "where" (here or slurm), "ranks", "nodes", "cpus",
 * "time", "partition", "what" (mesh or sweep). */
vg_status vg_form_run(const struct vg_fields *f, struct vg_serve_run *run,
                      struct vg_error *err);

/** Print the form of a project.
 *
 * @param s       values of the fields
 * @param posted  values of a rejected form, which override s; may be empty
 * @param slurm   whether Slurm is available */
void vg_form_print(FILE *to, const char *project, const struct vg_settings *s,
                   const struct vg_fields *posted, int slurm);

#endif
