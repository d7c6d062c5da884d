/* cli/common/cli.h: how a command ends. Uses run/common/progress.h. */
#ifndef VG_CLI_COMMON_CLI_H
#define VG_CLI_COMMON_CLI_H

#include "run/common/progress.h"

/** Print "vanguard: message" to stderr; returns the exit status of its code,
 * which vg_cli_exit tells without printing. */
int vg_cli_fail(const struct vg_error *err);
int vg_cli_exit(const struct vg_error *err);

#endif
