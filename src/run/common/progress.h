/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/progress.h: progress display on stderr, a live line on a terminal
 * and plain lines elsewhere, and requests to stop (SIGINT, SIGTERM, SIGUSR1).
 * Times are only displayed and influence nothing. */
#ifndef VG_RUN_COMMON_PROGRESS_H
#define VG_RUN_COMMON_PROGRESS_H

#include <stdatomic.h>
#include <stddef.h>

#include "base/status.h"

/* Exit statuses of the program. VG_EXIT_LIMIT: all files were written, but a
 * limit on the layers is not met. */
enum {
  VG_EXIT_DONE = 0,
  VG_EXIT_FAILED = 1,
  VG_EXIT_USAGE = 2,
  VG_EXIT_LIMIT = 4
};

struct vg_display {
  int quiet, live, open; /* open: a live line is shown that has not been
                            ended. */
  int logs;              /* Lines are also written to the log (log.h). */
  double start, stage_start, last_shown, last_logged;
  double every; /* Seconds between plain lines; initially 10. */
  char stage[40];
  size_t done, expected; /* Counts of the stage; they never decrease. */
  size_t logged;         /* Value of `done` in the last line of the log. */
  double share;
  /* Additional callback, which requests a stop by a result other than 0; NULL:
   * none. */
  int (*tell)(void *user, const char *stage, size_t done, size_t expected);
  void *user;
  atomic_int asked; /* A stop was requested, by the callback or another
                       thread. */
};

/** Starts handling signals; call it before anything that takes time. Once. */
void vg_display_watch(void);

/** quiet: show nothing, except in the log if it is open. Starts handling
 * signals if that has not been done. */
void vg_display_init(struct vg_display *d, int quiet);

/** The callback of a vg_progress (base/progress.h); user is the display. Within
 * a stage neither count nor share decreases. */
void vg_display_update(void *user, const char *stage, size_t done,
                       size_t expected);

/** Removes the live line before other output is printed. */
void vg_display_clear(struct vg_display *d);

/** 1 after one of these signals. A further SIGINT, SIGTERM or SIGHUP more than
 * a second later ends the process at once, with the same message and exit
 * status; SIGUSR1, the warning of a batch system, never does. */
int vg_display_interrupted(void);

/** Whether to stop, because of a signal or a request to d. For libraries that
 * poll; d is a display or NULL. */
int vg_display_stop(void *d);

/** Returns VG_ERR_STOPPED with a message if so. d may be NULL. */
vg_status vg_display_stopped(struct vg_display *d, struct vg_error *err);

/** on: from now on the first of these signals ends the process at once, at any
 * point, with a message and VG_EXIT_FAILED. For commands, or parts of them,
 * that leave no incomplete files. */
void vg_display_end_at_once(int on);

/** Ends a process that is still running this many seconds after a request to
 * stop (except by SIGUSR1), at any point, with the same message and exit
 * status; the folder of vg_display_temporary is removed first. For programs
 * that call vg_display_interrupted rarely. Once. */
void vg_display_deadline(double seconds);

/* Deadline of commands that have nothing to finish. */
#define VG_DISPLAY_SOON_S 0.1

/** Sets the folder of incomplete files; NULL: none. The path is copied.
 * Threads: one at a time. */
void vg_display_temporary(const char *dir);

/** From now on the output files are moved into place, and the process ends by
 * itself regardless of earlier requests to stop. */
void vg_display_commit(void);

/** Wall clock in seconds, from an arbitrary start. */
double vg_display_now(void);

#endif
