/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "base/lock/lock.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define FORM "host %s, process %ld, started %s\n"
#define FORM_READ "host %255[^,], process %ld,"

static void own_host(char host[256])
{
  memset(host, 0, 256);
  gethostname(host, 255);
}

static void read_holder(int fd, char holder[VG_LOCK_HOLDER])
{
  ssize_t n = pread(fd, holder, VG_LOCK_HOLDER - 1, 0);

  holder[n > 0 ? n : 0] = 0;
  holder[strcspn(holder, "\n")] = 0;
}

/* For people, and for file systems without locks: the lock holds without this
 * text. Returns 0, or -1 with errno. */
static int sign(int fd)
{
  time_t now = time(NULL);
  char host[256], started[40] = "", text[VG_LOCK_HOLDER];
  struct tm local;
  int n;

  own_host(host);
  if (localtime_r(&now, &local))
    strftime(started, sizeof started, "%Y-%m-%d %H:%M:%S", &local);
  n = snprintf(text, sizeof text, FORM, host, (long)getpid(), started);
  if (ftruncate(fd, 0)) return -1;
  return pwrite(fd, text, (size_t)n, 0) == n ? 0 : -1;
}

/* Without locks of the file system: may the named holder be alive? */
static int may_live(const char *holder)
{
  char host[256], own[256];
  long process;

  if (sscanf(holder, FORM_READ, host, &process) != 2) return 0;
  own_host(own);
  return strcmp(host, own) != 0 || !kill((pid_t)process, 0) || errno != ESRCH;
}

/* The file may have been removed by its last holder between open and lock. */
static int is_current(int at, const char *path, int fd)
{
  struct stat a, b;

  return !fstat(fd, &a) && !fstatat(at, path, &b, 0) && a.st_dev == b.st_dev &&
         a.st_ino == b.st_ino;
}

vg_status vg_lock_take(int at, const char *path, int *fd,
                       char holder[VG_LOCK_HOLDER])
{
  for (;;) {
    int f = openat(at, path, O_RDWR | O_CREAT | O_CLOEXEC, 0666), is_held, why;

    if (f < 0) return VG_ERR_IO;
    do is_held = flock(f, LOCK_EX | LOCK_NB) ? errno : 0;
    while (is_held == EINTR);
    read_holder(f, holder);
    if (is_held && is_held != EWOULDBLOCK) is_held = may_live(holder);
    if (is_held) {
      if (!*holder) strcpy(holder, "an unknown process");
      close(f);
      return VG_BLOCKED;
    }
    if (is_current(at, path, f)) {
      if (!sign(f)) {
        *fd = f;
        return VG_OK;
      }
      why = errno; /* A full disk: the file would name nobody. */
      unlinkat(at, path, 0);
      close(f);
      errno = why;
      return VG_ERR_IO;
    }
    close(f);
  }
}

void vg_lock_drop(int at, const char *path, int fd)
{
  unlinkat(at, path, 0);
  close(fd);
}
