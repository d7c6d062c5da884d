/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Conversion of settings from and to text. Declared in
 * run/settings/settings.h. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/stream/stream.h"
#include "run/common/ranges.h"
#include "run/settings/length.h"
#include "run/settings/names.h"
#include "run/settings/settings.h"

static vg_status out_of_range(const struct vg_param *p, const char *text,
                              size_t len, struct vg_error *err)
{
  char lo[33];

  lo[vg_format_real(p->lo, lo)] = 0;
  return vg_fail(err, VG_ERR_INPUT,
                 "%s is %.*s; it must be %s %s and at most "
                 "%g",
                 p->name, (int)len, text, p->above_lo ? "above" : "at least",
                 lo, p->hi);
}

static int in_range(const struct vg_param *p, double v)
{
  return (p->above_lo ? v > p->lo : v >= p->lo) && v <= p->hi;
}

static vg_status set_real(const struct vg_param *p, void *at, const char *text,
                          size_t len, struct vg_error *err)
{
  const int is_length = vg_param_is_length(p);
  int has_unit = 0;
  double v;

  if (!vg_parse_real(text, len, &v)) {
    if (is_length) has_unit = vg_length_parse(text, len, &v);
    if (has_unit < 0)
      return vg_fail(err, VG_ERR_INPUT,
                     "%s is %.*s; a length with a unit has at most 10 digits "
                     "and an exponent of at most 99",
                     p->name, (int)len, text);
    if (!has_unit)
      return vg_fail(err, VG_ERR_INPUT, "%s must be a number%s, not '%.*s'",
                     p->name,
                     is_length ? ", or one with a unit as in 30mm (mm, cm, m, "
                                 "km, inch, foot)"
                               : "",
                     (int)len, text);
  }
  if (!in_range(p, has_unit ? vg_length_number(v) : v))
    return out_of_range(p, text, len, err);
  memcpy(at, &v, sizeof v);
  return VG_OK;
}

static vg_status check_characters(const struct vg_param *p, const char *text,
                                  size_t len, struct vg_error *err)
{
  for (size_t i = 0; i < len; i++)
    if ((unsigned char)text[i] < ' ' || text[i] == 127)
      return vg_fail(err, VG_ERR_INPUT, "%s contains a control character",
                     p->name);
  return VG_OK;
}

static vg_status set_int(const struct vg_param *p, void *at, const char *text,
                         size_t len, struct vg_error *err)
{
  int64_t v;
  int32_t id;

  if (!(p->type == VG_PARAM_COUNT ? vg_parse_count : vg_parse_int)(text, len,
                                                                   &v))
    return vg_fail(err, VG_ERR_INPUT,
                   "%s must be an integer, not "
                   "'%.*s'",
                   p->name, (int)len, text);
  if (!in_range(p, (double)v)) return out_of_range(p, text, len, err);
  id = (int32_t)v;
  if (p->type == VG_PARAM_COUNT) memcpy(at, &v, sizeof v);
  else memcpy(at, &id, sizeof id);
  return VG_OK;
}

/* A number, or a name, which is looked up once the surface has been read. */
static vg_status set_patch(const struct vg_param *p, void *base,
                           const char *text, size_t len, struct vg_error *err)
{
  const int32_t none = VG_BC_NONE;
  char *name = (char *)base + p->name_at;
  int64_t v;
  vg_status st;

  if (vg_parse_int(text, len, &v)) {
    st = set_int(p, (char *)base + p->offset, text, len, err);
    if (st >= 0) memset(name, 0, VG_NAME_MAX);
    return st;
  }
  if (!len || len >= VG_NAME_MAX)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s must be the number or name of a "
                   "patch, not '%.*s'",
                   p->name, (int)len, text);
  st = check_characters(p, text, len, err);
  if (st < 0) return st;
  memcpy((char *)base + p->offset, &none, sizeof none);
  memset(name, 0, VG_NAME_MAX);
  memcpy(name, text, len);
  return VG_OK;
}

static const char *word_at(const void *user, size_t i)
{
  return ((const char *const *)user)[i];
}

static vg_status set_word(const struct vg_param *p, const char *const *words,
                          void *at, const char *text, size_t len,
                          struct vg_error *err)
{
  char list[256] = "", word[64], hint[VG_HINT_SIZE];
  struct vg_names names = { 0, word_at, words };
  size_t n = 0, used = 0;

  for (; words[n]; n++) {
    int i = (int)n;

    if (vg_token_is(text, len, words[n])) {
      memcpy(at, &i, sizeof i);
      return VG_OK;
    }
    used += (size_t)snprintf(list + used, sizeof list - used, "%s%s",
                             n ? ", " : "", words[n]);
  }
  snprintf(word, sizeof word, "%.*s", (int)len, text);
  names.n = n;
  vg_hint_for(word, &names, "", "", hint);
  if (*hint)
    return vg_fail(err, VG_ERR_INPUT, "%s cannot be '%s'; %s (one of %s)",
                   p->name, word, hint, list);
  return vg_fail(err, VG_ERR_INPUT, "%s cannot be '%s'; it is one of %s",
                 p->name, word, list);
}

static vg_status set_text(const struct vg_param *p, char *at, const char *text,
                          size_t len, struct vg_error *err)
{
  if (len >= p->size)
    return vg_fail(err, VG_ERR_INPUT,
                   "%s has %zu characters; at most %zu "
                   "are allowed",
                   p->name, len, p->size - 1);
  if (check_characters(p, text, len, err) < 0) return VG_ERR_INPUT;
  memset(at, 0, p->size);
  memcpy(at, text, len);
  return p->check ? p->check(p->name, at, err) : VG_OK;
}

vg_status vg_param_set(const struct vg_param *p, void *base, const char *text,
                       size_t len, struct vg_error *err)
{
  static const char *const yes_no[] = { "no", "yes", NULL };
  const double unset = NAN;
  const int32_t none = VG_BC_NONE;
  const int64_t no_count = VG_COUNT_NONE;
  char *at = (char *)base + p->offset;

  assert(p && base && (text || !len));
  if (p->optional && vg_token_is(text, len, "-")) {
    if (p->type == VG_PARAM_REAL) memcpy(at, &unset, sizeof unset);
    if (p->type == VG_PARAM_ID || p->type == VG_PARAM_PATCH)
      memcpy(at, &none, sizeof none);
    if (p->type == VG_PARAM_PATCH)
      memset((char *)base + p->name_at, 0, VG_NAME_MAX);
    if (p->type == VG_PARAM_COUNT) memcpy(at, &no_count, sizeof no_count);
    return VG_OK;
  }
  switch (p->type) {
  case VG_PARAM_REAL: return set_real(p, at, text, len, err);
  case VG_PARAM_COUNT:
  case VG_PARAM_ID: return set_int(p, at, text, len, err);
  case VG_PARAM_PATCH: return set_patch(p, base, text, len, err);
  case VG_PARAM_FLAG: return set_word(p, yes_no, at, text, len, err);
  case VG_PARAM_WORD: return set_word(p, p->words, at, text, len, err);
  case VG_PARAM_TEXT: return set_text(p, at, text, len, err);
  }
  return VG_OK;
}

/* Quote a text that would not be read back as one token; a " inside is written
 * as "". */
static void format_text(const char *text, char *out, size_t size)
{
  int bare = *text && strcmp(text, "-") != 0 && !strpbrk(text, " #\"");
  size_t n = 0;

  if (!bare) out[n++] = '"';
  for (; *text && n + 4 < size; text++) {
    unsigned char c = (unsigned char)*text;

    if (c == '"') out[n++] = '"';
    out[n++] = c < ' ' || c == 127 ? '?' : (char)c;
  }
  if (!bare) out[n++] = '"';
  out[n] = 0;
}

void vg_param_format(const struct vg_param *p, const void *base, char *out,
                     size_t size)
{
  const char *at = (const char *)base + p->offset;
  char real[33];
  double v;
  int64_t count;
  int32_t id;
  int word;

  assert(p && base && out && size > 0);
  if (p->type == VG_PARAM_PATCH && ((const char *)base)[p->name_at]) {
    format_text((const char *)base + p->name_at, out, size);
    return;
  }
  switch (p->type) {
  case VG_PARAM_REAL:
    memcpy(&v, at, sizeof v);
    if (vg_length_has_unit(v)) vg_length_format(v, real);
    else if (isnan(v)) snprintf(real, sizeof real, "-");
    else real[vg_format_real(v, real)] = 0;
    snprintf(out, size, "%s", real);
    break;
  case VG_PARAM_COUNT:
    memcpy(&count, at, sizeof count);
    if (count == VG_COUNT_NONE && p->optional) snprintf(out, size, "-");
    else snprintf(out, size, "%lld", (long long)count);
    break;
  case VG_PARAM_ID:
  case VG_PARAM_PATCH:
    memcpy(&id, at, sizeof id);
    if (id == VG_BC_NONE && p->optional) snprintf(out, size, "-");
    else snprintf(out, size, "%d", (int)id);
    break;
  case VG_PARAM_FLAG:
    memcpy(&word, at, sizeof word);
    snprintf(out, size, "%s", word ? "yes" : "no");
    break;
  case VG_PARAM_WORD:
    memcpy(&word, at, sizeof word);
    snprintf(out, size, "%s", p->words[word]);
    break;
  case VG_PARAM_TEXT: format_text(at, out, size); break;
  }
}
