/* cli/common/process.h: what runs of this program as processes need: command
 * lines word by word, the path of this program, and why a run failed. */
#ifndef VG_CLI_COMMON_PROCESS_H
#define VG_CLI_COMMON_PROCESS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** A command line; word is NULL-ended once something was added. */
struct vg_words {
  size_t n, cap;
  char **word;
};
#define VG_WORDS_INIT                                                          \
  {                                                                            \
    0, 0, NULL                                                                 \
  }

void vg_words_release(struct vg_words *w);

/** Add a word, which is taken over; NULL stands for refused memory. */
vg_status vg_words_take(struct vg_words *w, char *text, struct vg_error *err);

/** Add a copy of a word; a word and a number. */
vg_status vg_words_add(struct vg_words *w, const char *text,
                       struct vg_error *err);
vg_status vg_words_pair(struct vg_words *w, const char *name, int64_t v,
                        struct vg_error *err);

/** Add the words of a launcher, parted by blanks, with {ranks} and {threads}
 * filled in. NULL: mpirun, nothing for one rank. */
vg_status vg_words_launcher(struct vg_words *w, const char *launcher, int ranks,
                            int threads, struct vg_error *err);

/** Path of this program; the caller frees it. NULL: no memory. */
char *vg_own_path(void);

/** What went wrong in a run, by what it has printed into the file at path: the
 * last line that vanguard wrote; or else what follows the first rule, as
 * launchers put round their messages; or the last line. "see PATH" where the
 * file says nothing. note[size]. */
void vg_failure_note(const char *path, char *note, size_t size);

#endif
