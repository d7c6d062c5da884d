/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/periodic_table.h: the table `periodic` of the deck. */
#ifndef VG_RUN_SETTINGS_PERIODIC_TABLE_H
#define VG_RUN_SETTINGS_PERIODIC_TABLE_H

#include "run/settings/settings.h"

extern const struct vg_setting_table vg_periodic_table;

/** Store the default row, a pair whose transform is found, in *row. */
void vg_periodic_row_default(struct vg_periodic_row *row);

/** Check all rows. VG_ERR_INPUT for transforms that are incomplete, or that
 * contradict the column `kind`. */
vg_status vg_periodic_rows_check(const struct vg_settings *s,
                                 struct vg_error *err);

#endif
