/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reader of the run deck: a state machine over lines. Declared in
 * run/settings/deck.h; grammar in docs/reference/deck.md. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/stream/stream.h"
#include "run/settings/deck.h"
#include "run/settings/deck_json.h"
#include "run/settings/names.h"

#define MAX_TOKENS 64 /* more than any table has columns */
#define TOKEN_SIZE 512

struct token {
  char text[TOKEN_SIZE];
  size_t len;
  int quoted;
};

struct reader {
  struct vg_input in;
  size_t line; /* line number of the tokens */
  struct token token[MAX_TOKENS];
  size_t n_token;
  const struct vg_param *name[MAX_TOKENS];
  size_t n_name;
  size_t *set_at;              /* line on which parameter i was set, or 0 */
  size_t table_at[VG_TABLE_N]; /* line on which the table began, or 0 */
  struct vg_settings s;
};

static vg_status fail(const struct reader *r, struct vg_error *err,
                      vg_status code, const char *text)
{
  return vg_fail(err, code, "%s:%zu: %s", r->in.path, r->line, text);
}

/* Prefix the message about a value with file and line. */
static vg_status place(const struct reader *r, struct vg_error *err)
{
  struct vg_error inner;

  if (!err) return VG_ERR_INPUT;
  inner = *err;
  return vg_fail(err, inner.code, "%s:%zu: %.*s", r->in.path, r->line,
                 (int)(sizeof inner.text / 2), inner.text);
}

/* Read one token from *text, at most up to `end`; "" inside quotes is a ". */
static vg_status scan_token(struct reader *r, const char **text,
                            const char *end, struct vg_error *err)
{
  struct token *t = &r->token[r->n_token];
  const char *p = *text;

  t->len = 0;
  t->quoted = *p == '"';
  if (t->quoted) p++;
  for (;; p++) {
    if (p == end) {
      if (t->quoted)
        return fail(r, err, VG_ERR_FORMAT,
                    "a quotation mark is not closed on this "
                    "line; add \"");
      break;
    }
    if (t->quoted && *p == '"') {
      if (p + 1 == end || p[1] != '"') {
        p++;
        break;
      }
      p++;
    } else if (!t->quoted && (*p == ' ' || *p == '\t' || *p == '#')) {
      break;
    }
    if (t->len + 1 >= sizeof t->text)
      return fail(r, err, VG_ERR_FORMAT, "a word of more than 500 characters");
    t->text[t->len++] = *p;
  }
  t->text[t->len] = 0;
  if (memchr(t->text, 0, t->len))
    return fail(r, err, VG_ERR_FORMAT, "a zero byte: this is not a text file");
  *text = p;
  r->n_token++;
  return VG_OK;
}

/* Split the next line into tokens. *state: 0 end of file, 1 blank line, 2
 * comment only, 3 tokens. */
static vg_status next_line(struct reader *r, int *state, struct vg_error *err)
{
  const char *text, *end;
  size_t len;
  vg_status st;

  r->n_token = 0;
  r->line = r->in.line;
  *state = 0;
  if (!vg_input_line(&r->in, &text, &len)) return VG_OK;
  *state = 1;
  for (end = text + len; text < end;) {
    if (*text == ' ' || *text == '\t') {
      text++;
      continue;
    }
    if (*text == '#') {
      *state = r->n_token ? 3 : 2;
      return VG_OK;
    }
    if (r->n_token == MAX_TOKENS)
      return fail(r, err, VG_ERR_FORMAT, "more than 64 words on a line");
    st = scan_token(r, &text, end, err);
    if (st < 0) return st;
    *state = 3;
  }
  return VG_OK;
}

static const char *param_name(const void *user, size_t i)
{
  return ((const struct vg_param *)user)[i].name;
}

static const struct vg_param *find_param(const struct vg_param *p, size_t n,
                                         const char *name)
{
  for (size_t i = 0; i < n; i++)
    if (strcmp(p[i].name, name) == 0) return &p[i];
  return NULL;
}

static int find_table(const char *name)
{
  for (int t = 0; t < VG_TABLE_N; t++)
    if (strcmp(vg_settings_table((enum vg_table_kind)t)->name, name) == 0)
      return t;
  return -1;
}

/* Names that may begin a block: tables, then settings. */
static const char *any_name(const void *user, size_t i)
{
  const char *name = "";
  int in_farfield;

  (void)user;
  if (i < VG_TABLE_N) return vg_settings_table((enum vg_table_kind)i)->name;
  vg_settings_name(i - VG_TABLE_N, &name, &in_farfield);
  return name;
}

/* A column of the table `farfield` that is given like a setting. `near` is as
 * vg_suggest_place leaves it. Returns out, or NULL for another name. */
static const char *farfield_hint(const struct vg_suggestion *near,
                                 char out[VG_HINT_SIZE])
{
  const char *dot = near->n ? strchr(near->name[0], '.') : NULL;

  if (!dot || strcmp(dot, ".kind") == 0) return NULL;
  snprintf(out, VG_HINT_SIZE,
           "did you mean the column %s of the table farfield? It needs kind, "
           "too: a line 'farfield', a line 'kind %s' and a line of values",
           dot + 1, dot + 1);
  return out;
}

/* Suggest a column of the table or, outside tables, a setting or a table. */
static vg_status unknown_name(const struct reader *r, const char *name,
                              const struct vg_setting_table *table,
                              struct vg_error *err)
{
  struct vg_names names = { VG_TABLE_N, any_name, NULL };
  struct vg_suggestion near;
  char hint[VG_HINT_SIZE];
  const char *text, *remedy = NULL;
  int in_farfield;

  while (vg_settings_name(names.n - VG_TABLE_N, &text, &in_farfield)) names.n++;
  if (table)
    names = (struct vg_names){ table->n_column, param_name, table->column };
  vg_suggest(name, &names, &near);
  if (!table) {
    vg_suggest_place(&near);
    remedy = farfield_hint(&near, hint);
  }
  if (!remedy)
    remedy = vg_hint(&near, "", "'vanguard deck' writes a deck with all names",
                     hint);
  return vg_fail(err, VG_ERR_FORMAT, "%s:%zu: unknown name '%s' in %s; %s",
                 r->in.path, r->line, name, table ? table->name : "this deck",
                 remedy);
}

/* Look up the tokens as names in p[n]; table NULL: the parameters. */
static vg_status take_names(struct reader *r, const struct vg_param *p,
                            size_t n, const struct vg_setting_table *table,
                            struct vg_error *err)
{
  r->n_name = 0;
  for (size_t i = 0; i < r->n_token; i++) {
    const char *text = r->token[i].text;
    const struct vg_param *found = find_param(p, n, text);
    double number;

    if (!found && vg_parse_real(text, r->token[i].len, &number))
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s:%zu: expected a name, found the number '%s'; "
                     "values need a line of names above them",
                     r->in.path, r->line, text);
    if (!found) return unknown_name(r, text, table, err);
    for (size_t j = 0; j < r->n_name; j++)
      if (r->name[j] == found)
        return vg_fail(err, VG_ERR_FORMAT,
                       "%s:%zu: '%s' appears twice on "
                       "this line",
                       r->in.path, r->line, text);
    r->name[r->n_name++] = found;
  }
  return VG_OK;
}

/* Store the tokens as values of r->name in the struct at base. */
static vg_status take_values(struct reader *r, void *base, struct vg_error *err)
{
  if (r->n_token != r->n_name)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s:%zu: %zu values for %zu names; "
                   "quote values with blanks and write - for a "
                   "default",
                   r->in.path, r->line, r->n_token, r->n_name);
  for (size_t i = 0; i < r->n_token; i++) {
    const struct token *t = &r->token[i];

    if (!t->quoted && strcmp(t->text, "-") == 0 && !r->name[i]->required)
      continue;
    if (vg_param_set(r->name[i], base, t->text, t->len, err) < 0)
      return err ? place(r, err) : VG_ERR_INPUT;
  }
  return VG_OK;
}

/* A line of names has been read: the next line that is neither blank nor a
 * comment contains the values. */
static vg_status parameters(struct reader *r, struct vg_error *err)
{
  size_t n, names_at = r->line;
  const struct vg_param *p = vg_settings_params(&n);
  vg_status st = take_names(r, p, n, NULL, err);
  int state;

  if (st < 0) return st;
  for (size_t i = 0; i < r->n_name; i++) {
    size_t *at = &r->set_at[r->name[i] - p];

    if (*at)
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s:%zu: '%s' was already set on line "
                     "%zu; remove one of the two",
                     r->in.path, r->line, r->name[i]->name, *at);
    *at = r->line;
  }
  do {
    st = next_line(r, &state, err);
    if (st < 0) return st;
  } while (state == 1 || state == 2);
  if (!state)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s:%zu: the line of names has no line of "
                   "values below it",
                   r->in.path, names_at);
  return take_values(r, &r->s, err);
}

/* `layers` is both a setting and a table. Alone on a line it is the setting if
 * the line below is a valid value of it rather than column names. */
static int is_setting(struct reader *r, const struct vg_setting_table *table)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);
  struct vg_settings scratch;

  p = find_param(p, n, table->name);
  if (!p || r->n_token != 1) return 0;
  vg_settings_default(&scratch);
  return vg_param_set(p, &scratch, r->token[0].text, r->token[0].len, NULL) >=
         0;
}

static vg_status set_alone(struct reader *r,
                           const struct vg_setting_table *table,
                           struct vg_error *err)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);
  size_t *at;

  r->name[0] = find_param(p, n, table->name);
  r->n_name = 1;
  at = &r->set_at[r->name[0] - p];
  if (*at)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s:%zu: '%s' was already set on line "
                   "%zu; remove one of the two",
                   r->in.path, r->line, table->name, *at);
  *at = r->line;
  return take_values(r, &r->s, err);
}

/* Read the column names. *is_value: it was a setting, not a table; see
 * is_setting. */
static vg_status table_head(struct reader *r,
                            const struct vg_setting_table *table, int *is_value,
                            struct vg_error *err)
{
  int state;
  vg_status st;

  do {
    st = next_line(r, &state, err);
    if (st < 0) return st;
  } while (state == 2);
  *is_value = state == 3 && is_setting(r, table);
  if (*is_value) return set_alone(r, table, err);
  if (state != 3)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s:%zu: table '%s' needs a line of "
                   "column names directly below",
                   r->in.path, r->line, table->name);
  st = take_names(r, table->column, table->n_column, table, err);
  if (st < 0) return st;
  for (size_t c = 0; c < table->n_column; c++) {
    int found = !table->column[c].required;

    for (size_t i = 0; i < r->n_name; i++)
      found |= r->name[i] == &table->column[c];
    if (!found)
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s:%zu: table '%s' needs a column "
                     "'%s'",
                     r->in.path, r->line, table->name, table->column[c].name);
  }
  return VG_OK;
}

static vg_status table_rows(struct reader *r, enum vg_table_kind kind,
                            struct vg_error *err)
{
  union {
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
  } row;
  size_t n_row = 0;
  int state;
  vg_status st;

  for (;;) {
    st = next_line(r, &state, err);
    if (st < 0 || state < 2) return st;
    if (state == 2) continue;
    if (vg_table_is_single(kind) && n_row++)
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s:%zu: the table '%s' takes only one line of "
                     "values",
                     r->in.path, r->line, vg_settings_table(kind)->name);
    vg_settings_row_default(kind, &row);
    st = take_values(r, &row, err);
    if (st < 0) return st;
    st = vg_settings_add(&r->s, kind, &row, err);
    if (st < 0) return st;
  }
}

static vg_status table(struct reader *r, enum vg_table_kind kind,
                       struct vg_error *err)
{
  size_t line_before = r->table_at[kind];
  int is_value;
  vg_status st;

  if (r->n_token > 1)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s:%zu: '%s' begins a table and must be "
                   "alone on its line; column names go on the next line",
                   r->in.path, r->line, r->token[0].text);
  r->table_at[kind] = r->line;
  st = table_head(r, vg_settings_table(kind), &is_value, err);
  if (st < 0) return st;
  if (is_value) {
    r->table_at[kind] = line_before;
    return st;
  }
  if (line_before)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s:%zu: table '%s' was already given "
                   "on line %zu; merge the two",
                   r->in.path, r->table_at[kind], vg_settings_table(kind)->name,
                   line_before);
  return table_rows(r, kind, err);
}

/* A first line that consists of names only: the title was forgotten. */
static int looks_like_names(const struct reader *r)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  for (size_t i = 0; i < r->n_token; i++)
    if (!find_param(p, n, r->token[i].text) && find_table(r->token[i].text) < 0)
      return 0;
  return 1;
}

/* The title is the first line that is neither blank nor a comment, taken
 * literally (a '#' in it does not start a comment). */
static vg_status title(struct reader *r, struct vg_error *err)
{
  const char *text = "", *end;
  size_t len = 0;

  for (;;) {
    r->line = r->in.line;
    if (!vg_input_line(&r->in, &text, &len))
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: no title line; the first line "
                     "of a deck is its title",
                     r->in.path);
    end = text + len;
    while (text < end && (*text == ' ' || *text == '\t')) text++;
    while (text < end && (end[-1] == ' ' || end[-1] == '\t')) end--;
    if (text < end && *text != '#') break;
  }
  len = (size_t)(end - text);
  if (len > VG_TITLE_MAX)
    return fail(r, err, VG_ERR_FORMAT,
                "the title has more than 80 "
                "characters; shorten it");
  for (size_t i = 0; i < len; i++)
    if ((unsigned char)text[i] < ' ' || text[i] == 127)
      return fail(r, err, VG_ERR_FORMAT,
                  "the title contains a control "
                  "character; is this a text file?");
  memset(r->s.title, 0, sizeof r->s.title);
  memcpy(r->s.title, text, len);
  r->n_token = 0;
  while (text < end && r->n_token < MAX_TOKENS) {
    if (*text == ' ' || *text == '\t' || *text == '#' || *text == '"') {
      text++;
      continue;
    }
    if (scan_token(r, &text, end, err) < 0) return VG_ERR_FORMAT;
  }
  if (looks_like_names(r))
    return fail(r, err, VG_ERR_FORMAT,
                "this line consists of names, but the first "
                "line of a deck is its title; add a title above it");
  return VG_OK;
}

/* The line begins a table: its first word is the name of a table, and not that
 * of a setting followed by other names. */
static int begins_table(const struct reader *r)
{
  size_t n;
  const struct vg_param *p = vg_settings_params(&n);

  return find_table(r->token[0].text) >= 0 &&
         (r->n_token == 1 || !find_param(p, n, r->token[0].text));
}

static vg_status blocks(struct reader *r, struct vg_error *err)
{
  int state;
  vg_status st;

  for (;;) {
    st = next_line(r, &state, err);
    if (st < 0 || state == 0) return st;
    if (state < 3) continue;
    if (begins_table(r))
      st = table(r, (enum vg_table_kind)find_table(r->token[0].text), err);
    else st = parameters(r, err);
    if (st < 0) return st;
  }
}

static vg_status parse(struct reader *r, struct vg_settings *s,
                       struct vg_error *err)
{
  size_t n;
  vg_status st;

  vg_settings_params(&n);
  vg_settings_default(&r->s);
  r->set_at = vg_calloc(n, sizeof *r->set_at);
  if (!r->set_at) return vg_fail_memory(err, "a deck");
  VG_TRY(title(r, err));
  VG_TRY(blocks(r, err));
  st = vg_settings_check(&r->s, err);
  if (st < 0) {
    struct vg_error inner;

    if (!err) goto done;
    inner = *err;
    vg_fail(err, st, "%s: %.*s", r->in.path, (int)(sizeof inner.text / 2),
            inner.text);
    goto done;
  }
  vg_settings_release(s);
  *s = r->s;
  memset(&r->s, 0, sizeof r->s);
done:
  vg_settings_release(&r->s);
  free(r->set_at);
  return st;
}

/* A deck whose first character is '{' is a JSON document, and so is one that
 * consists of an array, which is not a deck. The title of a text may begin with
 * '['. */
static int is_json(const struct vg_input *in)
{
  size_t at = 0;

  while (at < in->size && strchr(" \t\r\n", in->data[at])) at++;
  if (at == in->size || !strchr("{[", in->data[at])) return 0;
  return in->data[at] == '{' || vg_deck_is_json(in->data, in->size);
}

static vg_status run(struct vg_input *in, struct vg_settings *s,
                     struct vg_error *err)
{
  struct reader *r;
  vg_status st;

  if (is_json(in)) {
    st = vg_deck_json_parse(in->path, in->data, in->size, s, err);
    vg_input_release(in);
    return st;
  }
  r = vg_calloc(1, sizeof *r);
  if (!r) {
    vg_input_release(in);
    return vg_fail_memory(err, "a deck");
  }
  r->in = *in;
  st = parse(r, s, err);
  vg_input_release(&r->in);
  free(r);
  return st;
}

vg_status vg_deck_parse(const char *name, const void *data, size_t size,
                        struct vg_settings *s, struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_memory(name, data, size, &in, err);

  assert(name && (data || !size) && s);
  return st < 0 ? st : run(&in, s, err);
}

vg_status vg_deck_read(const char *path, struct vg_settings *s,
                       struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st = vg_input_open(path, &in, err);

  return st < 0 ? st : run(&in, s, err);
}
