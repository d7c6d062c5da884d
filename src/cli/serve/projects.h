/* Private to cli/serve: what can be meshed below a folder. */
#ifndef VG_CLI_SERVE_PROJECTS_H
#define VG_CLI_SERVE_PROJECTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "run/settings/settings.h"

/* How much of the folder is looked at. */
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

/** Surfaces and VGRID projects (NAME.d3m) below root, in the order of their
 * names, which are relative to it. Hidden folders, links to folders, folders of
 * runs and files with volume cells are left out. */
vg_status vg_projects_list(const char *root, struct vg_projects *out,
                           struct vg_error *err);
void vg_projects_release(struct vg_projects *p);

/** 1 when a file of this name may be a project. */
int vg_projects_is_name(const char *name);

/** The settings of a project: its deck's, or defaults. All its files must be in
 * the root: VG_ERR_INPUT names the one that is not. *s is untouched on
 * failure.
 * @param deck  a deck instead of the project's; NULL */
vg_status vg_project_settings(const char *root, const char *name,
                              const char *deck, struct vg_settings *s,
                              struct vg_error *err);

#endif
