/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/http/inside.h: confinement of paths to a folder. */
#ifndef VG_CLI_HTTP_INSIDE_H
#define VG_CLI_HTTP_INSIDE_H

#include "base/status.h"

/** The real path of the file or folder `name` below a folder.
 *
 * @param root  real path of the folder
 * @param name  relative path with '/'; "" is the folder itself
 * @param out   out: to be freed by the caller; unchanged on failure
 * VG_ERR_INPUT: `name` is absolute, contains ".", ".." or control characters,
 * or leads out of the folder through a symbolic link. VG_ERR_IO: it does not
 * exist. */
vg_status vg_inside(const char *root, const char *name, char **out,
                    struct vg_error *err);

/** Returns 1 if the real path is the folder `root` or below it. */
int vg_inside_holds(const char *root, const char *real);

/** Check the name of an uploaded file. VG_ERR_INPUT: it contains '/', '\' or
 * control characters, is not UTF-8, begins with '.' or '-', or has more than
 * 200 bytes. */
vg_status vg_inside_name(const char *name, struct vg_error *err);

#endif
