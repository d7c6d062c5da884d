/* Private to cli/serve: text into pages. */
#ifndef VG_CLI_SERVE_MARKUP_H
#define VG_CLI_SERVE_MARKUP_H

#include <stddef.h>
#include <stdio.h>

/** Text with markup escaped, for elements and for values in double quotes; what
 * is no UTF-8 becomes '?', and control characters but line ends and tabs
 * become blanks. */
void vg_markup(FILE *to, const char *text);
void vg_markup_bytes(FILE *to, const char *text, size_t n);

/** A relative path as part of an address: all but letters, digits and
 * "-._~/" as %XX. */
void vg_markup_path(FILE *to, const char *path);

/** " name=\"value\"". */
void vg_markup_attribute(FILE *to, const char *name, const char *value);

/** "12 kB", "3.4 GB". */
void vg_markup_size(FILE *to, long long bytes);

#endif
