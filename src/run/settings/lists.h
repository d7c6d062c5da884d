/* run/settings/lists.h: settings that are lists: numbers of patches, files to
 * write. Uses io. */
#ifndef VG_RUN_SETTINGS_LISTS_H
#define VG_RUN_SETTINGS_LISTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** Whether a list has numbers as in "3-12,15": ranges are inclusive, numbers
 * may be negative. A check of settings (struct vg_param); VG_ERR_INPUT names
 * the list. */
vg_status vg_patch_list_check(const char *name, const char *list,
                              struct vg_error *err);

/** The next range of a list, *text behind it. 0: the list is at its end, or
 * what follows is none. */
int vg_patch_list_next(const char **text, int64_t *from, int64_t *to);

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
