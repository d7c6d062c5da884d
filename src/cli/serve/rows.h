/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: tables of a deck with many lines, as text: a line of
 * column names above lines of values. */
#ifndef VG_CLI_SERVE_ROWS_H
#define VG_CLI_SERVE_ROWS_H

#include <stdio.h>

#include "run/settings/settings.h"

/** Add the rows in `text` to a table of *s. Values are as in a deck: separated
 * by blanks, '#' begins a comment, "two words" are one value, "-" is the
 * default. Blank lines are skipped. The message of VG_ERR_INPUT names table and
 * line, counted from 1; the rows before it have been added. */
vg_status vg_rows_read(const char *text, enum vg_table_kind kind,
                       struct vg_settings *s, struct vg_error *err);

/** Print the rows of a table in columns, with markup escaped; columns that
 * contain only defaults are omitted. Nothing is printed for an empty table. */
void vg_rows_print(FILE *to, const struct vg_settings *s,
                   enum vg_table_kind kind);

#endif
