/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/commit/tree.h"

#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <stdalign.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- removal, without memory -------------------------------------------- */

static int remove_at(int folder, const char *name);

/* One pass over the entries of a folder. Returns the number of entries that it
 * removed; *why: errno of a failure. */
static size_t remove_entries(int fd, int *why)
{
  alignas(struct dirent64) char buffer[2048];
  size_t n_removed = 0;
  ssize_t n;

  while ((n = getdents64(fd, buffer, sizeof buffer)) > 0)
    for (ssize_t at = 0; at < n;) {
      const struct dirent64 *e = (const void *)(buffer + at);

      at += e->d_reclen;
      if (!strcmp(e->d_name, ".") || !strcmp(e->d_name, "..")) continue;
      if (!remove_at(fd, e->d_name)) n_removed++;
      else *why = errno;
    }
  if (n < 0) *why = errno;
  return n_removed;
}

/* Returns 0, or errno. */
static int remove_folder_at(int folder, const char *name)
{
  int fd = openat(folder, name,
                  O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  int why = fd < 0 ? errno : 0;

  /* Some file systems skip entries if others are removed meanwhile. */
  while (fd >= 0 && remove_entries(fd, &why) && !why) lseek(fd, 0, SEEK_SET);
  if (fd >= 0) close(fd);
  if (why) return why;
  return unlinkat(folder, name, AT_REMOVEDIR) ? errno : 0;
}

static int remove_at(int folder, const char *name)
{
  int why = unlinkat(folder, name, 0) ? errno : 0;

  /* POSIX has EPERM for a folder, Linux EISDIR. */
  if (why == EISDIR || why == EPERM) {
    int answer = remove_folder_at(folder, name);

    if (answer != ENOTDIR) why = answer;
  }
  if (!why || why == ENOENT) return 0;
  errno = why;
  return -1;
}

int vg_tree_remove(const char *path)
{
  return remove_at(AT_FDCWD, path);
}

/* --- walks ---------------------------------------------------------------- */

/* NULL: errno is the reason. */
static FTS *walk(const char *path)
{
  char *const paths[] = { (char *)path, NULL };

  return fts_open(paths, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
}

uint64_t vg_tree_bytes(const char *path)
{
  FTS *tree = walk(path);
  FTSENT *e;
  uint64_t n = 0;

  while (tree && (e = fts_read(tree)))
    if (e->fts_info == FTS_F) n += (uint64_t)e->fts_statp->st_size;
  if (tree) fts_close(tree);
  return n;
}

static vg_status not_synced(const char *path, int why, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_IO, "%s: cannot be written to the disk: %s", path,
                 strerror(why));
}

/* Some file systems open or synchronise no folders. */
static int is_unable(int why)
{
  return why == EINVAL || why == ENOSYS || why == EOPNOTSUPP || why == EBADF;
}

static vg_status sync_one(const char *path, int is_folder, struct vg_error *err)
{
  int fd = open(path, O_RDONLY | O_CLOEXEC | (is_folder ? O_DIRECTORY : 0));
  int why = fd < 0 || fsync(fd) ? errno : 0;

  if (fd >= 0) close(fd);
  if (!why || (is_folder && is_unable(why))) return VG_OK;
  return not_synced(path, why, err);
}

vg_status vg_folder_sync(const char *path, struct vg_error *err)
{
  return sync_one(path, 1, err);
}

vg_status vg_tree_sync(const char *path, struct vg_error *err)
{
  FTS *tree = walk(path);
  FTSENT *e;
  vg_status st = VG_OK;

  if (!tree) return not_synced(path, errno, err);
  while (st >= 0 && (e = fts_read(tree)))
    if (e->fts_info == FTS_F || e->fts_info == FTS_DP)
      st = sync_one(e->fts_path, e->fts_info == FTS_DP, err);
    else if (e->fts_info == FTS_DNR || e->fts_info == FTS_NS)
      st = not_synced(e->fts_path, e->fts_errno, err);
  fts_close(tree);
  return st;
}
