/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/settings/length.h"

#include <assert.h>
#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/cad/cad.h"
#include "io/stream/stream.h"

/* In the order of enum vg_cad_unit; tenths of a millimetre. */
static const struct {
  const char *name;
  double tenths;
} units[VG_CAD_UNIT_N] = { { "", 0 },       { "mm", 10 },  { "cm", 100 },
                           { "m", 1e4 },    { "km", 1e7 }, { "inch", 254 },
                           { "foot", 3048 } };

/* Bits of the NaN: a mark, unit, exponent with an offset, sign, digits. */
enum { DIGITS = 34, OFFSET = 128, MOST_DIGITS = 10, MOST_EXPONENT = 99 };
#define MARK (UINT64_C(0x7ffc) << 48) /* a quiet NaN with another bit set */

struct parts {
  int unit, exponent, is_negative;
  uint64_t digits;
};

static double pack(const struct parts *p)
{
  const uint64_t bits = MARK | (uint64_t)p->unit << (DIGITS + 9) |
                        (uint64_t)(p->exponent + OFFSET) << (DIGITS + 1) |
                        (uint64_t)p->is_negative << DIGITS | p->digits;
  double v;

  memcpy(&v, &bits, sizeof v);
  return v;
}

static struct parts unpack(double v)
{
  uint64_t bits;

  memcpy(&bits, &v, sizeof bits);
  return (struct parts){ (int)(bits >> (DIGITS + 9) & 7),
                         (int)(bits >> (DIGITS + 1) & 255) - OFFSET,
                         (int)(bits >> DIGITS & 1),
                         bits & ((UINT64_C(1) << DIGITS) - 1) };
}

int vg_length_has_unit(double v)
{
  uint64_t bits;

  memcpy(&bits, &v, sizeof bits);
  return (bits & MARK) == MARK && !(bits >> 63) && unpack(v).unit > 0;
}

/* Unit at the end of the text; *n: length of the number before it. */
static int find_unit(const char *text, size_t len, size_t *n)
{
  static const char *const other[][2] = { { "in", "inch" }, { "ft", "foot" } };
  char word[8];

  *n = len;
  while (*n && isalpha((unsigned char)text[*n - 1])) --*n;
  if (len - *n >= sizeof word) return 0;
  snprintf(word, sizeof word, "%.*s", (int)(len - *n), text + *n);
  for (size_t i = 0; i < sizeof other / sizeof *other; i++)
    if (!strcmp(word, other[i][0]))
      snprintf(word, sizeof word, "%s", other[i][1]);
  for (int i = 1; i < VG_CAD_UNIT_N; i++)
    if (!strcmp(word, units[i].name)) return i;
  return 0;
}

/* The digits of a number, without leading and trailing zeros. */
static int read_digits(const char *text, size_t n, struct parts *p)
{
  int n_digit = 0, n_zero = 0, after = 0;
  size_t i = text[0] == '-' || text[0] == '+';

  p->is_negative = text[0] == '-';
  for (; i < n && !strchr("eEdD", text[i]); i++) {
    if (text[i] == '.') {
      after = 1;
      continue;
    }
    p->exponent -= after;
    if (text[i] == '0') {
      n_zero++;
      continue;
    }
    for (; p->digits && n_zero && n_digit < MOST_DIGITS; n_zero--, n_digit++)
      p->digits *= 10;
    if (n_digit >= MOST_DIGITS) return -1;
    p->digits = 10 * p->digits + (uint64_t)(text[i] - '0');
    n_zero = 0;
    n_digit++;
  }
  p->exponent += n_zero;
  if (i < n) p->exponent += (int)strtol(text + i + 1, NULL, 10);
  if (!p->digits) p->exponent = 0;
  return abs(p->exponent) > MOST_EXPONENT ? -1 : 1;
}

int vg_length_parse(const char *text, size_t len, double *out)
{
  struct parts p = { 0, 0, 0, 0 };
  char number[64];
  double v;
  size_t n;

  p.unit = find_unit(text, len, &n);
  if (!p.unit || !n || n >= sizeof number) return 0;
  memcpy(number, text, n);
  number[n] = 0;
  if (!vg_parse_real(number, n, &v)) return 0;
  if (read_digits(number, n, &p) < 0) return -1;
  *out = pack(&p);
  return 1;
}

/* The number times `factor`, which is an integer. */
static double times(const struct parts *p, double factor)
{
  char text[64];

  snprintf(text, sizeof text, "%s%.0fe%d", p->is_negative ? "-" : "",
           (double)p->digits * factor, p->exponent);
  return strtod(text, NULL);
}

double vg_length_number(double v)
{
  const struct parts p = unpack(v);

  assert(vg_length_has_unit(v));
  return times(&p, 1);
}

double vg_length_in(double v, int unit)
{
  struct parts p = unpack(v);
  double up, down;

  assert(vg_length_has_unit(v));
  vg_unit_factor(p.unit, unit, &up, &down);
  for (; fmod(down, 10) == 0; down /= 10) p.exponent--;
  return times(&p, up) / down;
}

void vg_length_format(double v, char text[VG_LENGTH_TEXT])
{
  const struct parts p = unpack(v);
  char number[33];

  number[vg_format_real(times(&p, 1), number)] = 0;
  snprintf(text, VG_LENGTH_TEXT, "%.18s%s", number, units[p.unit].name);
}

void vg_unit_factor(int from, int to, double *up, double *down)
{
  assert(from > 0 && from < VG_CAD_UNIT_N && to > 0 && to < VG_CAD_UNIT_N);
  *up = units[from].tenths;
  *down = units[to].tenths;
  while (fmod(*up, 10) == 0 && fmod(*down, 10) == 0) *up /= 10, *down /= 10;
  if (fmod(*down, *up) == 0) *down /= *up, *up = 1;
  else if (fmod(*up, *down) == 0) *up /= *down, *down = 1;
}

const char *vg_unit_name(int unit)
{
  assert(unit > 0 && unit < VG_CAD_UNIT_N);
  return units[unit].name;
}
