/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* base/lock/lock.h: a lock file that names its holder. Uses base.
 *
 * The lock is flock(2), which ends with the process, however it ends. On NFS,
 * Lustre (mounted with `flock`), GPFS and CephFS it also excludes processes of
 * other hosts. On a file system without locks, the holder that the file names
 * counts as alive if it is a process of this host that exists, or a process of
 * another host. */
#ifndef VG_BASE_LOCK_LOCK_H
#define VG_BASE_LOCK_LOCK_H

#include "base/status.h"

enum { VG_LOCK_HOLDER = 400 };

/** Takes the lock file `path`, which is created if absent, and writes host,
 * process and time into it.
 *
 * @param at      folder from which `path` starts, or AT_FDCWD, as for openat(2)
 * @param fd      holds the lock until vg_lock_drop or close(2)
 * @param holder  "host H, process P, started T" of the process that has the
 *                lock, with VG_BLOCKED
 * VG_OK; VG_BLOCKED; VG_ERR_IO: errno is the reason. */
vg_status vg_lock_take(int at, const char *path, int *fd,
                       char holder[VG_LOCK_HOLDER]);

/** Removes the file and ends the lock. */
void vg_lock_drop(int at, const char *path, int fd);

#endif
