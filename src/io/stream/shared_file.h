/* io/stream/shared_file.h: one file written by all ranks, each at its own
 * places, by MPI-IO; by pwrite in a job without MPI. Uses base/comm.h.
 *
 * Open MPI 4.1.4, two ranks on a busy machine: ompio writes pieces of 64 kB to
 * 4 MB at 1 to 3 GB/s to tmpfs and ext4's cache, pwrite at 1 to 4: neither is
 * what limits. Independent writes of several threads come out right; ompio
 * does them one after the other. Both ompio and ROMIO need the care that
 * shared_file.c takes with full disks. */
#ifndef VG_IO_STREAM_SHARED_FILE_H
#define VG_IO_STREAM_SHARED_FILE_H

#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"

struct vg_shared_file;

/** Open PATH.part of `size` bytes for writing. Collective; the same answer on
 * all ranks. VG_ERR_IO with the path and the system's reason; VG_ERR_IO too
 * when the disk has no room, since all of it is reserved now where the file
 * system can. Bytes that are never written are zero. */
vg_status vg_shared_open(struct vg_comm *comm, const char *path, uint64_t size,
                         struct vg_shared_file **out, struct vg_error *err);

/** Write n bytes at offset `at`; best in pieces of 64 kB or more. Local.
 * Threads: safe on one file. */
vg_status vg_shared_write(struct vg_shared_file *f, uint64_t at, uint64_t n,
                          const void *data, struct vg_error *err);

/** Close and free; mine: how this rank fared, *err its message. If all ranks
 * are well (VG_OK) the file gets its name, else it is removed. Collective; the
 * same answer on all ranks. */
vg_status vg_shared_close(struct vg_shared_file *f, vg_status mine,
                          struct vg_error *err);

#endif
