/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reader and writer of JSON decks. Declared in run/settings/deck_json.h. */
#define _GNU_SOURCE
#include "run/settings/deck_json.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/stream/stream.h"
#include "run/common/text.h"
#include "run/settings/length.h"
#include "run/settings/names.h"

#define PLACE_SIZE 200 /* the place of a member, as in sources[2].h0 */
#define MAX_EXACT                                                              \
  9007199254740992.0 /* 2^53: doubles below are exact integers */

/* --- messages ------------------------------------------------------------ */

__attribute__((format(printf, 4, 5))) static vg_status refuse(
  struct vg_error *err, const char *file, const char *place, const char *format,
  ...)
{
  char *text = NULL;
  va_list args;
  vg_status st;

  va_start(args, format);
  if (vasprintf(&text, format, args) < 0) text = NULL;
  va_end(args);
  st = vg_fail(err, VG_ERR_INPUT, "%s: %s: %s", file, place,
               text ? text : "invalid");
  free(text);
  return st;
}

static const char *param_name(const void *user, size_t i)
{
  return ((const struct vg_param *)user)[i].name;
}

static const char *const top_names[] = { "$schema", "title", "settings" };
#define N_TOP (sizeof top_names / sizeof *top_names)

static const char *top_name(const void *user, size_t i)
{
  (void)user;
  if (i < N_TOP) return top_names[i];
  return vg_settings_table((enum vg_table_kind)(i - N_TOP))->name;
}

static vg_status unknown(const char *file, const char *place,
                         const struct vg_suggestion *near, const char *before,
                         struct vg_error *err)
{
  char hint[VG_HINT_SIZE];

  return refuse(err, file, place, "unknown name; %s",
                vg_hint(near, before,
                        "'vanguard deck --schema' describes all names", hint));
}

/* A member that is not in p[n]: the settings or the columns of a table. */
static vg_status unknown_member(const char *file, const char *place,
                                const char *name, const struct vg_param *p,
                                size_t n, struct vg_error *err)
{
  const struct vg_names columns = { n, param_name, p };
  struct vg_suggestion near;
  size_t n_setting;

  if (p != vg_settings_params(&n_setting)) {
    vg_suggest(name, &columns, &near);
    return unknown(file, place, &near, "", err);
  }
  for (int k = 0; k < VG_TABLE_N; k++)
    if (!strcmp(name, vg_settings_table((enum vg_table_kind)k)->name))
      return refuse(err, file, place,
                    "'%s' is a table; give it outside of 'settings'", name);
  vg_suggest_setting(name, &near);
  vg_suggest_place(&near);
  return unknown(file, place, &near, "", err);
}

static int is_setting(const char *name)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  for (size_t i = 0; i < n; i++)
    if (!strcmp(p[i].name, name)) return 1;
  return 0;
}

/* A member of the deck that is neither a table nor `settings`, into which
 * settings belong. */
static vg_status unknown_top(const char *file, const char *name,
                             struct vg_error *err)
{
  const struct vg_names names = { N_TOP + VG_TABLE_N, top_name, NULL };
  struct vg_suggestion near;

  if (is_setting(name))
    return refuse(err, file, name,
                  "this is a setting; give it as a member of 'settings'");
  vg_suggest(name, &names, &near);
  if (near.n) return unknown(file, name, &near, "", err);
  vg_suggest_setting(name, &near);
  vg_suggest_place(&near);
  return unknown(file, name, &near,
                 near.n && strchr(near.name[0], '.') ? "" : "settings.", err);
}

/* --- values -------------------------------------------------------------- */

static const char *const wanted[] = {
  [VG_PARAM_REAL] = "a number",
  [VG_PARAM_COUNT] = "an integer",
  [VG_PARAM_ID] = "an integer",
  [VG_PARAM_PATCH] = "an integer, or the name of a patch as a string",
  [VG_PARAM_FLAG] = "true or false",
  [VG_PARAM_WORD] = "a string",
  [VG_PARAM_TEXT] = "a string",
};

static int is_integer(const json_t *v)
{
  return json_is_number(v) &&
         json_number_value(v) == rint(json_number_value(v));
}

static int has_type(const struct vg_param *p, const json_t *v)
{
  switch (p->type) {
  case VG_PARAM_REAL:
    return json_is_number(v) || (vg_param_is_length(p) && json_is_string(v));
  case VG_PARAM_COUNT:
  case VG_PARAM_ID: return is_integer(v);
  case VG_PARAM_PATCH: return json_is_string(v) || is_integer(v);
  case VG_PARAM_FLAG: return json_is_boolean(v);
  case VG_PARAM_WORD:
  case VG_PARAM_TEXT: return json_is_string(v);
  }
  return 0;
}

/* A number as text in the syntax of a deck. */
static size_t number_text(const struct vg_param *p, double v, char text[64])
{
  if (p->type == VG_PARAM_REAL) return vg_format_real(v, text);
  if (fabs(v) > MAX_EXACT) return (size_t)snprintf(text, 64, "%.17g", v);
  return (size_t)snprintf(text, 64, "%.0f", v);
}

/* The text of a patch column is a name; numbers are given as numbers. */
static vg_status check_patch(const char *file, const char *place,
                             const char *name, struct vg_error *err)
{
  const char *digit = name + strspn(name, "+-");

  if (!strcmp(name, "-"))
    return refuse(err, file, place,
                  "'-' is not the name of a patch; give null");
  if (digit <= name + 1 && *digit && !digit[strspn(digit, "0123456789")])
    return refuse(err, file, place,
                  "the number of a patch must not be a string; give %s without "
                  "quotation marks",
                  name);
  return VG_OK;
}

static vg_status set_value(const char *file, const char *place,
                           const struct vg_param *p, const json_t *v,
                           void *base, struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  char number[64];
  const char *text = number;
  size_t len;

  if (json_is_null(v) && p->optional) {
    text = "-";
    len = 1;
  } else if (!has_type(p, v)) {
    return refuse(err, file, place, "must be %s%s", wanted[p->type],
                  p->optional ? ", or null for none" : "");
  } else if (json_is_string(v)) {
    text = json_string_value(v);
    len = json_string_length(v);
    if (p->type == VG_PARAM_PATCH && check_patch(file, place, text, err) < 0)
      return VG_ERR_INPUT;
    if (vg_param_is_length(p) && !vg_length_parse(text, len, &(double){ 0 }))
      return refuse(err, file, place,
                    "must be a number, or a string with a unit as in \"30mm\"");
  } else if (json_is_boolean(v)) {
    text = json_is_true(v) ? "yes" : "no";
    len = strlen(text);
  } else {
    double x = json_number_value(v);

    if (p->type == VG_PARAM_PATCH && fabs(x) > p->hi)
      return refuse(err, file, place, "%g is not the number of a patch", x);
    len = number_text(p, x, number);
  }
  if (vg_param_set(p, base, text, len, &why) >= 0) return VG_OK;
  return refuse(err, file, place, "%s", why.text);
}

/* --- objects ------------------------------------------------------------- */

/* Set members of a struct from those of an object. */
static vg_status set_members(const char *file, const char *place,
                             const struct vg_param *p, size_t n, json_t *object,
                             void *base, struct vg_error *err)
{
  char at[PLACE_SIZE];
  const char *name;
  json_t *value;

  if (!json_is_object(object))
    return refuse(err, file, place, "must be an object");
  json_object_foreach(object, name, value)
  {
    size_t i = 0;

    while (i < n && strcmp(p[i].name, name) != 0) i++;
    snprintf(at, sizeof at, "%s.%s", place, name);
    if (i == n) return unknown_member(file, at, name, p, n, err);
    if (set_value(file, at, &p[i], value, base, err) < 0) return VG_ERR_INPUT;
  }
  for (size_t i = 0; i < n; i++)
    if (p[i].required && !json_object_get(object, p[i].name))
      return refuse(err, file, place, "the member '%s' is required", p[i].name);
  return VG_OK;
}

union table_row {
  struct vg_farfield_row farfield;
  struct vg_patch_row patch;
  struct vg_layer_row layer;
  struct vg_surface_row surface;
  struct vg_wake_row wake;
  struct vg_zone_row zone;
  struct vg_periodic_row periodic;
  struct vg_source source;
  struct vg_sweep_row sweep;
  struct vg_adapt_row adapt;
};

static vg_status add_row(const char *file, const char *place,
                         enum vg_table_kind kind, json_t *object,
                         struct vg_settings *s, struct vg_error *err)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  union table_row row;
  vg_status st;

  vg_settings_row_default(kind, &row);
  st = set_members(file, place, t->column, t->n_column, object, &row, err);
  return st < 0 ? st : vg_settings_add(s, kind, &row, err);
}

static vg_status add_table(const char *file, enum vg_table_kind kind, json_t *v,
                           struct vg_settings *s, struct vg_error *err)
{
  const char *name = vg_settings_table(kind)->name;
  char place[PLACE_SIZE];
  vg_status st = VG_OK;
  json_t *object;
  size_t i;

  if (vg_table_is_single(kind)) return add_row(file, name, kind, v, s, err);
  if (!json_is_array(v))
    return refuse(err, file, name,
                  is_setting(name)
                    ? "must be an array of objects, one per row; the setting "
                      "of this name is a member of 'settings'"
                    : "must be an array of objects, one per row");
  json_array_foreach(v, i, object)
  {
    snprintf(place, sizeof place, "%s[%zu]", name, i);
    st = add_row(file, place, kind, object, s, err);
    if (st < 0) break;
  }
  return st;
}

static vg_status set_title(const char *file, const json_t *v,
                           struct vg_settings *s, struct vg_error *err)
{
  const struct vg_param title = { .name = "title",
                                  .type = VG_PARAM_TEXT,
                                  .offset = offsetof(struct vg_settings, title),
                                  .size = sizeof s->title };

  return set_value(file, "title", &title, v, s, err);
}

static vg_status set_top(const char *file, const char *name, json_t *value,
                         struct vg_settings *s, struct vg_error *err)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  if (!strcmp(name, "$schema"))
    return json_is_string(value) ? VG_OK
                                 : refuse(err, file, name, "must be a string");
  if (!strcmp(name, "title")) return set_title(file, value, s, err);
  if (!strcmp(name, "settings"))
    return set_members(file, name, p, n, value, s, err);
  for (int k = 0; k < VG_TABLE_N; k++)
    if (!strcmp(name, vg_settings_table((enum vg_table_kind)k)->name))
      return add_table(file, (enum vg_table_kind)k, value, s, err);
  return unknown_top(file, name, err);
}

static json_t *load(const char *name, const void *data, size_t size,
                    struct vg_error *err)
{
  json_error_t where;
  json_t *o = json_loadb(data, size,
                         JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL,
                         &where);

  if (!o)
    vg_fail(err, VG_ERR_FORMAT,
            "%s:%d: not a valid JSON document (a deck that begins with '{' is "
            "one): %s",
            name, where.line, where.text);
  return o;
}

int vg_deck_is_json(const void *data, size_t size)
{
  json_t *o = json_loadb(data, size, 0, NULL);

  json_decref(o);
  return o != NULL;
}

vg_status vg_deck_json_parse(const char *name, const void *data, size_t size,
                             struct vg_settings *s, struct vg_error *err)
{
  struct vg_settings fresh;
  struct vg_error why = VG_ERROR_INIT;
  json_t *o = load(name, data, size, err), *value;
  const char *member;
  vg_status st = VG_OK;

  if (!o) return VG_ERR_FORMAT;
  vg_settings_default(&fresh);
  if (!json_is_object(o)) {
    st = vg_fail(
      err, VG_ERR_FORMAT,
      "%s: a JSON deck is an object, as in { \"settings\": { ... } }", name);
    goto done;
  }
  json_object_foreach(o, member, value)
  {
    st = set_top(name, member, value, &fresh, err);
    if (st < 0) goto done;
  }
  st = vg_settings_check(&fresh, &why);
  if (st < 0) {
    vg_fail(err, st, "%s: %s", name, why.text);
    goto done;
  }
  vg_settings_release(s);
  *s = fresh;
  memset(&fresh, 0, sizeof fresh);
done:
  vg_settings_release(&fresh);
  json_decref(o);
  return st;
}

/* --- writer -------------------------------------------------------------- */

static json_t *real_json(double v)
{
  char text[VG_LENGTH_TEXT];

  if (vg_length_has_unit(v)) {
    vg_length_format(v, text);
    return json_string(text);
  }
  if (isnan(v)) return json_null();
  if (v == rint(v) && fabs(v) < 1e15) return json_integer((json_int_t)v);
  return json_real(v);
}

static json_t *value_json(const struct vg_param *p, const void *base)
{
  const char *at = (const char *)base + p->offset;
  double real;
  int64_t count;
  int32_t id;
  int word;

  switch (p->type) {
  case VG_PARAM_REAL: memcpy(&real, at, sizeof real); return real_json(real);
  case VG_PARAM_COUNT:
    memcpy(&count, at, sizeof count);
    if (p->optional && count == VG_COUNT_NONE) return json_null();
    return json_integer((json_int_t)count);
  case VG_PARAM_ID:
  case VG_PARAM_PATCH:
    memcpy(&id, at, sizeof id);
    if (p->type == VG_PARAM_PATCH && ((const char *)base)[p->name_at])
      return vg_text_json((const char *)base + p->name_at);
    return p->optional && id == VG_BC_NONE ? json_null() : json_integer(id);
  case VG_PARAM_FLAG: memcpy(&word, at, sizeof word); return json_boolean(word);
  case VG_PARAM_WORD:
    memcpy(&word, at, sizeof word);
    return json_string(p->words[word]);
  case VG_PARAM_TEXT: return vg_text_json(at);
  }
  return NULL;
}

static json_t *members_json(const struct vg_param *p, size_t n,
                            const void *base)
{
  json_t *o = json_object();

  for (size_t i = 0; i < n; i++)
    json_object_set_new(o, p[i].name, value_json(&p[i], base));
  return o;
}

json_t *vg_deck_row_json(enum vg_table_kind kind, const void *row)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  union table_row usual;

  vg_settings_row_default(kind, &usual);
  return members_json(t->column, t->n_column, row ? row : &usual);
}

json_t *vg_deck_json(const struct vg_settings *s)
{
  json_t *o = json_object();
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  json_object_set_new(o, "title", vg_text_json(s->title));
  json_object_set_new(o, "settings", members_json(p, n, s));
  for (int k = 0; k < VG_TABLE_N; k++) {
    const enum vg_table_kind kind = (enum vg_table_kind)k;
    const struct vg_setting_table *t = vg_settings_table(kind);
    size_t rows = vg_settings_rows(s, kind);
    json_t *list = json_array();

    for (size_t i = 0; i < rows; i++)
      json_array_append_new(list,
                            vg_deck_row_json(kind,
                                             vg_settings_row(s, kind, i)));
    if (vg_table_is_single(kind)) {
      if (rows) json_object_set(o, t->name, json_array_get(list, 0));
      json_decref(list);
    } else {
      json_object_set_new(o, t->name, list);
    }
  }
  return o;
}
