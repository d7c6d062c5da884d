/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "run/common/folder.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "run/commit/tree.h"

/* Sets errno if it is not a folder. */
static int is_folder(const char *path)
{
  struct stat s;

  if (stat(path, &s)) return 0;
  errno = ENOTDIR;
  return S_ISDIR(s.st_mode);
}

/* Makes the folder path[0..end), and brings its name to the disk. */
static vg_status make_one(char *path, char *end, struct vg_error *err)
{
  const char kept = *end;
  char *slash;
  vg_status st = VG_OK;

  *end = 0;
  if (mkdir(path, 0777)) {
    if (errno != EEXIST || !is_folder(path))
      st = vg_fail(err, VG_ERR_IO, "%s: cannot create this folder: %s", path,
                   strerror(errno));
  } else {
    slash = strrchr(path, '/');
    if (slash && slash != path) {
      *slash = 0;
      st = vg_folder_sync(path, err);
      *slash = '/';
    } else st = vg_folder_sync(slash ? "/" : ".", err);
  }
  *end = kept;
  return st;
}

vg_status vg_make_folder(const char *path, struct vg_error *err)
{
  char *part = strdup(path);
  vg_status st = part ? VG_OK : vg_fail_memory(err, "a path");

  for (char *end = part; st >= 0 && *end;) {
    while (*end == '/') end++;
    while (*end && *end != '/') end++;
    st = make_one(part, end, err);
  }
  free(part);
  return st;
}

vg_status vg_folder_path(const char *folder, const char *name, char **out,
                         struct vg_error *err)
{
  if (asprintf(out, "%s/%s", folder, name) >= 0) return VG_OK;
  *out = NULL;
  return vg_fail_memory(err, "a path");
}
