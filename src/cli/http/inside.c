/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "cli/http/inside.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/common/text.h"

#define SHOWN "%.80s"

static int is_clean(const char *text)
{
  for (size_t n; *text; text += n) {
    n = vg_text_character(text);
    if (!n || (unsigned char)*text < ' ' || *text == 127) return 0;
  }
  return 1;
}

/* No component of the relative path is empty, "." or "..". */
static int has_plain_parts(const char *name)
{
  if (!*name) return 1;
  for (;; name++) {
    size_t n = strcspn(name, "/");

    if (!n || (n == 1 && *name == '.') || (n == 2 && !strncmp(name, "..", 2)))
      return 0;
    name += n;
    if (!*name) return 1;
  }
}

int vg_inside_holds(const char *root, const char *real)
{
  size_t n = strlen(root);

  if (n == 1) return *real == '/';
  return !strncmp(root, real, n) && (real[n] == '/' || !real[n]);
}

vg_status vg_inside(const char *root, const char *name, char **out,
                    struct vg_error *err)
{
  char *path, *real;

  if (!is_clean(name) || !has_plain_parts(name))
    return vg_fail(err, VG_ERR_INPUT,
                   "'" SHOWN "' is not a path below the "
                   "folder of the projects",
                   is_clean(name) ? name : "?");
  if (asprintf(&path, "%s/%s", root, name) < 0)
    return vg_fail_memory(err, "a path");
  real = realpath(path, NULL);
  free(path);
  if (!real)
    return vg_fail(err, VG_ERR_IO, "'" SHOWN "': %s", name, strerror(errno));
  if (!vg_inside_holds(root, real)) {
    free(real);
    return vg_fail(err, VG_ERR_INPUT,
                   "'" SHOWN "' is outside the folder of "
                   "the projects",
                   name);
  }
  *out = real;
  return VG_OK;
}

vg_status vg_inside_name(const char *name, struct vg_error *err)
{
  if (!*name || *name == '.' || *name == '-' || strpbrk(name, "/\\") ||
      strlen(name) > 200 || !is_clean(name))
    return vg_fail(err, VG_ERR_INPUT,
                   "'" SHOWN "' is not a valid file name here; use a name "
                   "without '/' that does not begin with '.' or '-'",
                   is_clean(name) ? name : "?");
  return VG_OK;
}
