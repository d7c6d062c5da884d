/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/surface_table.h: the table `surface` of the deck. */
#ifndef VG_RUN_SETTINGS_SURFACE_TABLE_H
#define VG_RUN_SETTINGS_SURFACE_TABLE_H

#include "run/settings/settings.h"

extern const struct vg_setting_table vg_surface_table;

/** Whether a row applies to the curve between two patches. */
int vg_surface_row_has_adjacent(const struct vg_surface_row *r);

/** Check all rows. VG_ERR_INPUT for a row without any request, and for values
 * that contradict each other. */
vg_status vg_surface_rows_check(const struct vg_settings *s,
                                struct vg_error *err);

#endif
