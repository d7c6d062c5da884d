/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Loaded with LD_PRELOAD: the process ends by SIGKILL before its call number
 * VG_KILL_AT, from 1, of those that change names in a folder or bring a file to
 * the disk. Names outside of hidden folders and folders of meshes do not
 * count. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static atomic_long n_call;

static void count(void)
{
  const char *at = getenv("VG_KILL_AT");

  if (at && atomic_fetch_add(&n_call, 1) + 1 == atol(at)) raise(SIGKILL);
}

static void count_path(const char *path)
{
  if (strstr(path, ".vanguard-")) count();
}

/* A function of the C library by its name. */
#define REAL(function) __typeof__(function) *real = dlsym(RTLD_NEXT, #function)

int rename(const char *a, const char *b)
{
  REAL(rename);

  count_path(a);
  return real(a, b);
}

int renameat2(int da, const char *a, int db, const char *b, unsigned flags)
{
  REAL(renameat2);

  count_path(a);
  return real(da, a, db, b, flags);
}

int link(const char *a, const char *b)
{
  REAL(link);

  count_path(b);
  return real(a, b);
}

int unlink(const char *a)
{
  REAL(unlink);

  count_path(a);
  return real(a);
}

int mkdir(const char *a, mode_t mode)
{
  REAL(mkdir);

  count_path(a);
  return real(a, mode);
}

int rmdir(const char *a)
{
  REAL(rmdir);

  count_path(a);
  return real(a);
}

int fsync(int fd)
{
  REAL(fsync);

  count();
  return real(fd);
}
