/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/common/cli.h: exit of a command after a failure. Uses
 * run/common/progress.h. */
#ifndef VG_CLI_COMMON_CLI_H
#define VG_CLI_COMMON_CLI_H

#include "run/common/progress.h"

/** Print "vanguard: message" to stderr and to the log; returns the exit status
 * of the error. vg_cli_exit returns it without printing. */
int vg_cli_fail(const struct vg_error *err);
int vg_cli_exit(const struct vg_error *err);

/** Exit status of a command after all of its output: `status`, or
 * VG_EXIT_FAILED with a message on stderr if standard output could not be
 * written completely. VG_EXIT_USAGE is returned in any case. */
int vg_cli_written(int status);

#endif
