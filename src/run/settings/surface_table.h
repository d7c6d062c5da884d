/* run/settings/surface_table.h: the table `surface` of the deck. */
#ifndef VG_RUN_SETTINGS_SURFACE_TABLE_H
#define VG_RUN_SETTINGS_SURFACE_TABLE_H

#include "run/settings/settings.h"

extern const struct vg_setting_table vg_surface_table;

/** Whether a row is about the curve between two patches. */
int vg_surface_row_has_beside(const struct vg_surface_row *r);

/** VG_ERR_INPUT for rows that ask for nothing, or for what does not go
 * together. */
vg_status vg_surface_rows_check(const struct vg_settings *s,
                                struct vg_error *err);

#endif
