/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/commands/mesh_log.h: the head of the log of vanguard mesh, which is not
 * printed to the terminal. Private to cli/commands. */
#ifndef VG_CLI_COMMANDS_MESH_LOG_H
#define VG_CLI_COMMANDS_MESH_LOG_H

#include "run/stages/run.h"

/** Write version, libraries, command, host and ranks to the log, if there is
 * one. On rank 0. */
void vg_mesh_log_start(const struct vg_run *r, int argc, char **argv);

/** Write the number of threads and all settings as given by deck and options.
 */
void vg_mesh_log_settings(const struct vg_run *r, const struct vg_settings *s);

#endif
