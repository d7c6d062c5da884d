/* io/shared_file.h: one file written by all ranks, each at its own places, by
 * MPI-IO; by pwrite in a job without MPI. Uses base/comm.h. */
#ifndef VG_IO_SHARED_FILE_H
#define VG_IO_SHARED_FILE_H

#include <stdint.h>

#include "base/comm.h"
#include "base/status.h"

struct vg_shared_file;

/** Open PATH.part of `size` bytes for writing. Collective. VG_ERR_IO with the
 * path and the system's reason; VG_ERR_IO too when the disk has no room. */
vg_status vg_shared_open(struct vg_comm *comm, const char *path,
                         uint64_t size, struct vg_shared_file **out,
                         struct vg_error *err);

/** Write n bytes at offset `at`. Threads: safe. */
vg_status vg_shared_write(struct vg_shared_file *f, uint64_t at, uint64_t n,
                          const void *data, struct vg_error *err);

/** Close; mine: how this rank fared. If all ranks are well the file gets its
 * name, else it is removed. Collective; the same answer on all ranks. */
vg_status vg_shared_close(struct vg_shared_file *f, vg_status mine,
                          struct vg_error *err);

#endif
