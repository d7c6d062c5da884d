/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/commit/tree.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <fts.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* NULL: errno is the reason. */
static FTS *walk(const char *path)
{
  char *const paths[] = { (char *)path, NULL };

  return fts_open(paths, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
}

int vg_tree_remove(const char *path)
{
  FTS *tree = walk(path);
  FTSENT *e;
  int why = tree ? 0 : errno;

  while (tree && (e = fts_read(tree))) {
    int failed = 0;

    if (e->fts_info == FTS_D) continue;
    if (e->fts_info == FTS_DP) failed = rmdir(e->fts_path);
    else if (e->fts_info == FTS_DNR) why = e->fts_errno;
    else failed = unlink(e->fts_path);
    if (failed && errno != ENOENT) why = errno;
  }
  if (tree) fts_close(tree);
  errno = why;
  return why ? -1 : 0;
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
