/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The calls of run/commit for files and memory in test_commit: the linker
 * replaces open(2), write(2), ... by functions that count each call, fail the
 * requested one, and record those that change files for a replay after a power
 * loss. fsync(2) does nothing. */
#ifndef VG_TESTS_COMMIT_CALLS_H
#define VG_TESTS_COMMIT_CALLS_H

#include <stddef.h>

struct calls {
  long n;          /* Number of calls since calls_reset. */
  long fail_at;    /* The call, from 1, that fails; 0: none. */
  long fails_from; /* All calls from this one on fail; 0: none. */
  int error;       /* errno of these calls; 0: writes take no byte. */
  void (*before_lock)(const char *path); /* Called by flock. */
  void (*before_journal)(void);          /* Before the journal is named so. */
  /* errno: a file system without hard links, RENAME_EXCHANGE, locks or fsync of
   * folders. They stay after calls_reset. */
  int no_link, no_exchange, no_lock, no_folder_sync;
  const char *root; /* Folder whose calls are recorded; NULL: none. */
};
extern struct calls calls;

/* Clear counters and records; the kind of the file system stays. */
void calls_reset(void);

size_t calls_recorded(void);

/* Do the first n recorded calls in the folder `root`, as a disk may have them
 * after a power loss. A name is certain if its folder was synchronised after
 * it was made, and data if the file was. Everything else is lost (way 0), kept
 * (way 1), or each of it lost, kept or torn at random (a seed). */
void calls_replay(const char *root, size_t n, unsigned way);

#endif
