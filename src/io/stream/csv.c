/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io/stream/csv.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

/* Cut the next part off a line, without spaces and quotes around it. Returns 0
 * at its end. */
static int next_part(const char **at, const char *end, const char **part,
                     size_t *len)
{
  const char *from = *at, *to;

  if (!from) return 0;
  to = memchr(from, ',', (size_t)(end - from));
  *at = to ? to + 1 : NULL;
  if (!to) to = end;
  while (from < to && strchr(" \t\r", *from)) from++;
  while (to > from && strchr(" \t\r", to[-1])) to--;
  if (to - from > 1 && *from == '"' && to[-1] == '"') from++, to--;
  while (from < to && *from == ' ') from++;
  while (to > from && to[-1] == ' ') to--;
  *part = from;
  *len = (size_t)(to - from);
  return 1;
}

/* The line of names, at the beginning of the file. */
static int first_line(struct vg_input *in, const char **text, size_t *len)
{
  in->at = 0;
  in->line = 1;
  return vg_input_line(in, text, len);
}

void vg_csv_names(struct vg_input *in, char *out, size_t size)
{
  const char *text, *part;
  size_t len, n = 0;

  assert(size > 8);
  *out = 0;
  if (!first_line(in, &text, &len)) return;
  for (const char *at = text, *end = text + len;
       next_part(&at, end, &part, &len);) {
    if (n + len + 6 > size) {
      snprintf(out + n, size - n, "%s...", n ? ", " : "");
      return;
    }
    n += (size_t)snprintf(out + n, size - n, "%s%.*s", n ? ", " : "", (int)len,
                          part);
  }
}

/* Position of the column among all, whose number is *n_column. */
static vg_status find_column(struct vg_input *in, const char *name,
                             size_t *column, size_t *n_column,
                             struct vg_error *err)
{
  const char *text, *part;
  size_t len, n_found = 0;

  *n_column = 0;
  if (!first_line(in, &text, &len))
    return vg_fail(err, VG_ERR_FORMAT, "%s: the file is empty", in->path);
  for (const char *at = text, *end = text + len;
       next_part(&at, end, &part, &len); ++*n_column)
    if (vg_token_is(part, len, name)) {
      *column = *n_column;
      n_found++;
    }
  if (n_found == 1) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT, "%s: there %s named '%s'", in->path,
                 n_found ? "are several columns" : "is no column", name);
}

static vg_status read_line(struct vg_input *in, const char *text, size_t len,
                           const char *name, size_t column, size_t n_column,
                           double *value, struct vg_error *err)
{
  const char *part, *at = text, *end = text + len;
  size_t n = 0;

  for (; next_part(&at, end, &part, &len); n++)
    if (n == column && !vg_parse_real(part, len, value))
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s, line %zu: '%.*s' in column '%s' is not a number",
                     in->path, in->line - 1, len > 40 ? 40 : (int)len, part,
                     name);
  if (n == n_column) return VG_OK;
  return vg_fail(err, VG_ERR_FORMAT,
                 "%s, line %zu: %zu columns, but the first line names %zu",
                 in->path, in->line - 1, n, n_column);
}

static int is_blank(const char *text, size_t len)
{
  while (len && strchr(" \t\r", *text)) text++, len--;
  return !len;
}

vg_status vg_csv_column(struct vg_input *in, const char *name, size_t *n,
                        double **value, struct vg_error *err)
{
  double *own = NULL;
  size_t room = 0, got = 0, column = 0, n_column, len;
  const char *text;
  vg_status st;

  assert(in && name && n && value);
  VG_TRY(find_column(in, name, &column, &n_column, err));
  while (vg_input_line(in, &text, &len)) {
    if (is_blank(text, len)) continue;
    if (vg_reserve(&own, &room, got + 1, sizeof *own)) {
      st = vg_fail_memory(err, "a column of a table");
      goto done;
    }
    VG_TRY(read_line(in, text, len, name, column, n_column, &own[got++], err));
  }
  if (!got) {
    st = vg_fail(err, VG_ERR_FORMAT, "%s: no line of numbers", in->path);
    goto done;
  }
  *n = got;
  *value = own;
  own = NULL;
done:
  free(own);
  return st;
}

void vg_csv_put(struct vg_output *out, const char *text)
{
  char one[2] = { 0, 0 };

  vg_output_text(out, "\"");
  for (; *text; text++) {
    one[0] = *text;
    vg_output_text(out, *text == '"' ? "\"\"" : one);
  }
  vg_output_text(out, "\"");
}
