/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/settings/names_parts.h: comparison of words with those of the field.
 * Private to run/settings. */
#ifndef VG_RUN_SETTINGS_NAMES_PARTS_H
#define VG_RUN_SETTINGS_NAMES_PARTS_H

#include "run/settings/names.h"

#define VG_CANONICAL_SIZE 80

/** Write the parts of a word in lower case and alphabetical order, separated by
 * blanks, with synonyms replaced and insignificant parts omitted:
 * "maxElementSize" and "max-cell-length" are "cell max size". Parts end at
 * other characters than letters and digits and before capitals. "": too long,
 * or nothing is significant. */
void vg_field_canonical(const char *text, char out[VG_CANONICAL_SIZE]);

#endif
