/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/http/upload.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cli/http/inside.h"

static vg_status already_exists(const char *name, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "'%.80s' already exists and is not "
                 "overwritten; give the file another name",
                 name);
}

static void forget(struct vg_upload *u)
{
  free(u->name);
  free(u->path);
  free(u->temporary);
  u->name = u->path = u->temporary = NULL;
}

/* Create the file with the temporary name that it has until it is complete. */
static vg_status make(struct vg_upload *u, const char *folder,
                      struct vg_error *err)
{
  struct stat s;

  if (asprintf(&u->path, "%s/%s", folder, u->name) < 0) u->path = NULL;
  if (asprintf(&u->temporary, "%s/.%.180s.XXXXXX", folder, u->name) < 0)
    u->temporary = NULL;
  if (!u->path || !u->temporary) return vg_fail_memory(err, "a path");
  if (!lstat(u->path, &s)) return already_exists(u->name, err);
  u->fd = mkostemp(u->temporary, O_CLOEXEC);
  if (u->fd >= 0) return VG_OK;
  return vg_fail(err, VG_ERR_IO, "cannot write '%.80s': %s", u->name,
                 strerror(errno));
}

vg_status vg_upload_begin(struct vg_upload *u, const char *root,
                          const char *under, const char *name,
                          struct vg_error *err)
{
  char *folder = NULL;
  vg_status st;

  VG_TRY(vg_upload_commit(u, err));
  forget(u);
  VG_TRY(vg_inside_name(name, err));
  VG_TRY(vg_inside(root, under, &folder, err));
  u->name = strdup(name);
  st = u->name ? make(u, folder, err) : vg_fail_memory(err, "a name");
done:
  free(folder);
  return st;
}

vg_status vg_upload_put(struct vg_upload *u, const char *data, size_t size,
                        uint64_t most, struct vg_error *err)
{
  if (size > most || u->size > most - size)
    return vg_fail(err, VG_ERR_INPUT,
                   "the files are larger than the %llu bytes "
                   "that --max-upload allows",
                   (unsigned long long)most);
  while (size) {
    ssize_t n = write(u->fd, data, size);

    if (n < 0 && errno == EINTR) continue;
    if (n <= 0)
      return vg_fail(err, VG_ERR_IO, "the file could not be written: %s",
                     n ? strerror(errno) : "disk full");
    data += n;
    size -= (size_t)n;
    u->size += (uint64_t)n;
  }
  return VG_OK;
}

/* Files of mkstemp are accessible to the owner only; give this one the usual
 * mode. */
static int give_mode(int fd)
{
  mode_t mask = umask(0);

  umask(mask);
  return fchmod(fd, 0666 & ~mask);
}

/* Rename the file to its final name, unless that exists by now. */
static vg_status give_name(struct vg_upload *u, struct vg_error *err)
{
  if (!renameat2(AT_FDCWD, u->temporary, AT_FDCWD, u->path, RENAME_NOREPLACE))
    return VG_OK;
  if (errno != EEXIST && !link(u->temporary, u->path)) {
    unlink(u->temporary); /* no RENAME_NOREPLACE on this file system; link does
                             not overwrite either */
    return VG_OK;
  }
  if (errno == EEXIST) return already_exists(u->name, err);
  return vg_fail(err, VG_ERR_IO, "'%.80s': %s", u->name, strerror(errno));
}

vg_status vg_upload_commit(struct vg_upload *u, struct vg_error *err)
{
  int failed;
  vg_status st;

  if (u->fd < 0) return VG_OK;
  failed = give_mode(u->fd) | fsync(u->fd);
  failed |= close(u->fd);
  u->fd = -1;
  st = failed ? vg_fail(err, VG_ERR_IO, "'%.80s' could not be written: %s",
                        u->name, strerror(errno))
              : give_name(u, err);
  if (st < 0) unlink(u->temporary);
  else u->n_whole++;
  return st;
}

void vg_upload_release(struct vg_upload *u)
{
  if (u->fd >= 0) {
    close(u->fd);
    unlink(u->temporary);
  }
  forget(u);
  memset(u, 0, sizeof *u);
  u->fd = -1;
}
