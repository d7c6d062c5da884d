/* run/common/log.h: a file that gets what a run says: --log. One per process,
 * as there is one standard output. */
#ifndef VG_RUN_COMMON_LOG_H
#define VG_RUN_COMMON_LOG_H

#include <stdio.h>

#include "base/status.h"

/** Begin the log at path. A file that is there is replaced only if it is a log:
 * its first word is "vanguard".
 * VG_ERR_IO: it cannot be written; VG_ERR_INPUT: it is something else. */
vg_status vg_log_open(const char *path, struct vg_error *err);

/** Where to write; NULL: there is no log. Lines are written as they end. */
FILE *vg_log(void);

/** The file's descriptor, for signal handlers; -1: none. */
int vg_log_descriptor(void);

/** VG_ERR_IO: not all could be written. Nothing happens without a log. */
vg_status vg_log_close(struct vg_error *err);

#endif
