/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/log.h: the file of --log, which receives the output of a run. One
 * per process, like the standard output. */
#ifndef VG_RUN_COMMON_LOG_H
#define VG_RUN_COMMON_LOG_H

#include <stdio.h>

#include "base/status.h"

/** Opens the log at path. An existing file is replaced only if it is a log,
 * whose first word is "vanguard". VG_ERR_IO: it cannot be written;
 * VG_ERR_INPUT: it is not a log. */
vg_status vg_log_open(const char *path, struct vg_error *err);

/** Stream of the log; NULL: there is no log. Line-buffered. */
FILE *vg_log(void);

/** Its file descriptor, for signal handlers; -1: no log. */
int vg_log_descriptor(void);

/** VG_ERR_IO if something could not be written. Does nothing without a log. */
vg_status vg_log_close(struct vg_error *err);

#endif
