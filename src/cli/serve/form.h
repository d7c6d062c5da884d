/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: the form of a run. It has a field for every setting and
 * for every column of the one-line tables; the other tables are text areas. */
#ifndef VG_CLI_SERVE_FORM_H
#define VG_CLI_SERVE_FORM_H

#include <stdio.h>

#include "cli/http/fields.h"
#include "cli/serve/runs.h"
#include "run/settings/settings.h"

/** Where a form is wrong: the name of a field, and the line of a table, counted
 * from 1 with the line of names; "" and 0 if unknown. */
struct vg_form_fault {
  char field[64];
  int line;
};
#define VG_FORM_FAULT_INIT                                                     \
  {                                                                            \
    "", 0                                                                      \
  }

/** Read settings from the fields "s.NAME", "farfield.COLUMN", "sweep.COLUMN",
 * "title", and "patches", "layers", "surface", "sources" (a line of columns
 * above lines of values, as in a deck). An empty field sets the default, an
 * absent field leaves the setting unchanged.
 *
 * @param root  paths in settings must be below this folder; relative paths
 *              start from it. Plug-ins are rejected, since they are programs
 * @param s     in, out; the caller releases it, also on failure
 * @param fault out: set on failure
 * VG_ERR_INPUT: a value is invalid, or values contradict each other. */
vg_status vg_form_settings(const struct vg_fields *f, const char *root,
                           struct vg_settings *s, struct vg_form_fault *fault,
                           struct vg_error *err);

/** Read how to run it: "where" (here or slurm), "ranks", "nodes", "cpus",
 * "time", "partition", "what" (mesh or sweep). */
vg_status vg_form_run(const struct vg_fields *f, struct vg_serve_run *run,
                      struct vg_form_fault *fault, struct vg_error *err);

/** Contents of the form of a project. */
struct vg_form_view {
  const char *project;
  const struct vg_settings *s;    /* Values of the fields. */
  const struct vg_fields *posted; /* Values of a rejected form, which override
                                     `s`; may be empty. */
  const struct vg_form_fault *fault; /* The field that is wrong. */
  const char *message;               /* Shown at that field; NULL: none. */
  int slurm;                         /* 1: Slurm is available. */
};

/** Print the form of a project: the main settings, then all others by groups,
 * tables, and the machine. */
void vg_form_print(FILE *to, const struct vg_form_view *v);

#endif
