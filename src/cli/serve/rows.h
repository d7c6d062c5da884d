/* Private to cli/serve: the tables of a deck that have many lines, as text: a
 * line of column names above lines of values. */
#ifndef VG_CLI_SERVE_ROWS_H
#define VG_CLI_SERVE_ROWS_H

#include <stdio.h>

#include "run/settings/settings.h"

/** Add the rows in text to a table of *s. Values as in a deck: parted by
 * blanks, '#' begins a comment, "two words" are one, "-" is the default. Blank
 * lines are skipped. VG_ERR_INPUT names table and line, from 1; rows before it
 * have been added. */
vg_status vg_rows_read(const char *text, enum vg_table_kind kind,
                       struct vg_settings *s, struct vg_error *err);

/** The rows of a table, in columns, with markup escaped; columns without
 * anything but defaults are left out. */
void vg_rows_print(FILE *to, const struct vg_settings *s,
                   enum vg_table_kind kind);

#endif
