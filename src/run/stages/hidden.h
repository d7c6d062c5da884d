/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/stages/hidden.h: the hidden folder DIR/.vanguard-XXXXXX of the files that
 * a run has not completed.
 *
 * Its file `lock` names the host and is locked by flock(2) while the run is
 * alive. The lock ends with the process, however it ends, so that a later run
 * recognises and removes the folder of a run that was killed. */
#ifndef VG_RUN_STAGES_HIDDEN_H
#define VG_RUN_STAGES_HIDDEN_H

#include "run/input/input.h"

/** Make a folder in `dir` and lock it.
 *
 * @param path  its path, to be freed
 * @param lock  descriptor that holds the lock, for vg_hidden_remove
 * VG_ERR_IO: errno is the reason. */
vg_status vg_hidden_make(const char *dir, char **path, int *lock,
                         struct vg_error *err);

/** Remove a folder of vg_hidden_make with its content and its lock. */
void vg_hidden_remove(const char *path, int lock);

/** Remove the folders in `dir` of runs that were killed, and note each of them
 * with its size. A folder stays, and is noted, if it is not certain that its
 * run has ended: it has no lock, its file system does not support locks, or a
 * run on another host has written to it within the last day. A folder whose
 * lock is held stays without a note. Failures are not errors. */
void vg_hidden_sweep(const char *dir, struct vg_notes *notes);

#endif
