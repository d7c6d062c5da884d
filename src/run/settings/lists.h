/* run/settings/lists.h: settings that are lists of files to write, or names
 * of meshers. Uses io. */
#ifndef VG_RUN_SETTINGS_LISTS_H
#define VG_RUN_SETTINGS_LISTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* Kinds of file in a write list, and bytes of a name. */
enum { VG_WRITE_ITEMS = 16, VG_WRITE_NAME = 24 };

/** The kinds in a list such as "b8.ugrid,vtu", each once, behind *n others in
 * item. VG_ERR_INPUT where one is no format. */
vg_status vg_write_list(const char *list, size_t *n,
                        char (*item)[VG_WRITE_NAME], struct vg_error *err);

/** "builtin", "tetgen", "hxt", or a path with a '/' in it: a check of settings.
 */
vg_status vg_mesher_name_check(const char *name, const char *mesher,
                               struct vg_error *err);

/** The same, or "auto", as a check of settings. */
vg_status vg_write_list_check(const char *name, const char *list,
                              struct vg_error *err);

#endif
