/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/commit/commit_parts.h: the moves of a commit. Private to run/commit.
 *
 * Every function leaves alone what has been done, so that after an interruption
 * the same or the opposite direction can be repeated from the start. */
#ifndef VG_RUN_COMMIT_COMMIT_PARTS_H
#define VG_RUN_COMMIT_COMMIT_PARTS_H

#include "run/commit/commit.h"

/** Determines which targets exist, refuses those that cannot be replaced, and
 * gives replaced files a second name in `old`. Changes no target. */
vg_status vg_moves_prepare(struct vg_commit *c, struct vg_error *err);

vg_status vg_moves_do(const struct vg_commit *c, struct vg_error *err);
vg_status vg_moves_undo(const struct vg_commit *c, struct vg_error *err);

/** Brings the names of all targets to the disk. */
vg_status vg_moves_sync(const struct vg_commit *c, struct vg_error *err);

/** "a/b", or b if it is absolute. NULL: no memory. */
char *vg_commit_path(const char *a, const char *b);

int vg_path_exists(const char *path);

#endif
