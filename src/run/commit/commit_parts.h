/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/commit/commit_parts.h: the moves of a commit. Private to run/commit.
 *
 * Every function leaves alone what has been done, so that after an interruption
 * the same or the opposite direction can be repeated from the start. */
#ifndef VG_RUN_COMMIT_COMMIT_PARTS_H
#define VG_RUN_COMMIT_COMMIT_PARTS_H

#include <limits.h>
#include <sys/stat.h>

#include "run/commit/commit.h"

/** Determines which targets exist, refuses those that cannot be replaced, and
 * gives replaced files a second name in `old`. Changes no target. */
vg_status vg_moves_prepare(struct vg_commit *c, struct vg_error *err);

/** 1: a move has still to be done; 0: none; -1: it is not known, errno. */
int vg_moves_left(const struct vg_commit *c);

vg_status vg_moves_do(const struct vg_commit *c, struct vg_error *err);
vg_status vg_moves_undo(const struct vg_commit *c, struct vg_error *err);

/** Brings the names of all targets to the disk. */
vg_status vg_moves_sync(const struct vg_commit *c, struct vg_error *err);

/** "a/b", or b if it is absolute, without memory of the heap: a run that has
 * none left must find a journal and remove its files. A longer path than
 * PATH_MAX is cut, and no call accepts it. */
#define VG_COMMIT_PATH (PATH_MAX + 1)
void vg_commit_path(const char *a, const char *b, char path[VG_COMMIT_PATH]);

/** lstat. Returns 1; 0: there is no such path; -1: it is not known, errno. */
int vg_path_look(const char *path, struct stat *is);

#endif
