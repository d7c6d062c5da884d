/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/common/text.h"

#include <assert.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* Length of a character by its first byte c; 0 if c cannot be a first byte. */
static size_t announced(unsigned char c)
{
  if (c < 0x80) return 1;
  if (c < 0xc2 || c > 0xf4) return 0;
  return c < 0xe0 ? 2 : c < 0xf0 ? 3 : 4;
}

static uint32_t code_of(const char *text, size_t n)
{
  const unsigned char *c = (const unsigned char *)text;
  uint32_t code = n == 1 ? c[0] : c[0] & (0x7fu >> n);

  for (size_t i = 1; i < n; i++) code = code << 6 | (c[i] & 0x3fu);
  return code;
}

size_t vg_text_character(const char *text)
{
  size_t n = announced((unsigned char)*text);
  uint32_t code;

  for (size_t i = 1; i < n; i++)
    if (((unsigned char)text[i] & 0xc0) != 0x80) return 0;
  if (n < 3) return n;
  code = code_of(text, n);
  if (code < (n == 3 ? 0x800u : 0x10000u) || code > 0x10ffff) return 0;
  if (code >= 0xd800 && code <= 0xdfff) return 0;
  return code == 0xfffe || code == 0xffff ? 0 : n;
}

/* Width of a character on a terminal: 0 for combining marks, 2 for East Asian
 * characters. */
static size_t width(uint32_t c)
{
  static const struct {
    uint32_t from, to;
  } wide[] = { { 0x1100, 0x115f }, { 0x2e80, 0xa4cf },   { 0xac00, 0xd7a3 },
               { 0xf900, 0xfaff }, { 0xfe30, 0xfe6f },   { 0xff00, 0xff60 },
               { 0xffe0, 0xffe6 }, { 0x1f300, 0x1faff }, { 0x20000, 0x3fffd } };

  if ((c >= 0x300 && c <= 0x36f) || (c >= 0x200b && c <= 0x200f)) return 0;
  for (size_t i = 0; i < sizeof wide / sizeof *wide; i++)
    if (c >= wide[i].from && c <= wide[i].to) return 2;
  return 1;
}

/* Writes at most `columns` columns of text; *used: their number. */
static size_t put(const char *text, size_t columns, char *out, size_t size,
                  size_t *used)
{
  size_t at = 0;

  for (*used = 0; *text;) {
    size_t n = vg_text_character(text), take = n ? n : 1;
    uint32_t code = n ? code_of(text, n) : '?';

    if (code < 32 || code == 127) code = ' ';
    if (*used + width(code) > columns || at + take >= size) break;
    *used += width(code);
    if (take == 1) out[at] = (char)code;
    else memcpy(out + at, text, take);
    at += take;
    text += take;
  }
  out[at] = 0;
  return at;
}

char *vg_text_clean(const char *text, char *out, size_t size)
{
  size_t used;

  assert(out && size > 0);
  put(text, SIZE_MAX, out, size, &used);
  return out;
}

char *vg_text_column(const char *text, size_t columns, char *out, size_t size)
{
  size_t used, at = put(text, columns, out, size, &used);

  assert(out && size > 0);
  for (; used < columns && at + 1 < size; used++) out[at++] = ' ';
  out[at] = 0;
  return out;
}

char *vg_text_copy(const char *text)
{
  size_t size = strlen(text) + 1;
  char *out = malloc(size);

  return out ? vg_text_clean(text, out, size) : NULL;
}

void vg_text_trim_end(char *text)
{
  size_t n = strlen(text), back = 0;

  while (back < n && back < 3 &&
         ((unsigned char)text[n - 1 - back] & 0xc0) == 0x80)
    back++;
  if (back < n && announced((unsigned char)text[n - 1 - back]) > back + 1)
    text[n - 1 - back] = 0;
}

int vg_text_ends(const char *text, const char *suffix)
{
  size_t n = strlen(text), m = strlen(suffix);

  return n > m && !strcasecmp(text + n - m, suffix);
}

static atomic_int is_lost;

void vg_print_lose(void)
{
  is_lost = 1;
}

void vg_print_forget(void)
{
  is_lost = 0;
}

int vg_print_is_lost(void)
{
  return is_lost;
}

json_t *vg_text_json(const char *text)
{
  json_t *o = json_string(text);
  char *clean = o ? NULL : vg_text_copy(text);

  if (clean) o = json_string(clean);
  free(clean);
  return o;
}

char *vg_text_count(unsigned long long n, char *text)
{
  char digits[24];
  int len = snprintf(digits, sizeof digits, "%llu", n), at = 0;

  for (int i = 0; i < len; i++) {
    if (i && (len - i) % 3 == 0) text[at++] = ',';
    text[at++] = digits[i];
  }
  text[at] = 0;
  return text;
}
