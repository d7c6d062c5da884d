/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/plot/timeline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/stream/stream.h"
#include "run/common/json_build.h"
#include "run/common/text.h"

#define SECONDS_MAX 1e9
#define WORK_MAX 1e300
#define ROUNDED 2e-6 /* tolerance for times, which are rounded to 1e-6 s */
#define COUNT_MAX ((json_int_t)1 << 53) /* integers exact in a double */

enum column {
  COLUMN_PATH,
  COLUMN_AFTER,
  COLUMN_KIND,
  COLUMN_RANK,
  COLUMN_THREAD,
  COLUMN_HOME,
  COLUMN_START,
  COLUMN_END,
  COLUMN_CPU,
  COLUMN_ESTIMATE,
  COLUMN_CELLS,
  COLUMN_BYTES_IN,
  COLUMN_BYTES_OUT,
  COLUMN_LOOPS,
  COLUMN_FACES,
  COLUMN_WORK,
  COLUMN_N
};

enum help_column {
  HELP_PATH,
  HELP_RANK,
  HELP_THREAD,
  HELP_START,
  HELP_END,
  HELP_N
};

/* Keys of a list of rows and of the list of their columns; the last n - n_must
 * columns are optional. */
struct table {
  const char *rows, *row, *columns;
  int n, n_must;
  const char *column[COLUMN_N];
};

static const struct table span_table = {
  "spans",
  "span",
  "columns",
  COLUMN_N,
  COLUMN_LOOPS,
  { "path", "after", "kind", "rank", "thread", "home", "start", "end", "cpu",
    "estimate", "cells", "bytes_in", "bytes_out", "loops", "faces", "work" }
};

static const struct table help_table = {
  "help", "help", "help_columns",
  HELP_N, HELP_N, { "path", "rank", "thread", "start", "end" }
};

/* Keys of the phases' times in the facts. */
static const char *const phase_key[VG_PHASE_N] = {
  "seconds_read",   "seconds_check",    "seconds_sizes",
  "seconds_layers", "seconds_cut_fill", "seconds_number",
  "seconds_judge",  "seconds_write",    "seconds_total",
};

void vg_timeline_release(struct vg_timeline *t)
{
  vg_spans_release(&t->spans);
  memset(t, 0, sizeof *t);
}

void vg_timeline_outside(const struct vg_timeline *t, struct vg_machine *m)
{
  double workers = (double)t->spans.n_rank * t->spans.n_thread;
  double rest = t->seconds[VG_PHASE_TOTAL] - t->spans.wall;

  m->serial = m->by_node = m->by_all = 0;
  for (int k = 0; k < VG_PHASE_N; k++) {
    double alone, by_node, one;

    if (!vg_phase_is_outside((enum vg_phase)k)) continue;
    vg_phase_shares((enum vg_phase)k, &alone, &by_node);
    one = t->seconds[k] / (alone + (1 - alone) / workers);
    m->serial += alone * one;
    m->by_node += by_node * one;
    m->by_all += (1 - alone - by_node) * one;
    rest -= t->seconds[k];
  }
  if (rest > 0) m->serial += rest;
}

/* --- writing ------------------------------------------------------------- */

static void put_string(struct vg_output *out, const char *text)
{
  json_t *string = vg_text_json(text);
  char *quoted = json_dumps(string, JSON_ENCODE_ANY);

  if (!quoted) vg_print_lose();
  vg_output_text(out, quoted ? quoted : "\"\"");
  free(quoted);
  json_decref(string);
}

static void put_seconds(struct vg_output *out, double s)
{
  vg_output_real(out, isfinite(s) && s > 0 ? floor(s * 1e6 + 0.5) / 1e6 : 0);
}

static void put_facts(struct vg_output *out, const struct vg_timeline *t)
{
  vg_output_text(out, "{\"vanguard_timeline\": 1,\n\"facts\": {\"title\": ");
  put_string(out, t->title);
  vg_output_format(out,
                   ", \"ranks\": %d, \"threads\": %d, \"cells\": %llu, "
                   "\"points\": %llu, \"cyclic\": %d,\n \"digest\": ",
                   (int)t->spans.n_rank, (int)t->spans.n_thread,
                   (unsigned long long)t->n_cell,
                   (unsigned long long)t->n_point, t->cyclic);
  put_string(out, t->digest);
  for (int i = 0; i < VG_PHASE_N; i++) {
    vg_output_format(out, ",%s\"%s\": ", i % 4 ? " " : "\n ", phase_key[i]);
    put_seconds(out, i == VG_PHASE_ENGINE ? t->spans.wall : t->seconds[i]);
  }
  vg_output_text(out, "},\n");
}

/* Write the names of the columns and the beginning of the rows. */
static void put_head(struct vg_output *out, const struct table *t)
{
  vg_output_format(out, "\"%s\": [", t->columns);
  for (int i = 0; i < t->n; i++)
    vg_output_format(out, "%s\"%s\"", i ? ", " : "", t->column[i]);
  vg_output_format(out, "],\n\"%s\": [", t->rows);
}

static void put_span(struct vg_output *out, const struct vg_span *s)
{
  char kind[2] = { s->kind, 0 };

  vg_output_text(out, "[");
  put_string(out, s->path);
  vg_output_text(out, ",");
  put_string(out, s->after);
  vg_output_text(out, ",");
  put_string(out, kind);
  vg_output_format(out, ",%d,%d,%d,", (int)s->rank, (int)s->thread,
                   (int)s->home);
  put_seconds(out, s->start);
  vg_output_text(out, ",");
  put_seconds(out, s->end);
  vg_output_text(out, ",");
  put_seconds(out, s->cpu);
  vg_output_text(out, ",");
  vg_output_real(out, isfinite(s->estimate) ? floor(s->estimate + 0.5) : 0);
  vg_output_format(out, ",%llu,%llu,%llu,", (unsigned long long)s->n_cell,
                   (unsigned long long)s->bytes_in,
                   (unsigned long long)s->bytes_out);
  put_seconds(out, s->loops);
  vg_output_format(out, ",%llu,", (unsigned long long)s->n_face);
  vg_output_real(out, isfinite(s->work) && s->work > 0 ? s->work : 0);
  vg_output_text(out, "]");
}

static void put_help(struct vg_output *out, const struct vg_help *h)
{
  vg_output_text(out, "[");
  put_string(out, h->path);
  vg_output_format(out, ",%d,%d,", (int)h->rank, (int)h->thread);
  put_seconds(out, h->start);
  vg_output_text(out, ",");
  put_seconds(out, h->end);
  vg_output_text(out, "]");
}

vg_status vg_timeline_write(const char *path, const struct vg_timeline *t,
                            struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  vg_status st;

  VG_TRY(vg_output_open(path, &out, err));
  put_facts(&out, t);
  put_head(&out, &span_table);
  for (size_t i = 0; i < t->spans.n; i++) {
    vg_output_text(&out, i ? ",\n" : "\n");
    put_span(&out, &t->spans.span[i]);
  }
  vg_output_text(&out, "\n],\n");
  put_head(&out, &help_table);
  for (size_t i = 0; i < t->spans.n_help; i++) {
    vg_output_text(&out, i ? ",\n" : "\n");
    put_help(&out, &t->spans.help[i]);
  }
  vg_output_text(&out, "\n]}\n");
  VG_TRY(vg_output_commit(&out, err));
done:
  vg_output_release(&out);
  return st;
}

/* --- reading ------------------------------------------------------------- */

/* Location of a value in the file, for messages: span or help `number`; a fact
 * if that is 0. */
struct place {
  const char *name, *list;
  size_t number;
  const char *path;
};

static vg_status bad_value(const struct place *at, const char *what,
                           const char *wanted, struct vg_error *err)
{
  if (!at->number)
    return vg_fail(err, VG_ERR_FORMAT, "%s: fact \"%s\" is not %s", at->name,
                   what, wanted);
  return vg_fail(err, VG_ERR_FORMAT, "%s: %s %zu%s%s: \"%s\" is not %s",
                 at->name, at->list, at->number, at->path ? ", task " : "",
                 at->path ? at->path : "", what, wanted);
}

static vg_status get_text(const struct place *at, const json_t *o,
                          const char *what, size_t size, char *out,
                          struct vg_error *err)
{
  if (!json_is_string(o) || json_string_length(o) >= size)
    return bad_value(at, what, "a text of the permitted length", err);
  memcpy(out, json_string_value(o), json_string_length(o) + 1);
  return VG_OK;
}

/* Read an integer from 0 to limit. */
static vg_status get_count(const struct place *at, const json_t *o,
                           const char *what, json_int_t limit, uint64_t *out,
                           struct vg_error *err)
{
  char wanted[80];
  json_int_t v = json_integer_value(o);

  snprintf(wanted, sizeof wanted, "an integer from 0 to %lld",
           (long long)limit);
  if (!json_is_integer(o) || v < 0 || v > limit)
    return bad_value(at, what, wanted, err);
  *out = (uint64_t)v;
  return VG_OK;
}

static vg_status get_real(const struct place *at, const json_t *o,
                          const char *what, double most, double *out,
                          struct vg_error *err)
{
  double v = json_number_value(o);
  char wanted[80];

  snprintf(wanted, sizeof wanted, "a number from 0 to %g", most);
  if (!json_is_number(o) || !(v >= 0 && v <= most))
    return bad_value(at, what, wanted, err);
  *out = v;
  return VG_OK;
}

static vg_status get_facts(const char *name, const json_t *root,
                           struct vg_timeline *t, struct vg_error *err)
{
  const json_t *facts = json_object_get(root, "facts"), *o;
  struct place at = { .name = name };
  uint64_t ranks, threads, cyclic = 0;
  vg_status st = VG_OK;

  if (!json_is_object(facts))
    return vg_fail(err, VG_ERR_FORMAT, "%s: \"facts\" is missing", name);
  VG_TRY(get_count(&at, json_object_get(facts, "ranks"), "ranks",
                   VG_TIMELINE_MAX, &ranks, err));
  VG_TRY(get_count(&at, json_object_get(facts, "threads"), "threads",
                   VG_TIMELINE_MAX, &threads, err));
  if (!ranks || !threads || ranks * threads > VG_TIMELINE_MAX)
    return vg_fail(err, VG_ERR_FORMAT,
                   "%s: %llu ranks with %llu threads; the number of workers "
                   "must be from 1 to %d",
                   name, (unsigned long long)ranks, (unsigned long long)threads,
                   VG_TIMELINE_MAX);
  t->spans.n_rank = (int32_t)ranks;
  t->spans.n_thread = (int32_t)threads;
  if ((o = json_object_get(facts, "title")))
    VG_TRY(get_text(&at, o, "title", sizeof t->title, t->title, err));
  if ((o = json_object_get(facts, "digest")))
    VG_TRY(get_text(&at, o, "digest", sizeof t->digest, t->digest, err));
  if ((o = json_object_get(facts, "cells")))
    VG_TRY(get_count(&at, o, "cells", COUNT_MAX, &t->n_cell, err));
  if ((o = json_object_get(facts, "points")))
    VG_TRY(get_count(&at, o, "points", COUNT_MAX, &t->n_point, err));
  if ((o = json_object_get(facts, "cyclic")))
    VG_TRY(get_count(&at, o, "cyclic", 1, &cyclic, err));
  t->cyclic = (int)cyclic;
  for (int i = 0; i < VG_PHASE_N; i++)
    if ((o = json_object_get(facts, phase_key[i])))
      VG_TRY(get_real(&at, o, phase_key[i], SECONDS_MAX, &t->seconds[i], err));
  t->spans.wall = t->seconds[VG_PHASE_ENGINE];
done:
  return st;
}

/* Find the position of each column in a row; SIZE_MAX if it is absent. */
static vg_status get_columns(const char *name, const json_t *root,
                             const struct table *t, size_t *place,
                             struct vg_error *err)
{
  const json_t *list = json_object_get(root, t->columns);

  for (int c = 0; c < t->n; c++) {
    size_t i, n_word = json_array_size(list);

    for (i = 0; i < n_word; i++) {
      const char *word = json_string_value(json_array_get(list, i));

      if (word && !strcmp(word, t->column[c])) break;
    }
    if (i == n_word && c < t->n_must)
      return vg_fail(err, VG_ERR_FORMAT, "%s: no column \"%s\" in \"%s\"", name,
                     t->column[c], t->columns);
    place[c] = i < n_word ? i : SIZE_MAX;
  }
  return VG_OK;
}

/* Read the values of a row by column; NULL for absent columns. */
static vg_status get_row(const struct place *at, const json_t *row,
                         const struct table *t, const size_t *place, json_t **v,
                         struct vg_error *err)
{
  for (int c = 0; c < t->n; c++) {
    v[c] = place[c] == SIZE_MAX ? NULL : json_array_get(row, place[c]);
    if (!v[c] && place[c] != SIZE_MAX)
      return vg_fail(err, VG_ERR_FORMAT,
                     "%s: %s %zu has no \"%s\"; it is "
                     "not a list as long as \"%s\"",
                     at->name, at->list, at->number, t->column[c], t->columns);
  }
  return VG_OK;
}

static vg_status get_times(const struct place *at, const json_t *start,
                           const json_t *end, double *from, double *to,
                           struct vg_error *err)
{
  vg_status st;

  VG_TRY(get_real(at, start, "start", SECONDS_MAX, from, err));
  VG_TRY(get_real(at, end, "end", SECONDS_MAX, to, err));
  if (*to < *from) st = bad_value(at, "end", "after \"start\"", err);
done:
  return st;
}

static vg_status get_worker(const struct place *at, const json_t *rank,
                            const json_t *thread, const struct vg_spans *all,
                            int32_t out[2], struct vg_error *err)
{
  uint64_t r = 0, t = 0;
  vg_status st;

  VG_TRY(get_count(at, rank, "rank", all->n_rank - 1, &r, err));
  VG_TRY(get_count(at, thread, "thread", all->n_thread - 1, &t, err));
  out[0] = (int32_t)r;
  out[1] = (int32_t)t;
done:
  return st;
}

static vg_status get_path(const struct place *at, const json_t *o,
                          char path[VG_PATH_MAX], struct vg_error *err)
{
  vg_status st = get_text(at, o, "path", VG_PATH_MAX, path, err);

  return !st && !path[0] ? bad_value(at, "path", "of any length", err) : st;
}

static vg_status get_numbers(const struct place *at, json_t *const *v,
                             const struct vg_spans *all, struct vg_span *s,
                             struct vg_error *err)
{
  uint64_t home = 0;
  int32_t who[2];
  vg_status st;

  VG_TRY(get_worker(at, v[COLUMN_RANK], v[COLUMN_THREAD], all, who, err));
  VG_TRY(get_count(at, v[COLUMN_HOME], "home", all->n_rank - 1, &home, err));
  s->rank = who[0];
  s->thread = who[1];
  s->home = (int32_t)home;
  VG_TRY(
    get_times(at, v[COLUMN_START], v[COLUMN_END], &s->start, &s->end, err));
  VG_TRY(get_real(at, v[COLUMN_CPU], "cpu", SECONDS_MAX, &s->cpu, err));
  VG_TRY(get_real(at, v[COLUMN_ESTIMATE], "estimate", 1e15, &s->estimate, err));
  VG_TRY(get_count(at, v[COLUMN_CELLS], "cells", COUNT_MAX, &s->n_cell, err));
  VG_TRY(get_count(at, v[COLUMN_BYTES_IN], "bytes_in", COUNT_MAX, &s->bytes_in,
                   err));
  VG_TRY(get_count(at, v[COLUMN_BYTES_OUT], "bytes_out", COUNT_MAX,
                   &s->bytes_out, err));
  if (v[COLUMN_FACES])
    VG_TRY(get_count(at, v[COLUMN_FACES], "faces", COUNT_MAX, &s->n_face, err));
  if (v[COLUMN_WORK])
    VG_TRY(get_real(at, v[COLUMN_WORK], "work", WORK_MAX, &s->work, err));
  if (!v[COLUMN_LOOPS]) goto done;
  VG_TRY(get_real(at, v[COLUMN_LOOPS], "loops", SECONDS_MAX, &s->loops, err));
  if (s->loops > s->cpu + ROUNDED)
    st = bad_value(at, "loops", "within \"cpu\"", err);
done:
  return st;
}

static vg_status get_span(struct place *at, json_t *const *v,
                          struct vg_spans *out, struct vg_error *err)
{
  struct vg_span s;
  char kind[2];
  vg_status st;

  memset(&s, 0, sizeof s);
  VG_TRY(get_path(at, v[COLUMN_PATH], s.path, err));
  at->path = s.path;
  VG_TRY(get_text(at, v[COLUMN_AFTER], "after", sizeof s.after, s.after, err));
  VG_TRY(get_text(at, v[COLUMN_KIND], "kind", sizeof kind, kind, err));
  if (kind[0] < 'A' || kind[0] > 'Z')
    return bad_value(at, "kind", "a letter from A to Z", err);
  s.kind = kind[0];
  VG_TRY(get_numbers(at, v, out, &s, err));
  VG_TRY(vg_spans_add(out, &s, err));
done:
  return st;
}

static vg_status get_help(struct place *at, json_t *const *v,
                          struct vg_spans *out, struct vg_error *err)
{
  struct vg_help h;
  int32_t who[2];
  vg_status st;

  memset(&h, 0, sizeof h);
  VG_TRY(get_path(at, v[HELP_PATH], h.path, err));
  at->path = h.path;
  VG_TRY(get_worker(at, v[HELP_RANK], v[HELP_THREAD], out, who, err));
  VG_TRY(get_times(at, v[HELP_START], v[HELP_END], &h.start, &h.end, err));
  h.rank = who[0];
  h.thread = who[1];
  VG_TRY(vg_spans_add_help(out, &h, err));
done:
  return st;
}

static vg_status get_rows(const char *name, const json_t *root,
                          const struct table *t,
                          vg_status (*get)(struct place *, json_t *const *,
                                           struct vg_spans *,
                                           struct vg_error *),
                          struct vg_spans *out, struct vg_error *err)
{
  const json_t *list = json_object_get(root, t->rows);
  json_t *v[COLUMN_N] = { NULL };
  size_t place[COLUMN_N];
  vg_status st;

  VG_TRY(get_columns(name, root, t, place, err));
  if (!json_is_array(list))
    return vg_fail(err, VG_ERR_FORMAT, "%s: \"%s\" is missing", name, t->rows);
  for (size_t i = 0; i < json_array_size(list); i++) {
    struct place at = { name, t->row, i + 1, NULL };

    VG_TRY(get_row(&at, json_array_get(list, i), t, place, v, err));
    VG_TRY(get(&at, v, out, err));
  }
done:
  return st;
}

vg_status vg_timeline_parse(const char *name, const void *data, size_t size,
                            struct vg_timeline *out, struct vg_error *err)
{
  struct vg_timeline t = VG_TIMELINE_INIT;
  json_error_t where;
  json_t *root = json_loadb(data, size, JSON_REJECT_DUPLICATES, &where);
  vg_status st;

  if (!root)
    return vg_fail(err, VG_ERR_FORMAT, "%s:%d: not JSON: %s", name, where.line,
                   where.text);
  if (json_integer_value(json_object_get(root, "vanguard_timeline")) != 1) {
    st = vg_fail(err, VG_ERR_FORMAT,
                 "%s: not a timeline of vanguard mesh "
                 "(\"vanguard_timeline\" is not 1); give a "
                 ".timeline.json written by 'vanguard mesh --timeline'",
                 name);
    goto done;
  }
  VG_TRY(get_facts(name, root, &t, err));
  VG_TRY(get_rows(name, root, &span_table, get_span, &t.spans, err));
  if (json_array_size(json_object_get(root, help_table.rows)))
    VG_TRY(get_rows(name, root, &help_table, get_help, &t.spans, err));
  vg_spans_sort(&t.spans);
  *out = t;
  memset(&t, 0, sizeof t);
done:
  json_decref(root);
  vg_timeline_release(&t);
  return st;
}

vg_status vg_timeline_read(const char *path, struct vg_timeline *out,
                           struct vg_error *err)
{
  struct vg_input in = VG_INPUT_INIT;
  vg_status st;

  VG_TRY(vg_input_open(path, &in, err));
  VG_TRY(vg_timeline_parse(path, in.data, in.size, out, err));
done:
  vg_input_release(&in);
  return st;
}
