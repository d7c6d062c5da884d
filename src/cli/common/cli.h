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

#endif
