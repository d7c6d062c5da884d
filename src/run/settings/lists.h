/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/lists.h: values of the settings `write` (a list of formats) and
 * `mesher`. Uses io. */
#ifndef VG_RUN_SETTINGS_LISTS_H
#define VG_RUN_SETTINGS_LISTS_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/* Largest number of formats in a write list, more than there are (checked by
 * tests/cli/test_deck.c), and bytes of a name. */
enum { VG_WRITE_ITEMS = 48, VG_WRITE_NAME = 24 };

/** Append the formats of a list such as "b8.ugrid,vtu" to the *n formats in
 * item, without duplicates. VG_ERR_INPUT for an unknown format. */
vg_status vg_write_list(const char *list, size_t *n,
                        char (*item)[VG_WRITE_NAME], struct vg_error *err);

/** Word i that a list of formats may contain; NULL past the last one. Static
 * string. */
const char *vg_write_word(size_t i);

/** Check of the setting `mesher`: "builtin", "tetgen", "hxt", or a path that
 * contains a '/'. */
vg_status vg_mesher_name_check(const char *name, const char *mesher,
                               struct vg_error *err);

/** Check of the setting `write`: a list as for vg_write_list, or "auto". */
vg_status vg_write_list_check(const char *name, const char *list,
                              struct vg_error *err);

/** Regular expressions of the texts that these two checks accept, except that
 * that of `write` does not find two words for the same OpenFOAM case. To be
 * freed; NULL: no memory. */
char *vg_write_list_pattern(void);
char *vg_mesher_name_pattern(void);

#endif
