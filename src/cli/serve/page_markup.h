/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: escaping of text in pages. */
#ifndef VG_CLI_SERVE_MARKUP_H
#define VG_CLI_SERVE_MARKUP_H

#include <stddef.h>
#include <stdio.h>

/** Write text with markup escaped, for elements and for attribute values in
 * double quotes. Bytes that are not UTF-8 become '?', and control characters
 * other than newlines and tabs become blanks. */
void vg_markup(FILE *to, const char *text);
void vg_markup_bytes(FILE *to, const char *text, size_t n);

/** Write a relative path as part of a URL: all bytes except letters, digits and
 * "-._~/" as %XX. */
void vg_markup_path(FILE *to, const char *path);

/** Write an attribute, " name=\"value\"". */
void vg_markup_attribute(FILE *to, const char *name, const char *value);

/** Write a file size, as in "12 kB" or "3.4 GB". */
void vg_markup_size(FILE *to, long long bytes);

#endif
