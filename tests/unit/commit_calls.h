/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The file calls of run/commit in test_commit: the linker replaces open(2),
 * write(2), ... by functions that count each call, fail the requested one, and
 * record all of them for a replay after a power loss. fsync(2) does nothing. */
#ifndef VG_TESTS_COMMIT_CALLS_H
#define VG_TESTS_COMMIT_CALLS_H

#include <stddef.h>

struct calls {
  long n;           /* Number of calls since calls_reset. */
  long fail_at;     /* The call, from 1, that fails; 0: none. */
  int fails_after;  /* 1: all later calls fail, too. */
  int error;        /* errno of these calls. */
  int no_link;      /* 1: a file system without hard links, */
  int no_exchange;  /* without RENAME_EXCHANGE, */
  int no_lock;      /* without flock. */
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
