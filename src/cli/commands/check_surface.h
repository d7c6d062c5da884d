/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/commands/check_surface.h: vanguard check of a surface. Private to
 * cli/commands. */
#ifndef VG_CLI_COMMANDS_CHECK_SURFACE_H
#define VG_CLI_COMMANDS_CHECK_SURFACE_H

#include "run/common/json_build.h"
#include "run/input/input.h"

/** Names of files as on the command line; NULL: not given. */
struct vg_check_surface {
  const char *file, *defects, *against, *vtu;
  int json;
  int has_deck; /* 1: a deck requests target edge lengths */
  int *written; /* set to 1 once the report has been printed as JSON */
};

/** Perform the steps of vanguard mesh up to the closed boundary of the fluid
 * and print their results: flow domain, patches, repairs, remeshing, layers,
 * defects. The status is that of these steps; the message says why vanguard
 * mesh would reject the surface.
 * @param p  files and settings; the surface is read here if it has not been */
vg_status vg_check_surface(const struct vg_check_surface *a,
                           struct vg_problem *p, struct vg_display *show,
                           struct vg_error *err);

#endif
