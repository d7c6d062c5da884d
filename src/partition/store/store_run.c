/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/lock/lock.h"
#include "partition/store/store_parts.h"

#define RUN "run.txt"
#define LOCK "run.lock"
#define FIRST_LINE "vanguard run 1\n"

int vg_store_get(int fd, void *data, size_t n)
{
  char *at = data;

  while (n) {
    ssize_t k = read(fd, at, n);

    if (k < 0 && errno == EINTR) continue;
    if (k <= 0) return k < 0 ? errno : EIO;
    at += k;
    n -= (size_t)k;
  }
  return 0;
}

int vg_store_put(int fd, const void *data, size_t n)
{
  const char *at = data;

  while (n) {
    ssize_t k = write(fd, at, n);

    if (k < 0 && errno == EINTR) continue;
    if (k <= 0) return k < 0 ? errno : ENOSPC;
    at += k;
    n -= (size_t)k;
  }
  return 0;
}

static vg_status cannot_write(const struct vg_store *s, int error,
                              struct vg_error *err)
{
  char text[64];

  return vg_fail(err, VG_ERR_IO,
                 "%s: the run directory cannot be written: "
                 "%s; choose another one",
                 s->dir, strerror_r(error, text, sizeof text));
}

/* --- run.txt ------------------------------------------------------------- */

/* Reads the start of a small file as text; returns its length, or -1. */
static ssize_t read_text(int fd, char *text, size_t size)
{
  ssize_t n;

  do n = pread(fd, text, size - 1, 0);
  while (n < 0 && errno == EINTR);
  text[n < 0 ? 0 : n] = 0;
  return n;
}

static int parse_run(const char *text, struct vg_store_run *run)
{
  const char *job = text + strlen(FIRST_LINE), *what;
  size_t length;

  if (strncmp(text, FIRST_LINE, strlen(FIRST_LINE)) ||
      strncmp(job, "job=", 4) || !vg_digest_parse(job + 4, &run->job))
    return 0;
  what = job + 4 + 32;
  if (strncmp(what, "\nwhat=", 6)) return 0;
  what += 6;
  length = strcspn(what, "\n");
  if (what[length] != '\n' || length >= sizeof run->what) return 0;
  memcpy(run->what, what, length);
  run->what[length] = 0;
  return 1;
}

vg_status vg_store_read_run(const struct vg_store *s, struct vg_store_run *run,
                            struct vg_error *err)
{
  int fd = openat(s->fd, RUN, O_RDONLY | O_CLOEXEC), error = errno;
  char text[512], reason[64];
  ssize_t n;

  if (fd < 0 && error == ENOENT) return VG_BLOCKED;
  n = fd < 0 ? -1 : read_text(fd, text, sizeof text);
  if (n < 0) {
    if (fd >= 0) error = errno;
    if (fd >= 0) close(fd);
    return vg_fail(err, VG_ERR_IO,
                   "%s/" RUN ": cannot be read: %s; correct "
                   "this, or choose another run directory",
                   s->dir, strerror_r(error, reason, sizeof reason));
  }
  close(fd);
  if (parse_run(text, run)) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s/" RUN ": is damaged, or was not "
                 "written by this program; remove the directory and start "
                 "again, or choose another one",
                 s->dir);
}

vg_status vg_store_write_run(const struct vg_store *s,
                             const struct vg_store_run *run,
                             struct vg_error *err)
{
  int fd = openat(s->fd, RUN ".part", O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC,
                  0666);
  char text[512], job[VG_DIGEST_TEXT];
  int error;

  if (fd < 0) return cannot_write(s, errno, err);
  vg_digest_text(run->job, job);
  snprintf(text, sizeof text, FIRST_LINE "job=%s\nwhat=%s\n", job, run->what);
  error = vg_store_put(fd, text, strlen(text));
  if (close(fd) && !error && errno != EINTR) error = errno;
  if (!error && renameat(s->fd, RUN ".part", s->fd, RUN)) error = errno;
  if (!error) return VG_OK;
  unlinkat(s->fd, RUN ".part", 0);
  return cannot_write(s, error, err);
}

void vg_store_remove_run(const struct vg_store *s)
{
  unlinkat(s->fd, RUN, 0);
  vg_store_remove_settings(s);
}

/* --- run.lock ------------------------------------------------------------ */

vg_status vg_store_lock(struct vg_store *s, struct vg_error *err)
{
  char holder[VG_LOCK_HOLDER];
  vg_status st = vg_lock_take(s->fd, LOCK, &s->lock, holder);

  if (st == VG_BLOCKED)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s: another run is using this directory (%s); wait for its "
                   "end or choose another directory (if that host no longer "
                   "exists, remove %s/" LOCK ")",
                   s->dir, holder, s->dir);
  return st < 0 ? cannot_write(s, errno, err) : VG_OK;
}

void vg_store_unlock(struct vg_store *s, int remove)
{
  if (s->lock < 0) return;
  if (remove) vg_lock_drop(s->fd, LOCK, s->lock);
  else close(s->lock);
  s->lock = -1;
}
