/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/commit/commit.h: a set of files that appear in a folder together, or not
 * at all, also if the process is killed or the machine fails. Uses base.
 *
 * New files are written to DIR/.vanguard-NAME/new. vg_commit_run brings them to
 * the disk, writes a journal of the moves, and moves the files. The next
 * vg_commit_open with the same DIR and NAME completes or undoes moves that were
 * interrupted. A lock in the hidden folder admits one process at a time.
 *
 * Files of .vanguard-NAME: `lock`; `new`; `old` with the replaced files until
 * all moves are done; `journal` while moves are being done, or `undo` while
 * they are being undone. docs/design/methods.md gives the order of the steps
 * and the reason for each. */
#ifndef VG_RUN_COMMIT_COMMIT_H
#define VG_RUN_COMMIT_COMMIT_H

#include "run/commit/journal.h"

struct vg_commit {
  char *dir;    /* Folder of the targets. */
  char *hidden; /* DIR/.vanguard-NAME. */
  char *fresh;  /* DIR/.vanguard-NAME/new, for the new files. */
  int lock;
  int is_kept; /* 1: the hidden folder is left to the next run. */
  struct vg_journal moves;
};

/** Receives a line for people about an interrupted earlier commit. */
typedef void vg_commit_note(void *user, const char *text);

/** Makes and locks the hidden folder. Remains of an earlier process are dealt
 * with before: interrupted moves are completed or undone, and files that were
 * not complete are removed; `note` (may be NULL) receives a line on either.
 *
 * VG_ERR_INPUT: another process has the lock; the message names it. VG_ERR_IO:
 * the folder cannot be written, or an interrupted commit can be neither
 * completed nor undone. */
vg_status vg_commit_open(const char *dir, const char *name,
                         vg_commit_note *note, void *user,
                         struct vg_commit *out, struct vg_error *err);

/** Does the same for the hidden folders of all other names in dir, whose
 * processes have ended, and removes them. `own` (or NULL) is open in dir.
 * Failures are notes. */
void vg_commit_sweep(const char *dir, const struct vg_commit *own,
                     vg_commit_note *note, void *user);

/** Adds the move of a new file or folder: `from` in the folder `fresh`
 * replaces `to` in DIR. `to` may be an absolute path on the same file system.
 * VG_MOVE_REMOVE: removes `to`; `from` is "". */
vg_status vg_commit_add(struct vg_commit *c, enum vg_move_kind kind,
                        const char *from, const char *to, struct vg_error *err);

/** Brings all new files to the disk (fsync). vg_commit_run does it as well;
 * files that are on the disk already cost nothing. */
vg_status vg_commit_sync(const struct vg_commit *c, struct vg_error *err);

/** Does all moves; once, the last call before vg_commit_close. After a failure
 * all targets are as before. If they cannot be restored, the message says so,
 * and the hidden folder stays with the old files for the next
 * vg_commit_open. */
vg_status vg_commit_run(struct vg_commit *c, struct vg_error *err);

/** Removes the hidden folder with all files that were not moved, and releases
 * the lock. */
void vg_commit_close(struct vg_commit *c);

#endif
