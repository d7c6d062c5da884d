/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/patch_names.h: lists of patches given by number, range, name or
 * pattern, and their lookup on a surface. Uses core/mesh and run/settings. */
#ifndef VG_RUN_SETTINGS_PATCH_NAMES_H
#define VG_RUN_SETTINGS_PATCH_NAMES_H

#include <stdint.h>

#include "core/mesh/mesh.h"
#include "run/settings/settings.h"

/** One item of a list of patches. */
struct vg_patch_item {
  int64_t from, to;       /* range of numbers, inclusive, if name is empty */
  char name[VG_NAME_MAX]; /* a name, or a pattern with * and ? */
};

/** Read the next item of a list such as 3-12,wing*,"upper surface" and advance
 * *text past it. Commas and blanks separate items; a name that contains one of
 * them, or begins like a number, must be in single or double quotes. Numbers
 * may be negative. Returns 0 at the end of the list, and at an invalid item,
 * with *text pointing to it. */
int vg_patch_list_next(const char **text, struct vg_patch_item *item);

/** Check the syntax of a list; for the member `check` of struct vg_param. */
vg_status vg_patch_list_check(const char *name, const char *list,
                              struct vg_error *err);

/** Regular expression of the lists that vg_patch_list_check accepts, except
 * that it does not compare the ends of ranges. To be freed; NULL: no memory. */
char *vg_patch_list_pattern(void);

/** Whether a name matches a pattern: * stands for any characters, ? for one,
 * and case matters. */
int vg_patch_name_matches(const char *pattern, const char *name);

/** Set on[i] to 1 for each of the first n patches of m that is in the list.
 *
 * @param what  name of the setting, for messages
 * VG_ERR_INPUT for a number, range or name that matches no patch: the message
 * suggests the nearest name and lists the patches. */
vg_status vg_patch_list_mark(const char *what, const char *list,
                             const struct vg_mesh *m, size_t n, uint8_t *on,
                             struct vg_error *err);

/** As vg_patch_list_mark, for the patch of a table row: a number or, if `name`
 * is not empty, a name or pattern. */
vg_status vg_patch_ref_mark(const char *what, int32_t id, const char *name,
                            const struct vg_mesh *m, size_t n, uint8_t *on,
                            struct vg_error *err);

/** Replace the rows of the tables `patches` and `layers` that have names by
 * rows with numbers, one for each patch that matches the name. Rows with
 * numbers are kept, so a second call has no effect. Names in the table `layers`
 * refer to the names that the table `patches` assigns. With the setting
 * `baffles`, a name there that matches no patch stays until m has the backs of
 * inner surfaces.
 * VG_ERR_INPUT for a name that matches no patch, and for a patch with two rows;
 * the message names both. */
vg_status vg_patch_rows_resolve(struct vg_settings *s, const struct vg_mesh *m,
                                struct vg_error *err);

/** Write "3 wing (bc 5), 4 tail (no condition), ..." for the first n patches
 * of m. */
void vg_patch_list_text(const struct vg_mesh *m, size_t n, char *text,
                        size_t size);

#endif
