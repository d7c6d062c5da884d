/* run/common/progress.h: what the user sees while waiting, on stderr: one live
 * line on a terminal, plain lines elsewhere; and requests to stop (SIGINT,
 * SIGTERM, SIGUSR1). Times are for people only and decide nothing. */
#ifndef VG_RUN_COMMON_PROGRESS_H
#define VG_RUN_COMMON_PROGRESS_H

#include <stdatomic.h>
#include <stddef.h>

#include "base/status.h"

/* Exit statuses of the program. VG_EXIT_LIMIT: all is written, but a limit on
 * the layers is not met. */
enum {
  VG_EXIT_DONE = 0,
  VG_EXIT_FAILED = 1,
  VG_EXIT_USAGE = 2,
  VG_EXIT_LIMIT = 4
};

struct vg_display {
  int quiet, live, open; /* open: a live line stands without its end */
  int logs;              /* lines go into the log (log.h), too */
  double start, stage_start, last_shown, last_logged;
  double every; /* s between plain lines; init: 10 */
  char stage[40];
  size_t done, expected; /* of the stage; they never go back */
  size_t logged;         /* the last that was done */
  double share;
  /* Told besides, and asks to stop by anything but 0; NULL. */
  int (*tell)(void *user, const char *stage, size_t done, size_t expected);
  void *user;
  atomic_int asked; /* to stop, by whom it tells or another thread */
};

/** Take note of signals from now on; before anything that takes time. Once. */
void vg_display_watch(void);

/** quiet: show nothing, but in the log, if that has been opened. Watches
 * signals, if that has not begun. */
void vg_display_init(struct vg_display *d, int quiet);

/** The callback of a vg_progress (base/progress.h); user is the display. Within
 * a stage neither count nor share runs backwards. */
void vg_display_update(void *user, const char *stage, size_t done,
                       size_t expected);

/** Remove the live line, before something else is printed. */
void vg_display_clear(struct vg_display *d);

/** 1 after one of these signals. Another SIGINT, SIGTERM or SIGHUP more than a
 * second later ends the process at once, with the same message and exit
 * status; SIGUSR1, a batch system's warning, never does. */
int vg_display_interrupted(void);

/** Whether to stop: a signal came, or d was asked to. For libraries that ask;
 * d is a display, or NULL. */
int vg_display_stop(void *d);

/** VG_ERR_STOPPED then, with a message. d may be NULL. */
vg_status vg_display_stopped(struct vg_display *d, struct vg_error *err);

/** on: from now on the first of these signals ends the process at once, with a
 * message and VG_EXIT_FAILED, wherever it is. For commands, or parts of them,
 * that leave nothing half-written. */
void vg_display_end_at_once(int on);

/** A process that was asked to stop, but by SIGUSR1, and has not ended so many
 * seconds later is ended then, wherever it is, with the same message and exit
 * status: the folder of vg_display_temporary is removed before. For programs
 * that ask vg_display_interrupted only now and then. Once. */
void vg_display_deadline(double seconds);

/** The folder of what is half-written; NULL: none any more. Copied. Threads:
 * one at a time. */
void vg_display_temporary(const char *dir);

/** From now on the outcome is put into its place: the process ends by itself,
 * whatever it was asked before. */
void vg_display_commit(void);

/** Wall clock in seconds, from any start. */
double vg_display_now(void);

#endif
