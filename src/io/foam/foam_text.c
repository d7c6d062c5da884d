/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "io/foam/foam_text.h"

#include <assert.h>
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/memory.h"

void vg_foam_text_release(struct vg_foam_text *f)
{
  vg_input_release(&f->in);
  *f = (struct vg_foam_text)VG_FOAM_TEXT_INIT;
}

/* --- tokens --------------------------------------------------------------- */

static int at(const struct vg_input *in, size_t i)
{
  return in->at + i < in->size ? in->data[in->at + i] : -1;
}

static void step(struct vg_input *in)
{
  in->line += in->data[in->at] == '\n';
  in->at++;
}

/* Pass a comment. Returns 0 if the cursor is not at one. */
static int skip_comment(struct vg_input *in)
{
  if (at(in, 0) != '/' || (at(in, 1) != '/' && at(in, 1) != '*')) return 0;
  if (at(in, 1) == '/') {
    while (at(in, 0) >= 0 && at(in, 0) != '\n') step(in);
    return 1;
  }
  step(in);
  step(in);
  while (at(in, 0) >= 0 && !(at(in, 0) == '*' && at(in, 1) == '/')) step(in);
  for (int i = 0; i < 2 && at(in, 0) >= 0; i++) step(in);
  return 1;
}

static int is_mark(int c)
{
  return c > 0 && strchr("(){}[];", c) != NULL;
}

int vg_foam_token(struct vg_foam_text *f, const char **text, size_t *len)
{
  struct vg_input *in = &f->in;
  size_t from;
  int c;

  while ((c = at(in, 0)) >= 0 && (isspace(c) || skip_comment(in)))
    if (isspace(c)) step(in);
  if (c < 0) return 0;
  from = in->at;
  *text = (const char *)in->data + from;
  step(in);
  if (c == '"') {
    while ((c = at(in, 0)) >= 0 && c != '"') step(in);
    if (c == '"') step(in);
  } else if (!is_mark(c)) {
    while ((c = at(in, 0)) >= 0 && !isspace(c) && !is_mark(c) && c != '"')
      step(in);
  }
  *len = in->at - from;
  return 1;
}

static int short_len(size_t len)
{
  return len < 60 ? (int)len : 60;
}

vg_status vg_foam_expect(struct vg_foam_text *f, const char *s,
                         const char *what, struct vg_error *err)
{
  const char *text;
  size_t len;

  if (!vg_foam_token(f, &text, &len))
    return vg_input_fail(&f->in, err, "the file ends before '%s' of %s", s,
                         what);
  if (vg_token_is(text, len, s)) return VG_OK;
  return vg_input_fail(&f->in, err, "'%.*s' instead of '%s' in %s",
                       short_len(len), text, s, what);
}

vg_status vg_foam_skip_value(struct vg_foam_text *f, struct vg_error *err)
{
  const char *text;
  size_t len;
  int depth = 0;

  while (vg_foam_token(f, &text, &len)) {
    if (*text == '(' || *text == '{' || *text == '[') depth++;
    if (*text == ')' || *text == '}' || *text == ']') depth--;
    if (depth < 0) break;
    if (!depth && (*text == ';' || *text == '}')) return VG_OK;
  }
  return vg_input_fail(&f->in, err, "an entry without an end");
}

/* --- header --------------------------------------------------------------- */

/* Sizes in bytes from "LSB;label=32;scalar=64". */
static vg_status set_arch(struct vg_foam_text *f, const char *text, size_t len,
                          struct vg_error *err)
{
  char arch[128];
  const char *label, *scalar;

  snprintf(arch, sizeof arch, "%.*s", (int)(len < 120 ? len : 120), text);
  label = strstr(arch, "label=");
  scalar = strstr(arch, "scalar=");
  vg_input_order(&f->in, strstr(arch, "MSB") != NULL);
  if (label) f->label_size = atoi(label + 6) / 8;
  if (scalar) f->scalar_size = atoi(scalar + 7) / 8;
  if ((f->label_size == 4 || f->label_size == 8) &&
      (f->scalar_size == 4 || f->scalar_size == 8))
    return VG_OK;
  return vg_input_fail(&f->in, err,
                       "arch %s: labels and scalars have 32 or 64 bits", arch);
}

vg_status vg_foam_text_head(struct vg_foam_text *f, struct vg_error *err)
{
  const char *key, *text;
  size_t n, len;
  vg_status st;

  f->label_size = 4;
  f->scalar_size = 8;
  vg_input_order(&f->in, 0);
  VG_TRY(vg_foam_expect(f, "FoamFile", "the header of an OpenFOAM file", err));
  VG_TRY(vg_foam_expect(f, "{", "the header", err));
  while (vg_foam_token(f, &key, &n) && *key != '}') {
    size_t back = f->in.at, line = f->in.line;

    if (!vg_foam_token(f, &text, &len)) break;
    if (vg_token_is(key, n, "format"))
      f->is_binary = vg_token_is(text, len, "binary");
    if (vg_token_is(key, n, "class"))
      snprintf(f->class_name, sizeof f->class_name, "%.*s", short_len(len),
               text);
    if (vg_token_is(key, n, "arch")) VG_TRY(set_arch(f, text, len, err));
    f->in.at = back;
    f->in.line = line;
    VG_TRY(vg_foam_skip_value(f, err));
  }
  st = *f->class_name ? VG_OK
                      : vg_input_fail(&f->in, err, "a header without a class");
done:
  return st;
}

char *vg_foam_find_file(const char *folder, const char *name, int *has)
{
  char *path, *packed;
  int exists;

  if (asprintf(&path, "%s/%s", folder, name) < 0) return NULL;
  if (asprintf(&packed, "%s.gz", path) < 0) {
    free(path);
    return NULL;
  }
  exists = !access(path, F_OK);
  if (!exists && !access(packed, F_OK)) {
    char *plain = path;

    path = packed;
    packed = plain;
    exists = 1;
  }
  free(packed);
  if (has) *has = exists;
  return path;
}

vg_status vg_foam_text_open(const char *folder, const char *name,
                            struct vg_foam_text *f, struct vg_error *err)
{
  char *path = vg_foam_find_file(folder, name, NULL);
  vg_status st;

  if (!path) return vg_fail_memory(err, "a file name");
  st = vg_input_open(path, &f->in, err);
  free(path);
  return st < 0 ? st : vg_foam_text_head(f, err);
}

/* --- lists ---------------------------------------------------------------- */

/* Is this mark the next token? */
static int is_next(struct vg_foam_text *f, char mark)
{
  const size_t back = f->in.at, line = f->in.line;
  const char *text;
  size_t len;
  int is = vg_foam_token(f, &text, &len) && *text == mark;

  f->in.at = back;
  f->in.line = line;
  return is;
}

/* Number of items and the mark that follows it: ( for items, { for one value of
 * them all, 0 for none, as in empty binary lists. Each item takes at least
 * `least` bytes between parentheses. */
static vg_status open_list(struct vg_foam_text *f, const char *what,
                           size_t least, size_t most, size_t *n, int *mark,
                           struct vg_error *err)
{
  const char *text;
  size_t len;
  int64_t count;

  if (!vg_foam_token(f, &text, &len) || !vg_parse_int(text, len, &count) ||
      count < 0)
    return vg_input_fail(&f->in, err, "no number of %s", what);
  *n = (size_t)count;
  if ((uint64_t)count > most)
    return vg_input_fail(&f->in, err, "%zu %s, but at most %zu are expected",
                         *n, what, most);
  if (!count && !is_next(f, '(') && !is_next(f, '{')) {
    *mark = 0;
    return VG_OK;
  }
  if (!vg_foam_token(f, &text, &len) || (*text != '(' && *text != '{'))
    return vg_input_fail(&f->in, err, "no parenthesis before %s", what);
  *mark = *text;
  return *mark == '{' ? VG_OK : vg_input_need(&f->in, *n, least, what, err);
}

static vg_status close_list(struct vg_foam_text *f, const char *what, int mark,
                            struct vg_error *err)
{
  if (!mark) return VG_OK;
  return vg_foam_expect(f, mark == '{' ? "}" : ")", what, err);
}

static vg_status one_real(struct vg_foam_text *f, const char *what, double *v,
                          struct vg_error *err)
{
  const char *text;
  size_t len;

  if (vg_foam_token(f, &text, &len) && vg_parse_real(text, len, v))
    return VG_OK;
  return vg_input_fail(&f->in, err, "not a finite number in %s", what);
}

vg_status vg_foam_item(struct vg_foam_text *f, const char *what, int width,
                       double *v, struct vg_error *err)
{
  vg_status st = VG_OK;

  if (width > 1) VG_TRY(vg_foam_expect(f, "(", what, err));
  for (int k = 0; k < width; k++) VG_TRY(one_real(f, what, v + k, err));
  if (width > 1) VG_TRY(vg_foam_expect(f, ")", what, err));
done:
  return st;
}

static vg_status one_label(struct vg_foam_text *f, const char *what, int64_t *v,
                           struct vg_error *err)
{
  const char *text;
  size_t len;

  if (vg_foam_token(f, &text, &len) && vg_parse_int(text, len, v)) return VG_OK;
  return vg_input_fail(&f->in, err, "not a label in %s", what);
}

static vg_status binary_labels(struct vg_foam_text *f, const char *what,
                               size_t n, int64_t *v, struct vg_error *err)
{
  int32_t *narrow;
  vg_status st;

  if (f->label_size == 8) return vg_input_i64(&f->in, n, v, what, err);
  narrow = vg_alloc(n, sizeof *narrow);
  if (!narrow) return vg_fail_memory(err, what);
  st = vg_input_i32(&f->in, n, narrow, what, err);
  for (size_t i = 0; i < n && st >= 0; i++) v[i] = narrow[i];
  free(narrow);
  return st;
}

vg_status vg_foam_labels(struct vg_foam_text *f, const char *what, size_t most,
                         size_t *n, int64_t **v, struct vg_error *err)
{
  const size_t least = f->is_binary ? (size_t)f->label_size : 1;
  int mark;
  vg_status st;

  *v = NULL;
  VG_TRY(open_list(f, what, least, most, n, &mark, err));
  if (!(*v = vg_alloc(*n, sizeof **v))) return vg_fail_memory(err, what);
  if (mark == '{') {
    int64_t all;

    VG_TRY(one_label(f, what, &all, err));
    for (size_t i = 0; i < *n; i++) (*v)[i] = all;
  } else if (f->is_binary) {
    VG_TRY(binary_labels(f, what, *n, *v, err));
  } else {
    for (size_t i = 0; i < *n; i++) VG_TRY(one_label(f, what, *v + i, err));
  }
  st = close_list(f, what, mark, err);
done:
  if (st < 0) {
    free(*v);
    *v = NULL;
  }
  return st;
}

vg_status vg_foam_reals(struct vg_foam_text *f, const char *what, int width,
                        size_t most, size_t *n, double **v,
                        struct vg_error *err)
{
  const size_t w = (size_t)width;
  const size_t least = f->is_binary ? w * (size_t)f->scalar_size : 2 * w - 1;
  int mark;
  vg_status st;

  assert(width >= 1);
  *v = NULL;
  VG_TRY(open_list(f, what, least, most, n, &mark, err));
  if (!(*v = vg_alloc(*n, w * sizeof **v))) return vg_fail_memory(err, what);
  if (mark == '{') {
    double all[9];

    assert(width <= 9);
    VG_TRY(vg_foam_item(f, what, width, all, err));
    for (size_t i = 0; i < *n * w; i++) (*v)[i] = all[i % w];
  } else if (f->is_binary) {
    VG_TRY(f->scalar_size == 8 ? vg_input_f64(&f->in, *n * w, *v, what, err)
                               : vg_input_f32(&f->in, *n * w, *v, what, err));
  } else {
    for (size_t i = 0; i < *n; i++)
      VG_TRY(vg_foam_item(f, what, width, *v + i * w, err));
  }
  st = close_list(f, what, mark, err);
done:
  if (st < 0) {
    free(*v);
    *v = NULL;
  }
  return st;
}
