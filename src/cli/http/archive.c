/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/http/archive.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"

/* Formats: POSIX 1003.1-1988 (ustar) headers; sizes of 8 GB and more in base
 * 256, and names of more than 99 bytes in an entry of type 'L' before the file,
 * as GNU tar writes and others read them. */
enum { BLOCK = 512, NAME = 100, END = 2 * BLOCK };

struct entry {
  char *name; /* relative to the folder */
  uint64_t size;
  int64_t time;
};

struct vg_archive {
  char *prefix;
  int dir; /* the folder */
  size_t n, cap;
  struct entry *entry;
  /* The current position: */
  size_t at;           /* entry */
  int fd;              /* its file; -1: its header has not been made */
  uint64_t left, pad;  /* bytes of the file, and of zeros after it */
  char *head;          /* bytes in front of the file */
  size_t n_head, sent; /* size of `head`, and how much of it has been sent */
  uint64_t end;        /* zeros at the end that have been sent */
};

void vg_archive_free(struct vg_archive *a)
{
  if (!a) return;
  for (size_t i = 0; i < a->n; i++) free(a->entry[i].name);
  free(a->entry);
  free(a->prefix);
  free(a->head);
  if (a->fd >= 0) close(a->fd);
  if (a->dir >= 0) close(a->dir);
  free(a);
}

/* --- list ---------------------------------------------------------------- */

static vg_status add(struct vg_archive *a, char *name, const struct stat *s,
                     struct vg_error *err)
{
  if (a->n == VG_ARCHIVE_FILES) {
    free(name);
    return vg_fail(err, VG_ERR_INPUT,
                   "this run has more than %d files; copy its folder instead",
                   VG_ARCHIVE_FILES);
  }
  if (vg_reserve(&a->entry, &a->cap, a->n + 1, sizeof *a->entry)) {
    free(name);
    return vg_fail_memory(err, "an archive");
  }
  a->entry[a->n].name = name;
  a->entry[a->n].size = (uint64_t)s->st_size;
  a->entry[a->n++].time = s->st_mtime;
  return VG_OK;
}

static vg_status list(struct vg_archive *a, int dir, const char *under,
                      const char *skip, int depth, struct vg_error *err);

static vg_status list_one(struct vg_archive *a, int dir, const char *under,
                          const char *name, int depth, struct vg_error *err)
{
  struct stat s;
  char *path;
  vg_status st = VG_OK;
  int fd;

  if (fstatat(dir, name, &s, AT_SYMLINK_NOFOLLOW)) return VG_OK;
  if (asprintf(&path, "%s%s%s", under, *under ? "/" : "", name) < 0)
    return vg_fail_memory(err, "a path");
  if (S_ISREG(s.st_mode)) return add(a, path, &s, err);
  if (S_ISDIR(s.st_mode) && depth < VG_ARCHIVE_DEPTH) {
    fd = openat(dir, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    if (fd >= 0) st = list(a, fd, path, NULL, depth + 1, err);
  }
  free(path);
  return st;
}

static vg_status list(struct vg_archive *a, int dir, const char *under,
                      const char *skip, int depth, struct vg_error *err)
{
  DIR *d = fdopendir(dir);
  struct dirent *e;
  vg_status st = VG_OK;

  if (!d) {
    close(dir);
    return VG_OK;
  }
  while (st >= 0 && (e = readdir(d)))
    if (*e->d_name != '.' && !(skip && !strcmp(skip, e->d_name)))
      st = list_one(a, dirfd(d), under, e->d_name, depth, err);
  closedir(d);
  return st;
}

static int by_name(const void *a, const void *b)
{
  return strcmp(((const struct entry *)a)->name,
                ((const struct entry *)b)->name);
}

vg_status vg_archive_open(const char *dir, const char *prefix, const char *skip,
                          struct vg_archive **out, struct vg_error *err)
{
  struct vg_archive *a = vg_calloc(1, sizeof *a);
  int fd;
  vg_status st;

  if (!a) return vg_fail_memory(err, "an archive");
  a->fd = -1;
  a->prefix = strdup(prefix);
  a->dir = open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  fd = a->dir < 0 ? -1 : openat(a->dir, ".", O_RDONLY | O_CLOEXEC);
  if (fd < 0) {
    st = vg_fail(err, VG_ERR_IO, "%s: %s", dir, strerror(errno));
    goto done;
  }
  if (!a->prefix) {
    close(fd);
    st = vg_fail_memory(err, "an archive");
    goto done;
  }
  VG_TRY(list(a, fd, "", skip, 0, err));
  if (a->n) qsort(a->entry, a->n, sizeof *a->entry, by_name);
  *out = a;
  return VG_OK;
done:
  vg_archive_free(a);
  return st;
}

/* --- headers ------------------------------------------------------------- */

static uint64_t padding(uint64_t size)
{
  return (BLOCK - size % BLOCK) % BLOCK;
}

static size_t name_length(const struct vg_archive *a, const struct entry *e)
{
  return strlen(a->prefix) + 1 + strlen(e->name);
}

/* Bytes in front of a file: its header, and its name if that is long. */
static size_t head_size(const struct vg_archive *a, const struct entry *e)
{
  size_t n = name_length(a, e);

  return n < NAME ? BLOCK : 2 * BLOCK + n + 1 + padding(n + 1);
}

uint64_t vg_archive_size(const struct vg_archive *a)
{
  uint64_t sum = END;

  for (size_t i = 0; i < a->n; i++)
    sum += head_size(a, &a->entry[i]) + a->entry[i].size +
           padding(a->entry[i].size);
  return sum;
}

/* A number of `n` - 1 octal digits, or, if it is larger, in base 256. */
static void put_number(char *to, size_t n, uint64_t v)
{
  if (v >> 3 * (n - 1)) {
    for (size_t i = n; i-- > 0; v >>= 8) to[i] = (char)(v & 255);
    to[0] = (char)0x80;
    return;
  }
  to[n - 1] = 0;
  for (size_t i = n - 1; i-- > 0; v >>= 3) to[i] = (char)('0' + (v & 7));
}

static void put_header(char h[BLOCK], const char *name, uint64_t size,
                       int64_t when, char type)
{
  unsigned sum = 0;

  memset(h, 0, BLOCK);
  snprintf(h, NAME, "%s", name);
  put_number(h + 100, 8, 0644);
  put_number(h + 108, 8, 0);
  put_number(h + 116, 8, 0);
  put_number(h + 124, 12, size);
  put_number(h + 136, 12, when > 0 ? (uint64_t)when : 0);
  memset(h + 148, ' ', 8);
  h[156] = type;
  memcpy(h + 257,
         "ustar\0"
         "00",
         8);
  for (int i = 0; i < BLOCK; i++) sum += (unsigned char)h[i];
  put_number(h + 148, 7, sum);
}

static int make_head(struct vg_archive *a, const struct entry *e)
{
  size_t n = name_length(a, e);
  char *name;

  a->n_head = head_size(a, e);
  a->sent = 0;
  free(a->head);
  a->head = vg_calloc(a->n_head, 1);
  if (!a->head || asprintf(&name, "%s/%s", a->prefix, e->name) < 0) return 0;
  if (n >= NAME) {
    put_header(a->head, "././@LongLink", n + 1, 0, 'L');
    memcpy(a->head + BLOCK, name, n);
  }
  put_header(a->head + a->n_head - BLOCK, name, e->size, e->time, '0');
  free(name);
  return 1;
}

/* --- reading ------------------------------------------------------------- */

/* Open the file of the current entry; 0: it is not the file that was
 * listed. */
static int begin(struct vg_archive *a)
{
  const struct entry *e = &a->entry[a->at];
  struct stat s;

  a->fd = openat(a->dir, e->name,
                 O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (a->fd < 0 || fstat(a->fd, &s) || !S_ISREG(s.st_mode) ||
      (uint64_t)s.st_size < e->size)
    return 0;
  a->left = e->size;
  a->pad = padding(e->size);
  return make_head(a, e);
}

static size_t least(uint64_t a, size_t b)
{
  return a < b ? (size_t)a : b;
}

/* The next piece of the current entry; 0: the entry is complete. */
static ssize_t piece(struct vg_archive *a, char *to, size_t most)
{
  size_t n = least(a->n_head - a->sent, most);
  ssize_t got;

  if (n) {
    memcpy(to, a->head + a->sent, n);
    a->sent += n;
    return (ssize_t)n;
  }
  if (a->left) {
    do got = read(a->fd, to, least(a->left, most));
    while (got < 0 && errno == EINTR);
    if (got <= 0) return -1;
    a->left -= (uint64_t)got;
    return got;
  }
  n = least(a->pad, most);
  memset(to, 0, n);
  a->pad -= n;
  return (ssize_t)n;
}

ssize_t vg_archive_read(struct vg_archive *a, char *to, size_t most)
{
  size_t n;

  while (a->at < a->n && most) {
    ssize_t got;

    if (a->fd < 0 && !begin(a)) return -1;
    got = piece(a, to, most);
    if (got) return got;
    close(a->fd);
    a->fd = -1;
    a->at++;
  }
  n = least(END - a->end, most);
  memset(to, 0, n);
  a->end += n;
  return (ssize_t)n;
}
