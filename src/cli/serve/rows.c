/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/serve/rows.h"

#include <stdlib.h>
#include <string.h>

#include "cli/serve/page_markup.h"

#define VALUE_SIZE (2 * VG_LIST_MAX + 4)
#define MOST_COLUMNS 64

/* --- reading ------------------------------------------------------------- */

struct words {
  size_t n;
  const char *word[MOST_COLUMNS];
};

/* Read one value and terminate it in place; *is_quoted: it was in quotes.
 * NULL: a quotation mark is not closed. */
static char *take_word(char **at, int *is_quoted)
{
  char *p = *at, *to, *word;

  *is_quoted = *p == '"';
  word = to = p += *is_quoted;
  for (;; p++) {
    if (!*p) {
      if (*is_quoted) return NULL;
      break;
    }
    if (*is_quoted && *p == '"') {
      if (p[1] != '"') {
        p++;
        break;
      }
      p++;
    } else if (!*is_quoted && strchr(" \t#", *p)) {
      if (*p == '#') *p = 0;
      else p++;
      break;
    }
    *to++ = *p;
  }
  *at = p;
  *to = 0;
  return word;
}

/* Split a line into values; an unquoted "-" becomes NULL. Returns an error
 * message or NULL. */
static const char *split(char *line, struct words *w)
{
  int is_quoted;

  for (w->n = 0;; w->n++) {
    char *word;

    line += strspn(line, " \t");
    if (!*line || *line == '#') return NULL;
    if (w->n == MOST_COLUMNS) return "more than 64 values";
    word = take_word(&line, &is_quoted);
    if (!word) return "a quotation mark is not closed; add \"";
    w->word[w->n] = !is_quoted && !strcmp(word, "-") ? NULL : word;
  }
}

static vg_status add_row(const char *table, const struct words *names,
                         const struct words *values, struct vg_settings *s,
                         struct vg_error *err)
{
  const char *name[MOST_COLUMNS], *value[MOST_COLUMNS];
  size_t n = 0;

  if (values->n != names->n)
    return vg_fail(err, VG_ERR_INPUT, "%zu values for %zu columns", values->n,
                   names->n);
  for (size_t i = 0; i < names->n; i++) {
    if (!names->word[i])
      return vg_fail(err, VG_ERR_INPUT, "'-' is not a column name");
    for (size_t j = 0; j < i; j++)
      if (!strcmp(names->word[i], names->word[j]))
        return vg_fail(err, VG_ERR_INPUT, "column %.40s appears twice",
                       names->word[i]);
    if (!values->word[i]) continue;
    name[n] = names->word[i];
    value[n++] = values->word[i];
  }
  return vg_settings_add_named(s, table, n, name, value, err);
}

/* Process a line: the first one contains the names, all others values. */
static vg_status take_line(char *line, const char *table, struct words *names,
                           struct vg_settings *s, struct vg_error *err)
{
  int is_head = !names->n;
  struct words values;
  const char *bad;

  line[strcspn(line, "\r")] = 0;
  bad = split(line, is_head ? names : &values);
  if (bad) return vg_fail(err, VG_ERR_INPUT, "%s", bad);
  return is_head || !values.n ? VG_OK : add_row(table, names, &values, s, err);
}

vg_status vg_rows_read(const char *text, enum vg_table_kind kind,
                       struct vg_settings *s, struct vg_error *err)
{
  const char *table = vg_settings_table(kind)->name;
  char *copy = strdup(text), *line = copy;
  struct words names = { 0, { NULL } };
  struct vg_error why = VG_ERROR_INIT;
  vg_status st = copy ? VG_OK : vg_fail_memory(err, "a form");

  for (size_t number = 1; line && st >= 0; number++) {
    char *end = strchr(line, '\n');

    if (end) *end = 0;
    st = take_line(line, table, &names, s, &why);
    if (st < 0)
      vg_fail(err, why.code, "%s, line %zu: %.900s", table, number, why.text);
    line = end ? end + 1 : NULL;
  }
  free(copy);
  return st;
}

/* --- printing ------------------------------------------------------------ */

union row {
  struct vg_patch_row p;
  struct vg_layer_row l;
  struct vg_surface_row f;
  struct vg_wake_row k;
  struct vg_zone_row z;
  struct vg_periodic_row o;
  struct vg_source s;
};

/* Width of a column; 0: all its values are defaults. */
static size_t width_of(const struct vg_settings *s, enum vg_table_kind kind,
                       const struct vg_param *p, const void *defaults)
{
  char value[VALUE_SIZE], otherwise[VALUE_SIZE];
  size_t width = strlen(p->name), n = vg_settings_rows(s, kind);
  int used = p->required;

  vg_param_format(p, defaults, otherwise, sizeof otherwise);
  for (size_t i = 0; i < n; i++) {
    vg_param_format(p, vg_settings_row(s, kind, i), value, sizeof value);
    used |= strcmp(value, otherwise) != 0;
    if (strlen(value) > width) width = strlen(value);
  }
  return used ? width : 0;
}

void vg_rows_print(FILE *to, const struct vg_settings *s,
                   enum vg_table_kind kind)
{
  const struct vg_setting_table *t = vg_settings_table(kind);
  union row defaults;
  char value[VALUE_SIZE];
  size_t width[MOST_COLUMNS], n = vg_settings_rows(s, kind);

  if (!n) return;
  vg_settings_row_default(kind, &defaults);
  for (size_t c = 0; c < t->n_column; c++)
    width[c] = width_of(s, kind, &t->column[c], &defaults);
  for (size_t i = 0; i <= n; i++) {
    for (size_t c = 0; c < t->n_column; c++) {
      const char *text = t->column[c].name;

      if (!width[c]) continue;
      if (i) {
        vg_param_format(&t->column[c], vg_settings_row(s, kind, i - 1), value,
                        sizeof value);
        text = value;
      }
      vg_markup(to, text);
      fprintf(to, "%*s", (int)(width[c] + 2 - strlen(text)), "");
    }
    fputs("\n", to);
  }
}
