/* cli/commands/check_surface.h: vanguard check of a surface. Private to
 * cli/commands. */
#ifndef VG_CLI_COMMANDS_CHECK_SURFACE_H
#define VG_CLI_COMMANDS_CHECK_SURFACE_H

#include <jansson.h>

#include "run/input/input.h"

/** Names of files as on the command line; NULL: not given. */
struct vg_check_surface {
  const char *file, *defects, *against, *vtu;
  int json;
  int has_deck;             /* settings are a deck's, sizes are asked for */
};

/** Judge and print. VG_ERR_GEOMETRY when there are defects. */
vg_status vg_check_surface(const struct vg_check_surface *a,
                           const struct vg_settings *s, struct vg_mesh *m,
                           struct vg_notes *notes, struct vg_error *err);

#endif
