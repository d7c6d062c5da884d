/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/common/text.h: names from files for display: valid UTF-8 is kept, invalid
 * bytes become '?', and columns of tables stay aligned; and formatted counts.
 * Uses jansson. */
#ifndef VG_RUN_COMMON_TEXT_H
#define VG_RUN_COMMON_TEXT_H

#include <stddef.h>

#include "run/common/json_build.h"

/** Number of bytes of the character at text, 1 to 4; 0 if it is not valid UTF-8
 * (as defined by Unicode and XML: no overlong forms, surrogates, U+FFFE,
 * U+FFFF). Reads no further than the terminator. */
size_t vg_text_character(const char *text);

/** Copies text, with '?' for each invalid byte and a blank for each control
 * character, truncated to fit, but never within a character. Returns
 * out[size], size > 0. */
char *vg_text_clean(const char *text, char *out, size_t size);

/** As vg_text_clean, truncated or padded with blanks to `columns` columns of a
 * terminal. */
char *vg_text_column(const char *text, size_t columns, char *out, size_t size);

/** Cleaned copy, freed by the caller; NULL: no memory. */
char *vg_text_copy(const char *text);

/** A JSON string; invalid bytes are replaced as by vg_text_clean. NULL: no
 * memory. */
json_t *vg_text_json(const char *text);

/** Removes an incomplete character that truncation has left at the end. */
void vg_text_trim_end(char *text);

/** 1: text has the suffix, in any case, and something in front of it. */
int vg_text_ends(const char *text, const char *suffix);

/** Records that a part of the output is lost for lack of memory: the process
 * ends with a failure (vg_cli_written). Threads: safe. */
void vg_print_lose(void);
int vg_print_is_lost(void);

/** Called before the next job of a process. */
void vg_print_forget(void);

/** Formats a count as "12,345,678" in text[32]; returns text. */
char *vg_text_count(unsigned long long n, char *text);

#endif
