/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* One file written by all ranks; see io/stream/shared_file.h. */
#define _GNU_SOURCE
#include "io/stream/shared_file.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <mpi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "base/memory.h"
#include "io/stream/stream.h"

/* Bytes per call, far below the 2^31 limit of MPI's counts and of write(2). */
#define CHUNK ((uint64_t)1 << 28)

struct vg_shared_file {
  struct vg_comm *comm;
  MPI_File file; /* used in a job with MPI */
  int fd; /* the file in a job without MPI; otherwise used to find out why
             MPI could not write */
  uint64_t size;
  char *path, *part;
};

static void release(struct vg_shared_file *f)
{
  if (!f) return;
  if (f->fd >= 0) close(f->fd);
  free(f->path);
  free(f->part);
  free(f);
}

static vg_status fail(const struct vg_shared_file *f, const char *what,
                      int error, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_IO, "%s: %s: %s", f->part, what, strerror(error));
}

static vg_status no_room(const struct vg_shared_file *f, int error,
                         struct vg_error *err)
{
  if (error == EFBIG)
    return vg_fail(err, VG_ERR_IO,
                   "%s: the file system or a limit of the shell (ulimit -f) "
                   "allows no file of %" PRIu64 " bytes: %s",
                   f->part, f->size, strerror(error));
  return vg_fail(err, VG_ERR_IO,
                 "%s: there is not enough space for %" PRIu64
                 " bytes: %s; free some space or write to another disk",
                 f->part, f->size, strerror(error));
}

/* --- opening ------------------------------------------------------------- */

/* Reserve the disk space now, so that a full disk is detected before an hour of
 * writing. Where the file system cannot reserve space, compare with the free
 * space. This uses fallocate rather than posix_fallocate, which without support
 * by the file system writes to every block. */
static vg_status reserve(const struct vg_shared_file *f, struct vg_error *err)
{
  struct statvfs disk;
  int error;

  if (!f->size) return VG_OK;
  do error = fallocate(f->fd, 0, 0, (off_t)f->size) ? errno : 0;
  while (error == EINTR);
  if (error && error != EOPNOTSUPP && error != ENOSYS)
    return no_room(f, error, err);
  if (error && !fstatvfs(f->fd, &disk) &&
      f->size / disk.f_frsize > disk.f_bavail)
    return no_room(f, ENOSPC, err);
  if (error && ftruncate(f->fd, (off_t)f->size))
    return fail(f, "cannot write", errno, err);
  return VG_OK;
}

/* Create the file, on rank 0. */
static vg_status create(struct vg_shared_file *f, struct vg_error *err)
{
  vg_status st;

  f->fd = open(f->part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (f->fd < 0) return fail(f, "cannot write", errno, err);
  st = reserve(f, err);
  if (st < 0) unlink(f->part);
  return st;
}

/* Open the file on the other ranks after it has been created. */
static vg_status find(struct vg_shared_file *f, struct vg_error *err)
{
  f->fd = open(f->part, O_WRONLY | O_CLOEXEC);
  if (f->fd >= 0) return VG_OK;
  if (errno != ENOENT) return fail(f, "cannot write", errno, err);
  return vg_fail(err, VG_ERR_IO,
                 "%s: created by rank 0 but not found by this rank; write "
                 "to a file system that all nodes share",
                 f->part);
}

static vg_status fail_mpi(const struct vg_shared_file *f, int rc,
                          struct vg_error *err)
{
  char text[MPI_MAX_ERROR_STRING + 1] = "";
  int n;

  if (MPI_Error_string(rc, text, &n)) text[0] = 0;
  return vg_fail(err, VG_ERR_IO, "%s: cannot write with MPI-IO: %s", f->part,
                 text);
}

/* All ranks can open the file, so MPI should be able to. If it fails on one
 * rank, the other ranks leave the file open, because closing it is collective
 * and would block. */
static vg_status open_mpi(struct vg_shared_file *f, struct vg_error *err)
{
  MPI_Comm comm = *(const MPI_Comm *)vg_comm_mpi(f->comm);
  int rc = MPI_File_open(comm, f->part, MPI_MODE_WRONLY, MPI_INFO_NULL,
                         &f->file);

  return vg_comm_agree(f->comm, rc ? fail_mpi(f, rc, err) : VG_OK, err);
}

static vg_status prepare(struct vg_comm *comm, const char *path, uint64_t size,
                         struct vg_shared_file **out, struct vg_error *err)
{
  struct vg_shared_file *f = vg_calloc(1, sizeof *f);

  if (!f) return vg_fail_memory(err, "a file");
  f->comm = comm;
  f->fd = -1;
  f->size = size;
  f->path = strdup(path);
  f->part = vg_output_part(path);
  *out = f;
  if (!f->path || !f->part) return vg_fail_memory(err, "a file's name");
  if (size > INT64_MAX)
    return vg_fail(err, VG_ERR_IO, "%s: no file can have %" PRIu64 " bytes",
                   path, size);
  return VG_OK;
}

vg_status vg_shared_open(struct vg_comm *comm, const char *path, uint64_t size,
                         struct vg_shared_file **out, struct vg_error *err)
{
  assert(path && out);

  struct vg_shared_file *f = NULL;
  int is_first = !vg_comm_rank(comm), is_there = 0;
  vg_status st = prepare(comm, path, size, &f, err);

  VG_TRY(vg_comm_agree(comm, st, err));
  if (is_first) st = create(f, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  is_there = is_first;
  if (!is_first) st = find(f, err);
  VG_TRY(vg_comm_agree(comm, st, err));
  if (comm) VG_TRY(open_mpi(f, err));
  *out = f;
  return VG_OK;
done:
  if (is_there) unlink(f->part);
  release(f);
  return st;
}

/* --- writing ------------------------------------------------------------- */

static vg_status write_plain(const struct vg_shared_file *f, uint64_t at,
                             uint64_t n, const unsigned char *data,
                             struct vg_error *err)
{
  while (n) {
    ssize_t put = pwrite(f->fd, data, n < CHUNK ? n : CHUNK, (off_t)at);

    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return fail(f, "cannot write", put ? errno : ENOSPC, err);
    at += (uint64_t)put;
    data += put;
    n -= (uint64_t)put;
  }
  return VG_OK;
}

/* On a full disk Open MPI 4.1.4 returns MPI_SUCCESS with a count of 0, so the
 * count must be checked; and neither it nor ROMIO tells the reason. Bytes that
 * could not be written are therefore written once more without MPI, which
 * either succeeds or gives the system's reason. No lock is needed: several
 * threads may use a handle, and ompio locks it itself. */
static vg_status write_mpi(const struct vg_shared_file *f, uint64_t at,
                           uint64_t n, const unsigned char *data,
                           struct vg_error *err)
{
  while (n) {
    MPI_Status status;
    int m = (int)(n < CHUNK ? n : CHUNK), put = 0, rc;

    rc = MPI_File_write_at(f->file, (MPI_Offset)at, data, m, MPI_BYTE, &status);
    if (!rc) rc = MPI_Get_count(&status, MPI_BYTE, &put);
    if (rc || put <= 0 || put > m) return write_plain(f, at, n, data, err);
    at += (uint64_t)put;
    data += put;
    n -= (uint64_t)put;
  }
  return VG_OK;
}

vg_status vg_shared_write(struct vg_shared_file *f, uint64_t at, uint64_t n,
                          const void *data, struct vg_error *err)
{
  assert(data || !n);
  if (at > f->size || n > f->size - at)
    return vg_fail(err, VG_ERR_IO,
                   "%s: %" PRIu64 " bytes at %" PRIu64 " go beyond the %" PRIu64
                   " that were announced",
                   f->part, n, at, f->size);
  return f->comm ? write_mpi(f, at, n, data, err)
                 : write_plain(f, at, n, data, err);
}

/* --- closing ------------------------------------------------------------- */

static vg_status close_all(struct vg_shared_file *f, struct vg_error *err)
{
  vg_status st = VG_OK;
  int rc = f->comm ? MPI_File_close(&f->file) : MPI_SUCCESS;

  if (rc) st = fail_mpi(f, rc, err);
  if (close(f->fd) && st >= 0) st = fail(f, "cannot write", errno, err);
  f->fd = -1;
  return st;
}

static vg_status give_name(const struct vg_shared_file *f, struct vg_error *err)
{
  struct stat s;

  if (stat(f->part, &s))
    return fail(f, "lost while it was written", errno, err);
  if ((uint64_t)s.st_size != f->size)
    return vg_fail(err, VG_ERR_IO,
                   "%s: has %" PRIu64 " bytes instead of %" PRIu64
                   "; is another program writing to it?",
                   f->part, (uint64_t)s.st_size, f->size);
  if (rename(f->part, f->path))
    return vg_fail(err, VG_ERR_IO, "%s: cannot write: %s", f->path,
                   strerror(errno));
  return VG_OK;
}

/* MPI spins while it waits in MPI_File_close, so the ranks synchronise
 * before. */
vg_status vg_shared_close(struct vg_shared_file *f, vg_status mine,
                          struct vg_error *err)
{
  vg_status st = vg_comm_agree(f->comm, mine, err), closed;
  struct vg_error why = VG_ERROR_INIT;
  int is_first = !vg_comm_rank(f->comm);

  closed = vg_comm_agree(f->comm, close_all(f, &why), &why);
  if (st == VG_OK && closed == VG_OK) {
    if (is_first) closed = give_name(f, &why);
    closed = vg_comm_agree(f->comm, closed, &why);
  }
  if (st == VG_OK && closed != VG_OK) st = vg_fail(err, closed, "%s", why.text);
  if (st != VG_OK && is_first) unlink(f->part);
  release(f);
  return st;
}
