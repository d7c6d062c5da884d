/* cli/commands/mesh_log.h: what stands at the head of the log of vanguard mesh,
 * besides what is printed anyway. Private to cli/commands. */
#ifndef VG_CLI_COMMANDS_MESH_LOG_H
#define VG_CLI_COMMANDS_MESH_LOG_H

#include "run/stages/run.h"

/** Program, libraries, command, host, ranks and threads, into the log if there
 * is one. On rank 0. */
void vg_mesh_log_start(const struct vg_run *r, int argc, char **argv);

/** All settings, as deck and options give them; threads that will be used. */
void vg_mesh_log_settings(const struct vg_run *r, const struct vg_settings *s);

#endif
