/* run/settings/patch_names.h: patches named by number, range, name or pattern,
 * and what these mean on a surface. Uses core/mesh and run/settings. */
#ifndef VG_RUN_SETTINGS_PATCH_NAMES_H
#define VG_RUN_SETTINGS_PATCH_NAMES_H

#include <stdint.h>

#include "core/mesh/mesh.h"
#include "run/settings/settings.h"

/** One item of a list of patches. */
struct vg_patch_item {
  int64_t from, to;       /* numbers, inclusive, where name is empty */
  char name[VG_NAME_MAX]; /* a name, or a pattern with * and ? */
};

/** Read the next item of a list such as 3-12,wing*,"upper surface" and set
 * *text behind it. Commas and blanks separate items; a name that has one of
 * them, or begins like a number, stands in quotes of either kind. Numbers may
 * be negative. Returns 0 at the end of the list, and before an item that is
 * none of these, with *text at it. */
int vg_patch_list_next(const char **text, struct vg_patch_item *item);

/** Check a list. This is the check of a setting (struct vg_param);
 * VG_ERR_INPUT names the item that is wrong. */
vg_status vg_patch_list_check(const char *name, const char *list,
                              struct vg_error *err);

/** Whether a name matches a pattern: * stands for any characters, ? for one,
 * and case matters. */
int vg_patch_name_matches(const char *pattern, const char *name);

/** Set on[i] to 1 for each of the first n patches of m that a list names.
 *
 * @param what  the setting, for messages
 * VG_ERR_INPUT for a number, range or name that no patch has: the message
 * gives the nearest name and lists the patches. */
vg_status vg_patch_list_mark(const char *what, const char *list,
                             const struct vg_mesh *m, size_t n, uint8_t *on,
                             struct vg_error *err);

/** As vg_patch_list_mark, for a row of a table: a number, or a name or
 * pattern. */
vg_status vg_patch_ref_mark(const char *what, int32_t id, const char *name,
                            const struct vg_mesh *m, size_t n, uint8_t *on,
                            struct vg_error *err);

/** Replace the rows of the tables patches and layers that have names by rows
 * with numbers, one for each patch that the name stands for. Rows with
 * numbers stay, so that a second call does nothing. In the table layers a
 * patch has the name that the table patches gives it.
 * VG_ERR_INPUT for a name that no patch has, and for a patch with two rows:
 * the message names both. */
vg_status vg_patch_rows_resolve(struct vg_settings *s, const struct vg_mesh *m,
                                struct vg_error *err);

/** Write "3 wing (bc 5), 4 tail (no condition), ..." for the first n patches
 * of m. */
void vg_patch_list_text(const struct vg_mesh *m, size_t n, char *text,
                        size_t size);

#endif
