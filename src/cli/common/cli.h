/* cli/common/cli.h: small things that all of the command line shares: exit
 * statuses, messages, folders. Uses base. */
#ifndef VG_CLI_COMMON_CLI_H
#define VG_CLI_COMMON_CLI_H

#include "base/status.h"

/* VG_EXIT_LIMIT: all is written, but a limit on the layers is not met. */
enum { VG_EXIT_DONE = 0, VG_EXIT_FAILED = 1, VG_EXIT_USAGE = 2,
       VG_EXIT_LIMIT = 4 };

/** Print "vanguard: message" to stderr; returns the exit status of its code,
 * which vg_cli_exit tells without printing. */
int vg_cli_fail(const struct vg_error *err);
int vg_cli_exit(const struct vg_error *err);

/** Make a folder and those above it; one that exists is fine. */
vg_status vg_cli_make_folder(const char *path, struct vg_error *err);

/** Count as "12,345,678" into text[32]; returns text. */
char *vg_cli_count(unsigned long long n, char *text);

#endif
