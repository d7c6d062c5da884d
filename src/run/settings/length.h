/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/length.h: lengths with a unit, as in 30mm.
 *
 * A setting is converted when the unit of the mesh is known, which may be after
 * the surface was read. Until then the double of the setting is a quiet NaN
 * that holds the decimal digits, the exponent and the unit. It passes through
 * copies, tables and writers like any other value. Units are those of enum
 * vg_cad_unit (io/cad/cad.h). */
#ifndef VG_RUN_SETTINGS_LENGTH_H
#define VG_RUN_SETTINGS_LENGTH_H

#include <stddef.h>

#define VG_LENGTH_TEXT 24 /* bytes of such a length with its end */

/** Regular expression of lengths with a unit that are at least 0, for the JSON
 * Schema; with `any_sign`, of all. */
#define VG_LENGTH_PATTERN(any_sign)                                            \
  "^[" any_sign "+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eEdD][-+]?[0-9]+)?"          \
  "(mm|cm|m|km|inch|in|foot|ft)$"

/** Returns 1 if text[len] is a number followed by a unit, *out is then the
 * length. Returns -1 if it has more than 10 digits, or an exponent beyond 99.
 */
int vg_length_parse(const char *text, size_t len, double *out);

/** Is v a length with a unit? */
int vg_length_has_unit(double v);

/** The number of such a length in its own unit. */
double vg_length_number(double v);

/** The length in another unit: the double next to its decimal value, so that
 * 30mm is 0.03 in metres. */
double vg_length_in(double v, int unit);

void vg_length_format(double v, char text[VG_LENGTH_TEXT]);

/** Factor from one unit to another as a numerator and a denominator, which
 * doubles hold exactly. */
void vg_unit_factor(int from, int to, double *up, double *down);

/** "mm", ... */
const char *vg_unit_name(int unit);

#endif
