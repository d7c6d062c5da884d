/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Memory shared by the ranks of a node; see base/comm.h.
 *
 * The first rank writes an unnamed file. The other ranks open it through /proc,
 * check that it is the intended file, and all of them map it. This avoids the
 * size limit of /dev/shm in containers, and a job that dies leaves nothing
 * behind. The file is filled by write rather than by stores into the mapping,
 * since write reports a lack of memory as an error. */
#define _GNU_SOURCE
#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/comm_parts.h"
#include "base/memory.h"

struct ticket {
  uint64_t n, device, inode;
  int64_t process, file; /* file < 0: there is no file */
};

/* At least 1, since an empty file cannot be mapped. */
static size_t total(size_t n_part, const struct vg_bytes *part)
{
  size_t n = 0;

  for (size_t i = 0; i < n_part; i++) n += vg_shmem_padded(part[i].n);
  return n ? n : 1;
}

/* --- shared memory ------------------------------------------------------- */

static int write_part(int file, const struct vg_bytes *b, size_t at)
{
  for (size_t done = 0; done < b->n;) {
    ssize_t n = pwrite(file, b->data + done, b->n - done, (off_t)(at + done));

    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return -1;
    done += (size_t)n;
  }
  return 0;
}

static int write_file(int file, size_t n_part, const struct vg_bytes *part,
                      struct ticket *t)
{
  struct stat is;
  size_t at = 0;

  if (ftruncate(file, (off_t)t->n) || fstat(file, &is)) return -1;
  for (size_t i = 0; i < n_part; at += vg_shmem_padded(part[i++].n))
    if (write_part(file, &part[i], at)) return -1;
  t->device = (uint64_t)is.st_dev;
  t->inode = (uint64_t)is.st_ino;
  t->process = (int64_t)getpid();
  return 0;
}

static int make_file(size_t n_part, const struct vg_bytes *part,
                     struct ticket *t)
{
  int file = memfd_create("vanguard", MFD_CLOEXEC);

  t->n = total(n_part, part);
  if (file >= 0 && write_file(file, n_part, part, t)) {
    close(file);
    file = -1;
  }
  t->file = file;
  return file;
}

/* Open the file of another process through /proc. In another PID namespace the
 * same path may denote another file, so its identity is checked. */
static int open_file(const struct ticket *t, int writes)
{
  char name[80];
  struct stat is;
  int file;

  if (t->file < 0) return -1;
  snprintf(name, sizeof name, "/proc/%lld/fd/%lld", (long long)t->process,
           (long long)t->file);
  file = open(name, (writes ? O_RDWR : O_RDONLY) | O_CLOEXEC);
  if (file < 0) return -1;
  if (!fstat(file, &is) && (uint64_t)is.st_dev == t->device &&
      (uint64_t)is.st_ino == t->inode && (uint64_t)is.st_size == t->n)
    return file;
  close(file);
  return -1;
}

static unsigned char *map(int file, size_t n, int writes)
{
  void *at = mmap(NULL, n, PROT_READ | (writes ? PROT_WRITE : 0),
                  MAP_SHARED | MAP_POPULATE, file, 0);

  return at == MAP_FAILED ? NULL : at;
}

/* VG_BLOCKED on all ranks of the node if one of them cannot map the file. */
static vg_status share(const struct vg_comm *c, size_t n_part,
                       const struct vg_bytes *part, int writes,
                       struct vg_shmem *out, struct vg_error *err)
{
  struct ticket t = { .file = -1 };
  unsigned char *at = NULL;
  MPI_Request request;
  int rc, file = -1;
  vg_status st;

  if (!c->node_rank && !c->apart) file = make_file(n_part, part, &t);
  rc = MPI_Ibcast(&t, (int)sizeof t, MPI_BYTE, 0, c->node, &request);
  if (!rc) rc = vg_comm_wait(1, &request, 0);
  st = rc ? vg_comm_fail(err, "the memory that the ranks of a node share", rc)
          : VG_BLOCKED;
  if (!rc && c->node_rank) file = open_file(&t, writes);
  if (file >= 0 && (at = map(file, (size_t)t.n, writes))) st = VG_OK;
  st = vg_comm_agree_in(c, c->node, st, err);
  if (file >= 0) close(file);
  if (st == VG_OK) *out = (struct vg_shmem){ (size_t)t.n, at, 1 };
  else if (at) munmap(at, (size_t)t.n);
  return st;
}

/* --- a copy on each rank ------------------------------------------------- */

static vg_status join_parts(size_t n_part, const struct vg_bytes *part,
                            struct vg_bytes *b, struct vg_error *err)
{
  size_t at = 0;

  b->n = total(n_part, part);
  b->data = vg_calloc(b->n, 1);
  if (!b->data)
    return vg_fail_memory(err, "the data that the ranks of a node share");
  for (size_t i = 0; i < n_part; at += vg_shmem_padded(part[i++].n))
    if (part[i].n) memcpy(b->data + at, part[i].data, part[i].n);
  return VG_OK;
}

static vg_status copy(struct vg_comm *c, size_t n_part,
                      const struct vg_bytes *part, struct vg_shmem *out,
                      struct vg_error *err)
{
  struct vg_bytes b = { 0, NULL };
  vg_status st = VG_OK;

  if (!vg_comm_node_rank(c)) st = join_parts(n_part, part, &b, err);
  if (c) st = vg_comm_agree_in(c, c->node, st, err);
  if (st >= 0) st = vg_comm_node_bcast(c, &b, err);
  if (st >= 0) *out = (struct vg_shmem){ b.n, b.data, 0 };
  else free(b.data);
  return st;
}

vg_status vg_comm_node_memory(struct vg_comm *c, size_t n_part,
                              const struct vg_bytes *part, int writes,
                              struct vg_shmem *out, struct vg_error *err)
{
  vg_status st = VG_BLOCKED;

  if (vg_comm_node_size(c) > 1) st = share(c, n_part, part, writes, out, err);
  return st == VG_BLOCKED ? copy(c, n_part, part, out, err) : st;
}

vg_status vg_comm_node_shmem(struct vg_comm *c, size_t n_part,
                             const struct vg_bytes *part, struct vg_shmem *out,
                             struct vg_error *err)
{
  assert(out && (part || !n_part || vg_comm_node_rank(c)));
  return vg_comm_node_memory(c, n_part, part, 0, out, err);
}

void vg_shmem_release(struct vg_shmem *b)
{
  assert(b);
  if (b->is_mapped) munmap((void *)(uintptr_t)b->data, b->n);
  else free((void *)(uintptr_t)b->data);
  *b = (struct vg_shmem){ 0, NULL, 0 };
}
