/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/shared_file.h: one file written by all ranks at different offsets,
 * with MPI-IO, or with pwrite in a job without MPI. Uses base/comm.h.
 *
 * With Open MPI 4.1.4 and two ranks on a busy machine, ompio writes blocks of
 * 64 kB to 4 MB at 1 to 3 GB/s to tmpfs and to the page cache of ext4; pwrite
 * reaches 1 to 4 GB/s. Neither is the bottleneck. Independent writes by several
 * threads are correct; ompio serialises them. Both ompio and ROMIO need the
 * handling of full disks in shared_file.c. */
#ifndef VG_IO_STREAM_SHARED_FILE_H
#define VG_IO_STREAM_SHARED_FILE_H

#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"

struct vg_shared_file;

/** Open PATH.part of `size` bytes for writing. Collective; all ranks return the
 * same status. VG_ERR_IO with the path and the system's reason, also if the
 * disk has not enough space: where the file system supports it, all of it is
 * reserved now. Bytes that are never written are zero. */
vg_status vg_shared_open(struct vg_comm *comm, const char *path, uint64_t size,
                         struct vg_shared_file **out, struct vg_error *err);

/** Write n bytes at offset `at`, preferably in blocks of 64 kB or more. Local.
 * Threads: safe on one file. */
vg_status vg_shared_write(struct vg_shared_file *f, uint64_t at, uint64_t n,
                          const void *data, struct vg_error *err);

/** Close and free. `mine` is the status of this rank and *err its message. If
 * the status of all ranks is VG_OK the file is renamed to its final name,
 * otherwise it is removed. Collective; all ranks return the same status. */
vg_status vg_shared_close(struct vg_shared_file *f, vg_status mine,
                          struct vg_error *err);

#endif
