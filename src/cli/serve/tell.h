/* Private to cli/serve: what a run says about how far it is. */
#ifndef VG_CLI_SERVE_TELL_H
#define VG_CLI_SERVE_TELL_H

#include <stddef.h>

/** The last line of progress. Texts are "" where the line does not say. */
struct vg_tell {
  char stage[40];
  double share;            /* of the stage, 0 to 1; -1: not known */
  char count[72];          /* "12,345 of 27,000" */
  char rate[32], left[32]; /* "350,000/s", "2 min 10 s" */
};
#define VG_TELL_INIT                                                           \
  {                                                                            \
    .share = -1                                                                \
  }

/** A line as vanguard mesh or vanguard sweep puts it on standard error where
 * that is no terminal. 1: it was one, *out is replaced; 0: something else. */
int vg_tell_line(const char *line, size_t n, struct vg_tell *out);

/** The last line of progress in the end of a file, whose first line may be
 * cut. 0: there is none, *out is as it was. */
int vg_tell_tail(const char *data, size_t n, struct vg_tell *out);

/** The exit status that a log (--log) ends with; -1: it does not say. */
int vg_tell_status(const char *data, size_t n);

#endif
