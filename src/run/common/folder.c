/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/common/folder.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Sets errno if it is not a folder. */
static int is_folder(const char *path)
{
  struct stat s;

  if (stat(path, &s)) return 0;
  errno = ENOTDIR;
  return S_ISDIR(s.st_mode);
}

vg_status vg_make_folder(const char *path, struct vg_error *err)
{
  char *part = strdup(path);
  vg_status st = part ? VG_OK : vg_fail_memory(err, "a path");

  for (char *end = part; st >= 0 && *end;) {
    char kept;

    while (*end == '/') end++;
    while (*end && *end != '/') end++;
    kept = *end;
    *end = 0;
    if (mkdir(part, 0777) && (errno != EEXIST || !is_folder(part)))
      st = vg_fail(err, VG_ERR_IO, "%s: cannot create this folder: %s", part,
                   strerror(errno));
    *end = kept;
  }
  free(part);
  return st;
}
