/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/stages/hidden.h"

#include <assert.h>
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define PREFIX ".vanguard-"
#define N_RANDOM 6
#define LOCK "lock"
/* A file system may keep locks on each host separately. A run writes to its
 * folder every few seconds, so a folder without any change for a day is not in
 * use. */
#define IDLE_S (24 * 3600)

static char *lock_path(const char *folder)
{
  char *path;

  return asprintf(&path, "%s/" LOCK, folder) < 0 ? NULL : path;
}

/* --- the folder of this run ---------------------------------------------- */

/* Create and lock the file. A file system without locks is not an error: later
 * runs leave such a folder in place. Returns the descriptor, or -1. */
static int make_lock(const char *folder)
{
  char *path = lock_path(folder), host[256] = "";
  int fd = path ? open(path, O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666) : -1;

  free(path);
  if (fd < 0) return -1;
  gethostname(host, sizeof host - 1);
  if (dprintf(fd, "%s\n%ld\n", host, (long)getpid()) < 0 ||
      (flock(fd, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK)) {
    close(fd);
    return -1;
  }
  return fd;
}

/* The folder gets its final name once it is locked, so that no other run
 * mistakes it for one that was left behind. */
vg_status vg_hidden_make(const char *dir, char **path, int *lock,
                         struct vg_error *err)
{
  char *fresh, *to = NULL;
  int why;

  *lock = -1;
  if (asprintf(&fresh, "%s/" PREFIX "new-XXXXXX", dir) < 0)
    return vg_fail_memory(err, "the output paths");
  if (!mkdtemp(fresh)) {
    why = errno;
    free(fresh);
    errno = why;
    return VG_ERR_IO;
  }
  *lock = make_lock(fresh);
  if (*lock >= 0 && asprintf(&to, "%s/" PREFIX "%s", dir,
                             fresh + strlen(fresh) - N_RANDOM) < 0)
    to = NULL;
  if (to && !rename(fresh, to)) {
    free(fresh);
    *path = to;
    return VG_OK;
  }
  why = errno;
  vg_hidden_remove(fresh, *lock);
  free(fresh);
  free(to);
  errno = why;
  return VG_ERR_IO;
}

static int remove_one(const char *path, const struct stat *info, int type,
                      struct FTW *at)
{
  (void)info, (void)type, (void)at;
  return remove(path);
}

static int remove_all(const char *path)
{
  return nftw(path, remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

void vg_hidden_remove(const char *path, int lock)
{
  remove_all(path);
  if (lock >= 0) close(lock);
}

/* --- folders of runs that were killed ------------------------------------ */

/* The walk over a folder; nftw has no parameter for it. */
static _Thread_local struct {
  uint64_t bytes;
  time_t newest;
} found;

static int measure(const char *path, const struct stat *info, int type,
                   struct FTW *at)
{
  (void)path, (void)type, (void)at;
  if (S_ISREG(info->st_mode)) found.bytes += (uint64_t)info->st_size;
  if (info->st_mtime > found.newest) found.newest = info->st_mtime;
  return 0;
}

static int is_own_host(int lock)
{
  char host[256] = "", there[256] = "";
  ssize_t n = pread(lock, there, sizeof there - 1, 0);

  gethostname(host, sizeof host - 1);
  if (n < 0) return 0;
  there[strcspn(there, "\n")] = 0;
  return !strcmp(host, there);
}

static void keep(struct vg_notes *notes, const char *path, const char *why)
{
  vg_note(notes,
          "%s (%.1f MB) may have been left behind by a run that was killed, "
          "but %s; remove it if no run writes to this folder",
          path, (double)found.bytes / 1e6, why);
}

/* The folder `path`, whose lock file is open as `lock`. */
static void sweep_locked(const char *path, int lock, struct vg_notes *notes)
{
  if (flock(lock, LOCK_EX | LOCK_NB)) {
    if (errno != EWOULDBLOCK)
      keep(notes, path, "the file system does not support locks");
    return;
  }
  if (!is_own_host(lock) && time(NULL) - found.newest < IDLE_S)
    keep(notes, path, "that run was on another host");
  else if (remove_all(path)) keep(notes, path, "it could not be removed");
  else
    vg_note(notes,
            "removed %s (%.1f MB), the incomplete files of a run that was "
            "killed",
            path, (double)found.bytes / 1e6);
}

static void sweep_one(const char *path, struct vg_notes *notes)
{
  char *file = lock_path(path);
  int lock = file ? open(file, O_RDWR | O_CLOEXEC) : -1;

  found.bytes = 0;
  found.newest = 0;
  nftw(path, measure, 16, FTW_PHYS);
  if (lock >= 0) sweep_locked(path, lock, notes);
  else if (file && !access(path, F_OK))
    keep(notes, path, "it has no lock that this user can open");
  if (lock >= 0) close(lock);
  free(file);
}

static int is_hidden_name(const char *name)
{
  size_t n = strlen(PREFIX);

  if (strncmp(name, PREFIX, n) != 0) return 0;
  for (size_t i = 0; i < N_RANDOM; i++)
    if (!isalnum((unsigned char)name[n + i])) return 0;
  return !name[n + N_RANDOM];
}

static int is_hidden(const struct dirent *entry)
{
  return is_hidden_name(entry->d_name);
}

void vg_hidden_sweep(const char *dir, struct vg_notes *notes)
{
  struct dirent **entry = NULL;
  int n = scandir(dir, &entry, is_hidden, alphasort);

  for (int i = 0; i < n; i++) {
    char *path;

    if (asprintf(&path, "%s/%s", dir, entry[i]->d_name) >= 0) {
      sweep_one(path, notes);
      free(path);
    }
    free(entry[i]);
  }
  free(entry);
}
