/* Private to cli/serve: the form of a run. A field for every setting and every
 * column of the tables of one line; the tables of many lines as text. */
#ifndef VG_CLI_SERVE_FORM_H
#define VG_CLI_SERVE_FORM_H

#include <stdio.h>

#include "cli/serve/fields.h"
#include "cli/serve/runs.h"
#include "run/settings/settings.h"

/** Settings from the fields "s.NAME" of settings, "farfield.COLUMN",
 * "sweep.COLUMN", "title", and "patches", "layers", "sources": a line of
 * columns above lines of values, as in a deck. What is empty gets its default,
 * what is absent stays as it is.
 *
 * @param root  paths in settings must stay in this folder; relative ones start
 *              from it. Plug-ins are refused: they are programs
 * @param s     in, out; the caller releases it, also on failure
 * VG_ERR_INPUT: a value is refused, or they do not go together. */
vg_status vg_form_settings(const struct vg_fields *f, const char *root,
                           struct vg_settings *s, struct vg_error *err);

/** Where and how it is run: "where" (here or slurm), "ranks", "nodes", "cpus",
 * "time", "partition", "what" (mesh or sweep). */
vg_status vg_form_run(const struct vg_fields *f, struct vg_serve_run *run,
                      struct vg_error *err);

/** The form for a project.
 *
 * @param s       what the fields show
 * @param posted  wins over s: what was sent and refused; may be empty
 * @param slurm   whether sbatch is here */
void vg_form_print(FILE *to, const char *project, const struct vg_settings *s,
                   const struct vg_fields *posted, int slurm);

#endif
