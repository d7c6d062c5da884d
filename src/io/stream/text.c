/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Tokens, numbers and lines of text files; see io/stream/stream.h. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* for strtod_l */
#endif
#include "io/stream/stream.h"

#include <assert.h>
#include <float.h>
#include <locale.h>
#include <stdlib.h>
#include <string.h>

static int is_space(unsigned char c)
{
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/* data[size] is 0, which is neither white space nor a digit and ends all
 * loops. */
static void skip_space(struct vg_input *in, int in_line)
{
  const unsigned char *d = in->data;
  size_t at = in->at;

  while (at < in->size) {
    if (in->comment && d[at] == in->comment) {
      const unsigned char *end = memchr(d + at, '\n', in->size - at);

      at = end ? (size_t)(end - d) : in->size;
    } else if (d[at] == '\n') {
      if (in_line) break;
      in->line++;
      at++;
    } else if (is_space(d[at])) {
      at++;
    } else {
      break;
    }
  }
  in->at = at;
}

static int take_token(struct vg_input *in, const char **text, size_t *len)
{
  const unsigned char *d = in->data;
  size_t at = in->at;

  if (at >= in->size || d[at] == '\n') return 0;
  while (at < in->size && !is_space(d[at]) &&
         !(in->comment && d[at] == in->comment))
    at++;
  *text = (const char *)d + in->at;
  *len = at - in->at;
  in->at = at;
  return 1;
}

int vg_input_token(struct vg_input *in, const char **text, size_t *len)
{
  assert(text && len && in->at <= in->size);
  skip_space(in, 0);
  return take_token(in, text, len);
}

int vg_input_token_in_line(struct vg_input *in, const char **text, size_t *len)
{
  assert(text && len && in->at <= in->size);
  skip_space(in, 1);
  return take_token(in, text, len);
}

int vg_input_line(struct vg_input *in, const char **text, size_t *len)
{
  assert(text && len && in->at <= in->size);

  const unsigned char *d = in->data, *end;
  size_t n;

  if (in->at >= in->size) return 0;
  end = memchr(d + in->at, '\n', in->size - in->at);
  n = end ? (size_t)(end - d) - in->at : in->size - in->at;
  *text = (const char *)d + in->at;
  *len = n && d[in->at + n - 1] == '\r' ? n - 1 : n;
  in->at += n + !!end;
  in->line += !!end;
  return 1;
}

int vg_token_is(const char *text, size_t len, const char *s)
{
  assert((text || !len) && s);
  return strlen(s) == len && !memcmp(text, s, len);
}

int vg_parse_int(const char *text, size_t len, int64_t *v)
{
  assert((text || !len) && v);

  size_t i = len && (text[0] == '-' || text[0] == '+');
  uint64_t n = 0;
  int negative = i && text[0] == '-';

  if (i == len || len - i > 19) return 0;
  for (; i < len; i++) {
    unsigned digit = (unsigned char)text[i] - (unsigned)'0';

    if (digit > 9) return 0;
    n = 10 * n + digit;
  }
  if (n > (uint64_t)INT64_MAX) return 0;
  *v = negative ? -(int64_t)n : (int64_t)n;
  return 1;
}

/* Decimal number split into its parts: value = mantissa * 10^exponent. */
struct decimal {
  uint64_t mantissa; /* first 19 significant digits */
  int exponent;
  int negative, exact; /* exact: no digit was dropped */
};

static int scan_exponent(const char **s, const char *end, int *exponent)
{
  int negative = 0, value = 0;

  if (*s < end && (**s == '+' || **s == '-')) negative = *(*s)++ == '-';
  if (*s == end) return 0;
  for (; *s < end; ++*s) {
    unsigned digit = (unsigned char)**s - (unsigned)'0';

    if (digit > 9) return 0;
    if (value < 100000) value = 10 * value + (int)digit;
  }
  *exponent += negative ? -value : value;
  return 1;
}

static int scan_decimal(const char *s, const char *end, struct decimal *d)
{
  int n_digit = 0, n_any = 0, seen_point = 0;

  memset(d, 0, sizeof *d);
  d->exact = 1;
  if (s < end && (*s == '+' || *s == '-')) d->negative = *s++ == '-';
  for (; s < end; s++) {
    unsigned digit = (unsigned char)*s - (unsigned)'0';

    if (*s == '.' && !seen_point) {
      seen_point = 1;
    } else if (digit > 9) {
      break;
    } else {
      n_any = 1;
      if (n_digit < 19) {
        d->mantissa = 10 * d->mantissa + digit;
        n_digit += d->mantissa != 0;
        d->exponent -= seen_point;
      } else {
        d->exact &= !digit;
        d->exponent += !seen_point;
      }
    }
  }
  if (!n_any) return 0;
  if (s == end) return 1;
  if (*s == 'e' || *s == 'E' || *s == 'd' || *s == 'D') s++;
  else if (*s != '+' && *s != '-') return 0;
  return scan_exponent(&s, end, &d->exponent);
}

static const double power10[23] = { 1e0,  1e1,  1e2,  1e3,  1e4,  1e5,
                                    1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17,
                                    1e18, 1e19, 1e20, 1e21, 1e22 };

/* If `long double` has a 64-bit mantissa, both the mantissa and the power (5^27
 * < 2^64) are exact and only one rounding occurs. The second rounding, to
 * double, is correct unless the first result is next to the midpoint of two
 * doubles. */
static int scale_extended(const struct decimal *d, double *v)
{
#if LDBL_MANT_DIG == 64
  static const long double power[28] = {
    1e0L,  1e1L,  1e2L,  1e3L,  1e4L,  1e5L,  1e6L,  1e7L,  1e8L,  1e9L,
    1e10L, 1e11L, 1e12L, 1e13L, 1e14L, 1e15L, 1e16L, 1e17L, 1e18L, 1e19L,
    1e20L, 1e21L, 1e22L, 1e23L, 1e24L, 1e25L, 1e26L, 1e27L
  };
  long double x = (long double)d->mantissa;
  uint64_t bits;
  unsigned low;

  if (!d->exact || d->exponent < -27 || d->exponent > 27) return 0;
  x = d->exponent < 0 ? x / power[-d->exponent] : x * power[d->exponent];
  memcpy(&bits, &x, sizeof bits);
  low = bits & 0x7ff;
  if (low >= 0x3ff && low <= 0x401) return 0;
  *v = (double)x;
  return 1;
#else
  (void)d;
  (void)v;
  return 0;
#endif
}

/* For the rare remaining cases, use the C library in the C locale (a constant
 * object: no allocation, no global state). */
static int parse_slow(const char *text, size_t len, double *v)
{
  char buffer[128], *end, *copy = buffer;
  locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
  size_t n = 0;
  int seen_exponent = 0, ok;

  if (!c) return 0;
  if (len + 2 > sizeof buffer) copy = malloc(len + 2);
  if (copy) {
    for (size_t i = 0; i < len; i++) {
      char t = text[i];
      int is_mark = t == 'e' || t == 'E' || t == 'd' || t == 'D';

      if (is_mark) t = 'e';
      if (i && (t == '+' || t == '-') && !seen_exponent) copy[n++] = 'e';
      seen_exponent |= is_mark || (i && (t == '+' || t == '-'));
      copy[n++] = t;
    }
    copy[n] = 0;
    *v = strtod_l(copy, &end, c);
  }
  ok = copy && end == copy + n && *v >= -DBL_MAX && *v <= DBL_MAX;
  if (copy != buffer) free(copy);
  freelocale(c);
  return ok;
}

int vg_parse_real(const char *text, size_t len, double *v)
{
  struct decimal d;
  double x;

  assert((text || !len) && v);
  if (!scan_decimal(text, text + len, &d)) return 0;
  if (!d.mantissa && d.exact) {
    x = 0;
  } else if (d.exact && d.mantissa <= (uint64_t)1 << 53 && d.exponent >= -22 &&
             d.exponent <= 22) {
    x = (double)d.mantissa;
    x = d.exponent < 0 ? x / power10[-d.exponent] : x * power10[d.exponent];
  } else if (!scale_extended(&d, &x)) {
    return parse_slow(text, len, v);
  }
  *v = d.negative ? -x : x;
  return 1;
}

static vg_status token_error(const struct vg_input *in, const char *text,
                             size_t len, const char *kind, const char *what,
                             struct vg_error *err)
{
  for (size_t i = 0; i < len; i++) {
    unsigned char c = (unsigned char)text[i];

    if (c < 32 || c == 127)
      return vg_input_fail(in, err,
                           "binary data instead of %s (%s): this is not a "
                           "text file; check its suffix",
                           kind, what);
  }
  return vg_input_fail(in, err, "expected %s (%s), not '%.*s'", kind, what,
                       (int)(len < 40 ? len : 40), text);
}

vg_status vg_input_int(struct vg_input *in, int64_t *v, const char *what,
                       struct vg_error *err)
{
  const char *text;
  size_t len;

  assert(v && what);
  if (!vg_input_token(in, &text, &len))
    return vg_input_fail(in, err, "the file ends where %s was expected", what);
  if (vg_parse_int(text, len, v)) return VG_OK;
  return token_error(in, text, len, "an integer", what, err);
}

vg_status vg_input_real(struct vg_input *in, double *v, const char *what,
                        struct vg_error *err)
{
  const char *text;
  size_t len;

  assert(v && what);
  if (!vg_input_token(in, &text, &len))
    return vg_input_fail(in, err, "the file ends where %s was expected", what);
  if (vg_parse_real(text, len, v)) return VG_OK;
  return token_error(in, text, len, "a finite number", what, err);
}

int vg_input_is_text(const struct vg_input *in)
{
  size_t n = in->size < 65536 ? in->size : 65536;

  for (size_t i = 0; i < n; i++) {
    unsigned char c = in->data[i];

    if (c < 32 && !is_space(c)) return 0;
  }
  return 1;
}
