/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/stream/csv.h: tables of numbers separated by commas, with a line of names,
 * such as SU2's restart_flow.csv: one line for each point of a mesh. */
#ifndef VG_IO_STREAM_CSV_H
#define VG_IO_STREAM_CSV_H

#include "io/stream/stream.h"

/** Write the names of the columns to out, separated by ", "; the list ends in
 * "..." if it is too long. */
void vg_csv_names(struct vg_input *in, char *out, size_t size);

/** Read the column `name`. Names may be in double quotes in the file; spaces
 * around names and numbers are ignored.
 *
 * @param n      out: number of lines after the first one, > 0
 * @param value  out: [n], which need not be finite; to be freed. Both are
 *               unchanged on failure
 * VG_ERR_FORMAT: no such column, two of them, or a line that has another number
 * of columns or no number there; VG_ERR_MEMORY. */
vg_status vg_csv_column(struct vg_input *in, const char *name, size_t *n,
                        double **value, struct vg_error *err);

/** Write text in double quotes; quotes in it are doubled. */
void vg_csv_put(struct vg_output *out, const char *text);

#endif
