/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/wake_table.h: the table `wakes` of the deck. */
#ifndef VG_RUN_SETTINGS_WAKE_TABLE_H
#define VG_RUN_SETTINGS_WAKE_TABLE_H

#include "run/settings/settings.h"

extern const struct vg_setting_table vg_wake_table;

/** Store the default row, all trailing edges, in *row. */
void vg_wake_row_default(struct vg_wake_row *row);

/** Check all rows. VG_ERR_INPUT for values that contradict each other. */
vg_status vg_wake_rows_check(const struct vg_settings *s, struct vg_error *err);

/** The word of the kind of a row. Static string. */
const char *vg_wake_kind_word(const struct vg_wake_row *row);

/** Name of the stream's axis: "x", "-x", ... Static string. */
const char *vg_wake_stream_word(const struct vg_wake_row *row);

/** Most angles in a list, and the largest of them, in degrees. */
#define VG_WAKE_ANGLES 16
#define VG_WAKE_ANGLE_MAX 60

/** Read a list of angles such as "0, 2.5, -4". Returns their number, 0 if the
 * text is no such list. */
size_t vg_wake_angles(const char *text, double angle[VG_WAKE_ANGLES]);

#endif
