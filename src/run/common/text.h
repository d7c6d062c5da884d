/* run/common/text.h: names from files as they are shown: UTF-8 stays, what is
 * no UTF-8 becomes '?', columns of tables stay straight; and counts. Uses
 * jansson. */
#ifndef VG_RUN_COMMON_TEXT_H
#define VG_RUN_COMMON_TEXT_H

#include <jansson.h>
#include <stddef.h>

/** Bytes of the character at text, 1 to 4; 0 where no UTF-8 is (as Unicode and
 * XML have it: no overlong forms, surrogates, U+FFFE, U+FFFF). Reads no further
 * than the terminator. */
size_t vg_text_character(const char *text);

/** text with '?' for each byte that is no UTF-8, and a blank for control
 * characters, cut where it does not fit, never within a character. Returns
 * out[size], size > 0. */
char *vg_text_clean(const char *text, char *out, size_t size);

/** The same, cut or filled up with blanks to `columns` columns of a terminal.
 * */
char *vg_text_column(const char *text, size_t columns, char *out, size_t size);

/** A copy that the caller frees; NULL: no memory. */
char *vg_text_copy(const char *text);

/** A string for JSON; what is no UTF-8 as vg_text_clean has it. */
json_t *vg_text_json(const char *text);

/** Take away the part of a character that a cut has left at the end. */
void vg_text_trim_end(char *text);

/** Count as "12,345,678" into text[32]; returns text. */
char *vg_text_count(unsigned long long n, char *text);

#endif
