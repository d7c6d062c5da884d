/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The JSON Schema of JSON decks. Declared in run/settings/deck_json.h. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/settings/deck_json.h"
#include "run/settings/length.h"

#define NO_CONTROL "^[^\\u0000-\\u001f\\u007f]*$(?!\\n)"
/* A name of a patch: not the number of one, and not '-'. */
#define PATCH_NAME                                                             \
  "^(?![-+]?[0-9]+$(?!\\n))(?!-$(?!\\n))[^\\u0000-\\u001f\\u007f]+$(?!\\n)"

/* --- conditions ---------------------------------------------------------- */

/* Conditions on the values of one setting or column, in addition to its range:
 * JSON that is merged into its description. table NULL: a setting. */
static const struct {
  const char *table, *name, *json;
} value_condition[] = {
  { NULL, "layer_cap", "{'anyOf':[{'enum':[null,0]},{'minimum':1}]}" },
  { NULL, "coarsening", "{'anyOf':[{'const':0},{'minimum':1}]}" },
  { NULL, "write",
    "{'not':{'anyOf':["
    "{'allOf':[{'pattern':'(?:^|[, ])foam(?:[, ]|$)'},"
    "{'pattern':'(?:^|[, ])foam-ascii(?:[, ]|$)'}]},"
    "{'allOf':[{'pattern':'(?:^|[, ])foam(?:[, ]|$)'},"
    "{'pattern':'(?:^|[, ])openfoam(?:[, ]|$)'}]},"
    "{'allOf':[{'pattern':'(?:^|[, ])openfoam(?:[, ]|$)'},"
    "{'pattern':'(?:^|[, ])foam-ascii(?:[, ]|$)'}]}]}}" },
  { NULL, "walls", "{'x-conditions':['ranges']}" },
  { NULL, "slip", "{'x-conditions':['ranges']}" },
  { "layers", "cap", "{'anyOf':[{'enum':[null,0]},{'minimum':1}]}" },
  { "surface", "across", "{'anyOf':[{'const':0},{'minimum':1}]}" },
  { "surface", "stretch", "{'anyOf':[{'const':0},{'minimum':1}]}" },
  { "sources", "growth", "{'anyOf':[{'const':0},{'exclusiveMinimum':1}]}" },
  { "sources", "mach", "{'anyOf':[{'const':0},{'exclusiveMinimum':1}]}" },
};

#define POSITIVE "{'exclusiveMinimum':0}"
#define GIVEN "{'not':{'type':'null'}}"
#define FILLED "{'minLength':1}"
#define TRUE "{'const':true}"
#define MACH "{'const':'mach'}"
#define COMMA "{'pattern':','}"
#define ONE_OR_MORE "{'minimum':1}"

/* Conditions on two members of an object: if `first` is given and is `a`, then
 * `second` must be given and be `b`, or must not. */
enum relation { NEEDS, EXCLUDES };

static const struct {
  const char *object; /* "settings", or a row of the table */
  const char *first, *a;
  enum relation relation;
  const char *second, *b;
} pair_condition[] = {
  { "settings", "first", POSITIVE, EXCLUDES, "y_plus", POSITIVE },
  { "wakes", "kind", "{'const':'sheet'}", EXCLUDES, "alpha", COMMA },
  { "wakes", "kind", "{'const':'sheet'}", EXCLUDES, "beta", COMMA },
  { "settings", "ratio", GIVEN, EXCLUDES, "rate1", GIVEN },
  { "settings", "ratio", GIVEN, EXCLUDES, "rate2", GIVEN },
  { "settings", "reynolds", POSITIVE, NEEDS, "reference_length", POSITIVE },
  { "settings", "reference_length", POSITIVE, NEEDS, "reynolds", POSITIVE },
  { "settings", "y_plus", POSITIVE, NEEDS, "reynolds", POSITIVE },
  { "settings", "first_from", FILLED, EXCLUDES, "first", POSITIVE },
  { "settings", "first_from", FILLED, EXCLUDES, "layers", "{'const':'no'}" },
  { "settings", "first_from", FILLED, EXCLUDES, "layer_sources", TRUE },
  { "settings", "first_from", FILLED, NEEDS, "y_plus", POSITIVE },
  { "settings", "constant_direction", TRUE, NEEDS, "split_direction",
    ONE_OR_MORE },
  { "layers", "first", GIVEN, EXCLUDES, "y_plus", GIVEN },
  { "layers", "ratio", GIVEN, EXCLUDES, "rate1", GIVEN },
  { "layers", "ratio", GIVEN, EXCLUDES, "rate2", GIVEN },
  { "farfield", "x", GIVEN, NEEDS, "y", GIVEN },
  { "farfield", "y", GIVEN, NEEDS, "z", GIVEN },
  { "farfield", "z", GIVEN, NEEDS, "x", GIVEN },
  { "farfield", "xlo", GIVEN, NEEDS, "ylo", GIVEN },
  { "farfield", "ylo", GIVEN, NEEDS, "zlo", GIVEN },
  { "farfield", "zlo", GIVEN, NEEDS, "xhi", GIVEN },
  { "farfield", "xhi", GIVEN, NEEDS, "yhi", GIVEN },
  { "farfield", "yhi", GIVEN, NEEDS, "zhi", GIVEN },
  { "farfield", "zhi", GIVEN, NEEDS, "xlo", GIVEN },
  { "farfield", "xlo", GIVEN, NEEDS, "kind", "{'enum':['box','tunnel']}" },
  { "farfield", "kind", MACH, NEEDS, "mach", GIVEN },
  { "farfield", "mach", GIVEN, NEEDS, "kind", MACH },
  { "farfield", "upstream", GIVEN, NEEDS, "kind", MACH },
  { "farfield", "downstream", GIVEN, NEEDS, "kind", MACH },
  { "farfield", "radial", GIVEN, NEEDS, "kind", MACH },
  { "farfield", "ux", GIVEN, NEEDS, "kind", MACH },
  { "farfield", "ux", GIVEN, NEEDS, "uy", GIVEN },
  { "farfield", "uy", GIVEN, NEEDS, "uz", GIVEN },
  { "farfield", "uz", GIVEN, NEEDS, "ux", GIVEN },
  { "farfield", "kind", MACH, EXCLUDES, "size", POSITIVE },
  { "farfield", "kind", MACH, EXCLUDES, "lengths", "{'not':{'const':20}}" },
};

/* Further conditions on an object, as in pair_condition; object "": the whole
 * document. */
static const struct {
  const char *object, *json;
} object_condition[] = {
  { "surface",
    "{'anyOf':["
    "{'required':['size'],'properties':{'size':" POSITIVE "}},"
    "{'required':['lead'],'properties':{'lead':" POSITIVE "}},"
    "{'required':['trail'],'properties':{'trail':" POSITIVE "}},"
    "{'required':['root'],'properties':{'root':" POSITIVE "}},"
    "{'required':['tip'],'properties':{'tip':" POSITIVE "}},"
    "{'required':['across'],'properties':{'across':" POSITIVE "}},"
    "{'required':['stretch'],'properties':{'stretch':" POSITIVE "}}]}" },
  { "surface", "{'if':{'required':['adjacent'],"
               "'properties':{'adjacent':{'type':['integer','string']}}},"
               "'then':{'properties':{'lead':{'const':0},'trail':{'const':0},"
               "'root':{'const':0},'tip':{'const':0},'across':{'const':0}}},"
               "'else':{'properties':{'stretch':{'const':0}}}}" },
  { "", "{'not':{'required':['settings','farfield'],'properties':{"
        "'settings':{'required':['flow'],"
        "'properties':{'flow':{'const':'internal'}}},"
        "'farfield':{'required':['kind'],"
        "'properties':{'kind':{'enum':['sphere','box','mach',"
        "'c','tunnel']}}}}}}" },
  { "", "{'not':{'required':['settings','farfield'],'properties':{"
        "'settings':{'required':['flow'],"
        "'properties':{'flow':{'const':'external'}}},"
        "'farfield':{'required':['kind'],"
        "'properties':{'kind':{'const':'none'}}}}}}" },
  { "",
    "{'if':{'required':['layers'],'properties':{'layers':{'type':'array',"
    "'contains':{'required':['y_plus'],'properties':{'y_plus':" GIVEN "}}}}},"
    "'then':{'required':['settings'],'properties':{'settings':{"
    "'required':['reynolds'],'properties':{'reynolds':" POSITIVE "}}}}}" },
};

/* Conditions that JSON Schema cannot express, with their names. */
static const char *const further[][2] = {
  { "ranges", "in a list of patches, a range such as 3-12 ascends" },
  { "sizes", "settings: hmin is at most hmax, unless one of them is 0" },
  { "first-height",
    "settings: the first height is at most layer_total, unless that is 0. The "
    "height is `first` or, if y_plus, reynolds (Re) and reference_length (L) "
    "are above 0, 2 y_plus L / (Re sqrt(cf / 2)) for the skin friction "
    "coefficient cf of a flat plate at the trailing edge" },
  { "wakes",
    "wakes: size is at most length, and at most twice height, unless kind is "
    "sheet; stream and up "
    "name different axes" },
  { "periodic",
    "periodic: tx, ty and tz are given together and not all 0, or angle, not "
    "0, with ux, uy and uz, which are given together and not all 0, or "
    "neither; x, y and z only with an angle; kind does not contradict them" },
  { "corners", "farfield: each lower corner is below the upper one" },
  { "patches", "patches, layers: no two rows have the same number as id" },
  { "bytes",
    "limits named x-maxBytes are counted in bytes of UTF-8, and so are the 79 "
    "bytes of a name in a list of patches" },
};

/* --- building ------------------------------------------------------------ */

/* JSON with ' for ", which keeps the tables above readable. */
static json_t *parse(const char *text)
{
  char *copy = strdup(text);
  json_t *o;

  if (!copy) return NULL;
  for (char *c = copy; *c; c++)
    if (*c == '\'') *c = '"';
  o = json_loads(copy, 0, NULL);
  free(copy);
  return o;
}

static void merge(json_t *o, const char *text)
{
  json_t *more = parse(text);

  json_object_update(o, more);
  json_decref(more);
}

static void put(json_t *o, const char *name, json_t *value)
{
  json_object_set_new(o, name, value);
}

static json_t *number(double v)
{
  return v == rint(v) && fabs(v) < 1e15 ? json_integer((json_int_t)v)
                                        : json_real(v);
}

static json_t *type_of(const char *type, int optional)
{
  if (!optional) return json_string(type);
  return json_pack("[s, s]", type, "null");
}

static void describe_number(json_t *o, const struct vg_param *p)
{
  if (vg_param_is_length(p)) {
    json_t *type = json_pack("[s, s]", "number", "string");

    if (p->optional) json_array_append_new(type, json_string("null"));
    put(o, "type", type);
    put(o, "pattern",
        json_string(p->lo < 0 ? VG_LENGTH_PATTERN("-")
                              : VG_LENGTH_PATTERN("")));
  } else {
    put(o, "type",
        type_of(p->type == VG_PARAM_REAL ? "number" : "integer", p->optional));
  }
  put(o, p->above_lo ? "exclusiveMinimum" : "minimum", number(p->lo));
  put(o, "maximum", number(p->hi));
}

/* @param size  bytes with the terminator */
static void describe_text(json_t *o, size_t size, const char *pattern)
{
  put(o, "type", json_string("string"));
  put(o, "maxLength", json_integer((json_int_t)size - 1));
  put(o, "x-maxBytes", json_integer((json_int_t)size - 1));
  put(o, "pattern", json_string(pattern));
}

static void describe_patch(json_t *o, const struct vg_param *p)
{
  json_t *list = json_array(), *by_number = json_object();
  json_t *by_name = json_object();

  put(by_number, "type", json_string("integer"));
  put(by_number, "minimum", number(p->lo));
  put(by_number, "maximum", number(p->hi));
  describe_text(by_name, VG_NAME_MAX, PATCH_NAME);
  json_array_append_new(list, by_number);
  json_array_append_new(list, by_name);
  if (p->optional)
    json_array_append_new(list, json_pack("{s:s}", "type", "null"));
  put(o, "anyOf", list);
}

static void describe_word(json_t *o, const struct vg_param *p)
{
  json_t *list = json_array();

  for (size_t i = 0; p->words[i]; i++)
    json_array_append_new(list, json_string(p->words[i]));
  put(o, "enum", list);
}

static void describe_type(json_t *o, const struct vg_param *p)
{
  char *pattern;

  switch (p->type) {
  case VG_PARAM_REAL:
  case VG_PARAM_COUNT:
  case VG_PARAM_ID: describe_number(o, p); break;
  case VG_PARAM_PATCH: describe_patch(o, p); break;
  case VG_PARAM_FLAG: put(o, "type", json_string("boolean")); break;
  case VG_PARAM_WORD: describe_word(o, p); break;
  case VG_PARAM_TEXT:
    pattern = p->pattern ? p->pattern() : NULL;
    describe_text(o, p->size, pattern ? pattern : NO_CONTROL);
    free(pattern);
    break;
  }
}

static json_t *describe(const char *table, const struct vg_param *p,
                        json_t *value)
{
  json_t *o = json_object();

  put(o, "description", json_string(p->help));
  describe_type(o, p);
  if (p->required) json_decref(value);
  else put(o, "default", value);
  if (*p->unit) put(o, "x-unit", json_string(p->unit));
  for (size_t i = 0; i < sizeof value_condition / sizeof *value_condition; i++)
    if (!strcmp(p->name, value_condition[i].name) &&
        (table && value_condition[i].table
           ? !strcmp(table, value_condition[i].table)
           : table == value_condition[i].table))
      merge(o, value_condition[i].json);
  return o;
}

/* {"required": [name], "properties": {name: is}} */
static json_t *given(const char *name, const char *is)
{
  return json_pack("{s:[s], s:{s:o}}", "required", name, "properties", name,
                   parse(is));
}

static void add_conditions(json_t *o, const char *object)
{
  json_t *list = json_array();

  for (size_t i = 0; i < sizeof pair_condition / sizeof *pair_condition; i++) {
    json_t *a, *b;

    if (strcmp(object, pair_condition[i].object) != 0) continue;
    a = given(pair_condition[i].first, pair_condition[i].a);
    b = given(pair_condition[i].second, pair_condition[i].b);
    if (pair_condition[i].relation == EXCLUDES)
      b = json_pack("{s:o}", "not", b);
    json_array_append_new(list, json_pack("{s:o, s:o}", "if", a, "then", b));
  }
  for (size_t i = 0; i < sizeof object_condition / sizeof *object_condition;
       i++)
    if (!strcmp(object, object_condition[i].object))
      json_array_append_new(list, parse(object_condition[i].json));
  if (json_array_size(list)) json_object_set(o, "allOf", list);
  json_decref(list);
}

/* An object with these members. values: their defaults. */
static json_t *describe_object(const char *table, const struct vg_param *p,
                               size_t n, json_t *values)
{
  json_t *o = json_object(), *members = json_object();
  json_t *required = json_array();

  for (size_t i = 0; i < n; i++) {
    put(members, p[i].name,
        describe(table, &p[i],
                 json_incref(json_object_get(values, p[i].name))));
    if (p[i].required) json_array_append_new(required, json_string(p[i].name));
  }
  put(o, "type", json_string("object"));
  put(o, "additionalProperties", json_false());
  put(o, "properties", members);
  if (json_array_size(required)) json_object_set(o, "required", required);
  json_decref(required);
  add_conditions(o, table ? table : "settings");
  json_decref(values);
  return o;
}

/* A table as an object if it has one row, else as an array of objects. */
static json_t *describe_table(enum vg_table_kind kind)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  json_t *o = describe_object(t->name, t->column, t->n_column,
                              vg_deck_row_json(kind, NULL));

  if (!vg_table_is_single(kind))
    o = json_pack("{s:s, s:o}", "type", "array", "items", o);
  put(o, "description", json_string(t->help));
  return o;
}

json_t *vg_deck_schema(void)
{
  json_t *o = json_object(), *members = json_object(), *title = json_object();
  json_t *conditions = json_object(), *defaults;
  struct vg_settings s;
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  vg_settings_default(&s);
  defaults = vg_deck_json(&s);
  put(o, "$schema",
      json_string("https://json-schema.org/draft/2020-12/schema"));
  put(o, "title", json_string("Run deck of Vanguard " VG_VERSION));
  put(o, "type", json_string("object"));
  put(o, "additionalProperties", json_false());
  describe_text(title, VG_TITLE_MAX + 1, NO_CONTROL);
  put(title, "description", json_string("Title of the run"));
  put(members, "$schema", json_pack("{s:s}", "type", "string"));
  put(members, "title", title);
  put(members, "settings",
      describe_object(NULL, p, n,
                      json_incref(json_object_get(defaults, "settings"))));
  for (int k = 0; k < VG_TABLE_N; k++)
    put(members, vg_settings_table((enum vg_table_kind)k)->name,
        describe_table((enum vg_table_kind)k));
  put(o, "properties", members);
  add_conditions(o, "");
  for (size_t i = 0; i < sizeof further / sizeof *further; i++)
    put(conditions, further[i][0], json_string(further[i][1]));
  put(o, "x-conditions", conditions);
  json_decref(defaults);
  return o;
}
