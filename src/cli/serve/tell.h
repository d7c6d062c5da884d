/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: parses the progress lines of a run. */
#ifndef VG_CLI_SERVE_TELL_H
#define VG_CLI_SERVE_TELL_H

#include <stddef.h>

/** The last progress line. Texts are "" if not in the line. */
struct vg_tell {
  char stage[40];
  double share;            /* completed fraction of the stage; -1: unknown */
  char count[72];          /* "12,345 of 27,000" */
  char rate[32], left[32]; /* "350,000/s", "2 min 10 s" */
};
#define VG_TELL_INIT                                                           \
  {                                                                            \
    .share = -1                                                                \
  }

/** Parse a line that vanguard mesh or vanguard sweep writes to standard error
 * if that is not a terminal. Returns 1 and replaces *out if it is a progress
 * line, else 0. */
int vg_tell_line(const char *line, size_t n, struct vg_tell *out);

/** Find the last progress line in the end of a file. is_cut: the file is
 * longer, so that the first line may be truncated and does not count. Returns 0
 * and leaves *out unchanged if it finds no such line. */
int vg_tell_tail(const char *data, size_t n, int is_cut, struct vg_tell *out);

/** The exit status at the end of a log (--log); -1 if it is missing. */
int vg_tell_status(const char *data, size_t n);

#endif
