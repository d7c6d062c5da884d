/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/common/cli.h: exit of a command after a failure. Uses
 * run/common/progress.h, jansson. */
#ifndef VG_CLI_COMMON_CLI_H
#define VG_CLI_COMMON_CLI_H

#include <jansson.h>

#include "run/common/progress.h"

/** Print "vanguard: message" to stderr and to the log; returns the exit status
 * of the error. vg_cli_exit returns it without printing. */
int vg_cli_fail(const struct vg_error *err);
int vg_cli_exit(const struct vg_error *err);

/** Add a failure to a JSON report: `error`, its message, and `error_kind`, the
 * name of its code (vg_status_name). */
void vg_cli_put_error(json_t *report, const struct vg_error *err);

#endif
