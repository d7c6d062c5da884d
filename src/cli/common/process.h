/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/common/process.h: support for runs of this program as child processes:
 * command lines, the path of this program, and the reason why a run failed. */
#ifndef VG_CLI_COMMON_PROCESS_H
#define VG_CLI_COMMON_PROCESS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** A command line; `word` is NULL-terminated once a word has been added. */
struct vg_words {
  size_t n, cap;
  char **word;
};
#define VG_WORDS_INIT                                                          \
  {                                                                            \
    0, 0, NULL                                                                 \
  }

void vg_words_release(struct vg_words *w);

/** Add a word and take ownership of it; NULL means out of memory. */
vg_status vg_words_take(struct vg_words *w, char *text, struct vg_error *err);

/** Add a copy of a word; add an option and a number. */
vg_status vg_words_add(struct vg_words *w, const char *text,
                       struct vg_error *err);
vg_status vg_words_pair(struct vg_words *w, const char *name, int64_t v,
                        struct vg_error *err);

/** Add the words of a launcher, with {ranks} and {threads} replaced. Blanks
 * separate words, except in single or double quotes. NULL: mpirun, or no
 * launcher for one rank. VG_ERR_INPUT: a quote is not closed. */
vg_status vg_words_launcher(struct vg_words *w, const char *launcher, int ranks,
                            int threads, struct vg_error *err);

/** Run the command in a child process and wait until it ends. Its output goes
 * to the file `log`, which is replaced. A request to stop this process is
 * forwarded to the child and its own children as SIGTERM; the child also gets
 * one if this process is killed.
 *
 * @param dir     its working directory; NULL: that of this process
 * @param out     file for its standard output; NULL: the log
 * @param status  out: its exit status; 128 + n: ended by signal n; 127: it
 *                could not be started, and the log says why
 * @param wall    out: seconds from start to exit
 * VG_ERR_IO if the log cannot be written or no process can be created. */
vg_status vg_words_run(const struct vg_words *w, const char *dir,
                       const char *log, const char *out, int *status,
                       double *wall, struct vg_error *err);

/** Path of this program; the caller frees it. NULL: out of memory. */
char *vg_own_path(void);

/* Enough for all but the longest messages. */
#define VG_FAILURE_NOTE 800

/** Extract the reason of a failure from the output of a run in the file at
 * `path`: the last line that vanguard wrote; else the line after the first
 * horizontal rule, with which launchers frame their messages; else the last
 * line; "see PATH" if the file is empty. A line that is too long
 * ends with "...". note[size], size > 3. */
void vg_failure_note(const char *path, char *note, size_t size);

#endif
