/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "partition/store/store_parts.h"

/* Header of a record. The file is not synced to disk: `check` detects a write
 * that a crash of the machine left incomplete. */
struct header {
  char magic[8];
  uint64_t n; /* Bytes of data after the header. */
  struct vg_digest key;
  struct vg_digest check; /* Digest of all members above and of the data. */
};
#define MAGIC "VGREC\r\n\001"

static struct header header_of(struct vg_digest key, size_t n, const void *data)
{
  struct header h = { .n = n, .key = key };
  struct vg_digest start = { { 0, 0 } };

  memcpy(h.magic, MAGIC, sizeof h.magic);
  start = vg_digest_of(start, offsetof(struct header, check), &h);
  h.check = vg_digest_of(start, n, data);
  return h;
}

static void name_of(struct vg_digest key, char name[VG_STORE_NAME])
{
  char text[VG_DIGEST_TEXT];

  vg_digest_text(key, text);
  snprintf(name, VG_STORE_NAME, VG_STORE_RECORDS "/%.2s/%s", text, text);
}

/* --- find ---------------------------------------------------------------- */

/* Returns 1: complete; 0: damaged; -1: no memory. */
static int read_record(int fd, struct vg_digest key, struct vg_bytes *out)
{
  struct header h, expected;
  struct stat info;
  unsigned char *data;

  if (fstat(fd, &info) || !S_ISREG(info.st_mode) ||
      info.st_size < (off_t)sizeof h)
    return 0;
  if (vg_store_get(fd, &h, sizeof h) ||
      h.n != (uint64_t)info.st_size - sizeof h)
    return 0;
  data = vg_alloc(h.n, 1);
  if (!data) return -1;
  if (!vg_store_get(fd, data, h.n)) {
    expected = header_of(key, h.n, data);
    if (!memcmp(&h, &expected, sizeof h)) {
      *out = (struct vg_bytes){ h.n, data };
      return 1;
    }
  }
  free(data);
  return 0;
}

vg_status vg_store_find(struct vg_store *s, struct vg_digest key,
                        struct vg_bytes *out, struct vg_error *err)
{
  char name[VG_STORE_NAME];
  int fd, found = 0;

  assert(out);
  name_of(key, name);
  fd = openat(s->fd, name, O_RDONLY | O_CLOEXEC);
  if (fd < 0 && (errno == ENOENT || errno == ENOTDIR)) return VG_BLOCKED;
  if (fd >= 0) {
    found = read_record(fd, key, out);
    close(fd);
    if (!found) unlinkat(s->fd, name, 0);
  }
  if (found < 0) return vg_fail_memory(err, "the trace of a task");
  pthread_mutex_lock(&s->mutex);
  if (found) s->report.n_found++;
  else s->report.n_damaged++;
  pthread_mutex_unlock(&s->mutex);
  return found ? VG_OK : VG_BLOCKED;
}

/* --- keep ---------------------------------------------------------------- */

/* Reserves n more bytes and a number for the temporary name. Returns 0 if the
 * store may not keep them. */
static int reserve(struct vg_store *s, size_t n, uint64_t *number)
{
  int may;

  pthread_mutex_lock(&s->mutex);
  may = !s->report.stopped[0];
  if (may && n > s->share - s->used) {
    snprintf(s->report.stopped, sizeof s->report.stopped,
             "the limit of %llu bytes over all ranks is reached",
             (unsigned long long)s->limit);
    may = 0;
  }
  if (may) s->used += n;
  *number = s->n_part++;
  pthread_mutex_unlock(&s->mutex);
  return may;
}

static void account(struct vg_store *s, size_t n, int error)
{
  char text[64];

  pthread_mutex_lock(&s->mutex);
  if (!error) {
    s->report.n_kept++;
    s->report.bytes_kept += n;
  } else {
    s->used -= n;
    if (!s->report.stopped[0])
      snprintf(s->report.stopped, sizeof s->report.stopped,
               "a record of %zu bytes could not be written: %s (%.120s)", n,
               strerror_r(error, text, sizeof text), s->dir);
  }
  pthread_mutex_unlock(&s->mutex);
}

/* Folders are created when the first record needs them. */
static int open_part(int dir, const char *part)
{
  const int flags = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
  char folder[sizeof VG_STORE_RECORDS + 3];
  int fd = openat(dir, part, flags, 0666);

  if (fd >= 0 || errno != ENOENT) return fd;
  snprintf(folder, sizeof folder, "%.*s", (int)sizeof folder - 1, part);
  mkdirat(dir, VG_STORE_RECORDS, 0777);
  mkdirat(dir, folder, 0777);
  return openat(dir, part, flags, 0666);
}

/* Returns 0 or errno. */
static int write_record(int dir, const char *part, const char *name,
                        const struct header *h, const void *data)
{
  int fd = open_part(dir, part), error;

  if (fd < 0) return errno;
  error = vg_store_put(fd, h, sizeof *h);
  if (!error) error = vg_store_put(fd, data, h->n);
  /* some file systems report a full disk only here */
  if (close(fd) && !error && errno != EINTR) error = errno;
  if (!error && renameat(dir, part, dir, name)) error = errno;
  if (error) unlinkat(dir, part, 0);
  return error;
}

void vg_store_keep(struct vg_store *s, struct vg_digest key, size_t n,
                   const void *data)
{
  char name[VG_STORE_NAME], part[VG_STORE_NAME + 48];
  uint64_t number;
  struct header h;
  size_t size;

  assert(data || !n);
  if (__builtin_add_overflow(n, sizeof h, &size)) size = SIZE_MAX;
  if (!reserve(s, size, &number)) return;
  h = header_of(key, n, data);
  name_of(key, name);
  snprintf(part, sizeof part, "%s.%d.%llu.part", name, vg_comm_rank(s->comm),
           (unsigned long long)number);
  account(s, size, write_record(s->fd, part, name, &h, data));
}

void vg_store_state(const struct vg_store *s, struct vg_store_report *r)
{
  pthread_mutex_t *mutex = (pthread_mutex_t *)&s->mutex;

  pthread_mutex_lock(mutex);
  *r = s->report;
  pthread_mutex_unlock(mutex);
}

/* --- all of them --------------------------------------------------------- */

static void walk_folder(int folder, int remove, struct vg_store_tally *t)
{
  DIR *d = fdopendir(folder);
  struct dirent *e;

  if (!d) {
    close(folder);
    return;
  }
  while ((e = readdir(d))) {
    struct vg_digest key;
    struct stat info;
    size_t length = strlen(e->d_name);

    if (!vg_digest_parse(e->d_name, &key))
      continue; /* not a file of the
                   store */
    if (length > 32 && strcmp(e->d_name + length - 5, ".part")) continue;
    if (remove || length > 32) {
      unlinkat(folder, e->d_name, 0);
    } else if (!fstatat(folder, e->d_name, &info, 0)) {
      t->n++;
      t->bytes += (uint64_t)info.st_size;
    }
  }
  closedir(d);
}

struct vg_store_tally vg_store_walk(int dir, int remove)
{
  struct vg_store_tally t = { 0, 0 };
  char name[sizeof VG_STORE_RECORDS + 3];

  for (unsigned k = 0; k < 256; k++) {
    int folder;

    snprintf(name, sizeof name, VG_STORE_RECORDS "/%02x", k);
    folder = openat(dir, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder < 0) continue;
    walk_folder(folder, remove, &t);
    if (remove) unlinkat(dir, name, AT_REMOVEDIR);
  }
  if (remove) unlinkat(dir, VG_STORE_RECORDS, AT_REMOVEDIR);
  return t;
}
