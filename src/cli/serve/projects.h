/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: finds the projects below a folder. */
#ifndef VG_CLI_SERVE_PROJECTS_H
#define VG_CLI_SERVE_PROJECTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "run/settings/settings.h"

/* Limits of the search: projects, levels of folders, entries examined. */
enum {
  VG_PROJECTS_MAX = 500,
  VG_PROJECTS_DEPTH = 4,
  VG_PROJECTS_LOOKED_AT = 20000
};

#define VG_RUNS_FOLDER "vanguard-runs"

struct vg_projects {
  size_t n, cap, looked_at;
  struct vg_project_file {
    char *name;
    int64_t size;
  } * item;
  int is_cut; /* there may be more */
};
#define VG_PROJECTS_INIT                                                       \
  {                                                                            \
    0, 0, 0, NULL, 0                                                           \
  }

/** List surfaces and VGRID projects (NAME.d3m) below root, sorted by name;
 * names are relative to root. Hidden folders, links to folders, folders of runs
 * and files with volume cells are skipped. */
vg_status vg_projects_list(const char *root, struct vg_projects *out,
                           struct vg_error *err);
void vg_projects_release(struct vg_projects *p);

/** Returns 1 if a file of this name may be a project. */
int vg_projects_is_name(const char *name);

/** The settings of a project, from its deck or the defaults. All its files must
 * be below root; the message of VG_ERR_INPUT names one that is not. *s
 * must hold no rows; it is unchanged on failure.
 * @param deck  a deck to use instead of the project's, or NULL */
vg_status vg_project_settings(const char *root, const char *name,
                              const char *deck, struct vg_settings *s,
                              struct vg_error *err);

#endif
