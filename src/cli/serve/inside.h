/* Private to cli/serve: paths that stay in a folder. */
#ifndef VG_CLI_SERVE_INSIDE_H
#define VG_CLI_SERVE_INSIDE_H

#include "base/status.h"

/** The real path of what `name` is below a folder.
 *
 * @param root  real path of the folder
 * @param name  relative, with '/' between; "" is the folder itself
 * @param out   out: the caller frees it; untouched on failure
 * VG_ERR_INPUT: `name` is absolute, has "." or ".." or control characters, or
 * leads out of the folder by a symbolic link. VG_ERR_IO: nothing is there. */
vg_status vg_inside(const char *root, const char *name, char **out,
                    struct vg_error *err);

/** 1 when the real path is the folder `root` or below it. */
int vg_inside_holds(const char *root, const char *real);

/** VG_ERR_INPUT: no name for a file that is brought: a '/' or '\', control
 * characters, no UTF-8, a leading '.' or '-', more than 200 bytes. */
vg_status vg_inside_name(const char *name, struct vg_error *err);

#endif
