/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Writes the tables and plots of a sweep. */
#define _GNU_SOURCE
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/plot/plot.h"
#include "cli/sweep/sweep.h"
#include "io/stream/csv.h"
#include "partition/model/model.h"
#include "partition/model/rates.h"
#include "run/common/folder.h"
#include "run/common/json_build.h"
#include "run/common/json_file.h"
#include "run/common/text.h"
#include "run/report/report.h"

/* --- numbers of a case --------------------------------------------------- */

enum { N_VALUE = 22 };
static const char *const value_names[N_VALUE] = { "seconds",
                                                  "wall",
                                                  "speedup",
                                                  "efficiency",
                                                  "busy",
                                                  "imbalance",
                                                  "tasks",
                                                  "leaves",
                                                  "cells",
                                                  "points",
                                                  "angle_min",
                                                  "peak_memory_bytes",
                                                  "parts_asked",
                                                  "subdomains",
                                                  "field_cells",
                                                  "cells_ratio",
                                                  "decomposition_seconds",
                                                  "balance",
                                                  "critical",
                                                  "near_cells",
                                                  "near_angle_min_p1",
                                                  "angle_min_p1" };

static size_t leaf_count(const struct vg_spans *s)
{
  size_t n = 0;

  for (size_t i = 0; i < s->n; i++) n += s->span[i].kind == VG_SPAN_LEAF;
  return n;
}

/* Unknown values are NAN, which is written as an empty field. */
static void values_of(const struct vg_sweep *s, const struct vg_sweep_case *c,
                      double v[N_VALUE])
{
  for (int i = 0; i < N_VALUE; i++) v[i] = NAN;
  if (c->subdomains >= 0) v[12] = (double)c->subdomains;
  if (!c->is_run) return;
  v[1] = c->wall;
  if (!c->is_done) return;
  v[0] = vg_sweep_seconds(c);
  v[2] = vg_sweep_speedup(s, v[0]);
  v[3] = v[2] / (c->ranks * c->threads);
  if (c->has_timeline) {
    v[4] = vg_spans_busy(&c->t.spans);
    v[5] = vg_spans_imbalance(&c->t.spans);
    v[6] = (double)c->t.spans.n;
    v[7] = (double)leaf_count(&c->t.spans);
    v[8] = (double)c->t.n_cell;
    v[9] = (double)c->t.n_point;
  }
  v[10] = c->angle_min;
  v[11] = c->peak_memory;
  v[13] = c->parts_made.n_part;
  v[14] = vg_sweep_field_cells(c);
  v[15] = vg_sweep_cells_ratio(s, c);
  v[16] = c->parts_made.seconds;
  v[17] = c->parts_made.balance;
  v[18] = c->critical;
  v[19] = c->parts_made.near_cells;
  v[20] = c->parts_made.near_p1;
  v[21] = c->parts_made.all_p1;
}

static const char *state_of(const struct vg_sweep_case *c)
{
  return c->is_done ? "done" : c->is_run ? "failed" : "not run";
}

/* --- csv ----------------------------------------------------------------- */

static void put_number(struct vg_output *out, double v)
{
  vg_output_text(out, ",");
  if (isfinite(v)) vg_output_real(out, floor(v * 1e6 + 0.5) / 1e6);
}

static void put_row(struct vg_output *out, const struct vg_sweep *s,
                    const struct vg_sweep_case *c)
{
  double v[N_VALUE];

  values_of(s, c, v);
  vg_csv_put(out, c->name);
  vg_output_text(out, ",");
  if (c->bisections >= 0) vg_output_int(out, c->bisections);
  vg_output_text(out, ",");
  if (c->leaf_cells >= 0) vg_output_int(out, c->leaf_cells);
  vg_output_format(out, ",%d,%d,%d,%d,%s,%d", c->ranks, c->threads,
                   c->ranks * c->threads, c->repeat, state_of(c),
                   c->exit_status);
  for (int i = 0; i < N_VALUE; i++) put_number(out, v[i]);
  for (int i = 0; i < VG_PHASE_N; i++)
    put_number(out, c->has_timeline ? c->t.seconds[i] : NAN);
  vg_output_format(out, ",%s,%s,", c->way < 0 ? "" : vg_ways[c->way].name,
                   c->digest);
  vg_csv_put(out, c->note);
  vg_output_text(out, "\n");
}

static vg_status write_csv(const struct vg_sweep *s, struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char *path = NULL;
  vg_status st;

  VG_TRY(vg_folder_path(s->o->dir, "sweep.csv", &path, err));
  VG_TRY(vg_output_open(path, &out, err));
  vg_output_text(&out,
                 "case,bisections,leaf_cells,ranks,threads,workers,repeat,"
                 "state,exit");
  for (int i = 0; i < N_VALUE; i++)
    vg_output_format(&out, ",%s", value_names[i]);
  for (int i = 0; i < VG_PHASE_N; i++)
    vg_output_format(&out, ",%s", vg_phase_name((enum vg_phase)i));
  vg_output_text(&out, ",decompose,digest,note\n");
  for (size_t i = 0; i < s->n; i++) put_row(&out, s, &s->item[i]);
  VG_TRY(vg_output_commit(&out, err));
done:
  vg_output_release(&out);
  free(path);
  return st;
}

/* --- json ---------------------------------------------------------------- */

static json_t *real_or_null(double v)
{
  return isfinite(v) ? json_real(v) : json_null();
}

static json_t *whole_or_null(int64_t v)
{
  return v >= 0 ? json_integer((json_int_t)v) : json_null();
}

/* Seconds per cell and per face of the front, by kind of task. */
static json_t *rates_json(const struct vg_sweep_case *c)
{
  static const char kinds[] = { VG_SPAN_LEAF, VG_SPAN_PENCIL, VG_SPAN_TILE };
  struct vg_error err = VG_ERROR_INIT;
  json_t *o = json_object();

  for (size_t k = 0; k < sizeof kinds && c->has_timeline; k++) {
    const char name[2] = { kinds[k], '\0' };
    struct vg_rate_fit f;

    if (vg_rates_fit(&c->t.spans, kinds[k], &f, &err) < 0 || !f.n) continue;
    json_object_set_new(o, name,
                        json_pack("{s:I s:f s:f s:f}", "tasks", (json_int_t)f.n,
                                  "per_cell", f.cell, "per_face", f.face,
                                  "error", f.error));
  }
  return o;
}

static json_t *case_json(const struct vg_sweep *s,
                         const struct vg_sweep_case *c)
{
  json_t *o = json_object(), *phases = json_object();
  double v[N_VALUE];

  values_of(s, c, v);
  json_object_set_new(o, "case", vg_text_json(c->name));
  json_object_set_new(o, "bisections", whole_or_null(c->bisections));
  json_object_set_new(o, "leaf_cells", whole_or_null(c->leaf_cells));
  json_object_set_new(o, "decompose",
                      c->way < 0 ? json_null()
                                 : json_string(vg_ways[c->way].name));
  json_object_set_new(o, "ranks", json_integer(c->ranks));
  json_object_set_new(o, "threads", json_integer(c->threads));
  json_object_set_new(o, "repeat", json_integer(c->repeat));
  json_object_set_new(o, "state", json_string(state_of(c)));
  json_object_set_new(o, "exit", json_integer(c->exit_status));
  json_object_set_new(o, "note", vg_text_json(c->note));
  for (int i = 0; i < N_VALUE; i++)
    json_object_set_new(o, value_names[i], real_or_null(v[i]));
  for (int i = 0; i < VG_PHASE_N && c->has_timeline; i++)
    json_object_set_new(phases, vg_phase_name((enum vg_phase)i),
                        json_real(c->t.seconds[i]));
  json_object_set_new(o, "phases", phases);
  json_object_set_new(o, "rates", rates_json(c));
  json_object_set_new(o, "digest", vg_text_json(c->digest));
  return o;
}

static vg_status write_json(const struct vg_sweep *s, struct vg_error *err)
{
  json_t *root = json_object(), *list = json_array();
  const struct vg_sweep_case *a, *b;
  char *path = NULL, file[64];
  size_t compared;
  int differ = vg_sweep_differ(s, &compared, &a, &b, file);
  vg_status st;

  for (size_t i = 0; i < s->n; i++)
    json_array_append_new(list, case_json(s, &s->item[i]));
  json_object_set_new(root, "project", vg_text_json(s->o->project));
  json_object_set_new(root, "digests",
                      json_string(differ     ? "differ"
                                  : compared ? "agree"
                                             : "not compared"));
  json_object_set_new(root, "cases", list);
  VG_TRY(vg_folder_path(s->o->dir, "sweep.json", &path, err));
  VG_TRY(vg_json_write(path, root, "the table of cases", err));
  if (s->o->json) {
    json_dumpf(root, stdout, JSON_INDENT(2));
    puts("");
  }
done:
  json_decref(root);
  free(path);
  return st;
}

vg_status vg_sweep_write(const struct vg_sweep *s, struct vg_error *err)
{
  vg_status st = write_csv(s, err);

  if (st >= 0) st = vg_sweep_family_write(s, err);
  if (st >= 0) st = vg_sweep_named_write(s, err);

  return st < 0 ? st : write_json(s, err);
}

/* --- figures ------------------------------------------------------------- */

static vg_status draw_cases(const struct vg_sweep *s, struct vg_error *err)
{
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->n && st >= 0; i++) {
    const struct vg_sweep_case *c = &s->item[i];
    double target = c->leaf_cells > 0 ? (double)c->leaf_cells : 0;
    char *lanes = NULL, *sizes = NULL;

    if (!c->has_timeline) continue;
    if (asprintf(&lanes, "%s/%s.timeline.svg", s->o->dir, c->name) < 0)
      lanes = NULL;
    if (asprintf(&sizes, "%s/%s.sizes.svg", s->o->dir, c->name) < 0)
      sizes = NULL;
    if (!lanes || !sizes) st = vg_fail_memory(err, "a path");
    if (st >= 0) st = vg_plot_timeline(lanes, &c->t, err);
    if (st >= 0) st = vg_plot_sizes(sizes, &c->t, target, err);
    free(lanes);
    free(sizes);
  }
  return st;
}

static vg_status draw_phases(const struct vg_sweep *s, struct vg_error *err)
{
  struct vg_plot_bar *bar = vg_alloc(s->n, sizeof *bar);
  char *path = NULL;
  size_t n = 0;
  vg_status st = VG_OK;

  if (!bar) return vg_fail_memory(err, "a figure");
  for (size_t i = 0; i < s->n; i++) {
    if (!s->item[i].has_timeline) continue;
    bar[n].label = s->item[i].name;
    bar[n++].seconds = s->item[i].t.seconds;
  }
  if (n) VG_TRY(vg_folder_path(s->o->dir, "phases.svg", &path, err));
  if (n) VG_TRY(vg_plot_phases(path, s->o->project, n, bar, err));
done:
  free(path);
  free(bar);
  return st;
}

/* A curve of the speed-up plot. */
struct line {
  const struct vg_sweep_case *mesh;
  int colour; /* a model has the colour of the measured curve */
  char label[64];
  size_t n;
  double *workers, *speedup; /* [VG_RANGE_MAX at most] */
};

struct lines {
  size_t n, cap;
  struct line *line;
  struct vg_plot_series *series;
};

static void lines_release(struct lines *l)
{
  for (size_t i = 0; i < l->n; i++) {
    free(l->line[i].workers);
    free(l->line[i].speedup);
  }
  free(l->line);
  free(l->series);
}

static int by_value(const void *a, const void *b)
{
  double s = *(const double *)a, t = *(const double *)b;

  return (s > t) - (s < t);
}

static int same_point(const struct vg_sweep_case *a,
                      const struct vg_sweep_case *b)
{
  return vg_sweep_same_mesh(a, b) && a->ranks == b->ranks &&
         a->threads == b->threads;
}

/* Median time of all repeats of a case; NAN if none is finished. */
static vg_status median(const struct vg_sweep *s, const struct vg_sweep_case *c,
                        double *out, struct vg_error *err)
{
  double *v = vg_alloc(s->n, sizeof *v);
  size_t n = 0;

  if (!v) return vg_fail_memory(err, "a figure");
  for (size_t i = 0; i < s->n; i++)
    if (s->item[i].is_done && same_point(&s->item[i], c))
      v[n++] = vg_sweep_seconds(&s->item[i]);
  qsort(v, n, sizeof *v, by_value);
  *out = n ? 0.5 * (v[(n - 1) / 2] + v[n / 2]) : NAN;
  free(v);
  return VG_OK;
}

static vg_status new_line(struct lines *l, const struct vg_sweep_case *mesh,
                          size_t room, struct line **out, struct vg_error *err)
{
  struct line *to;

  if (vg_reserve(&l->line, &l->cap, l->n + 1, sizeof *l->line))
    return vg_fail_memory(err, "a figure");
  to = &l->line[l->n++];
  memset(to, 0, sizeof *to);
  to->mesh = mesh;
  to->colour = (int)l->n - 1;
  to->workers = vg_alloc(room, sizeof *to->workers);
  to->speedup = vg_alloc(room, sizeof *to->speedup);
  if (!to->workers || !to->speedup) return vg_fail_memory(err, "a figure");
  *out = to;
  return VG_OK;
}

/* Insert a point; points are sorted by the number of workers. */
static void add_point(struct line *l, double workers, double speedup)
{
  size_t at = l->n++;

  for (; at && l->workers[at - 1] > workers; at--) {
    l->workers[at] = l->workers[at - 1];
    l->speedup[at] = l->speedup[at - 1];
  }
  l->workers[at] = workers;
  l->speedup[at] = speedup;
}

static void name_mesh(const struct vg_sweep_case *c, char *text, size_t size)
{
  if (c->bisections >= 0)
    snprintf(text, size, "%lld bisections", (long long)c->bisections);
  else if (c->leaf_cells >= 0)
    snprintf(text, size, "%lld cells per leaf", (long long)c->leaf_cells);
  else if (c->way >= 0) snprintf(text, size, "%s", vg_ways[c->way].name);
  else snprintf(text, size, "measured");
  if (c->subdomains >= 0)
    snprintf(text + strlen(text), size - strlen(text), ", %lld subdomains",
             (long long)c->subdomains);
}

/* Add the curve of one mesh over ranks, with a fixed number of threads, or over
 * threads with a fixed number of ranks if !by_ranks. */
static vg_status add_measured(const struct vg_sweep *s,
                              const struct vg_sweep_case *first, int by_ranks,
                              double base, struct lines *l,
                              struct vg_error *err)
{
  const struct vg_sweep_options *o = s->o;
  int fixed = by_ranks ? first->threads : first->ranks;
  struct line *to;
  vg_status st;

  VG_TRY(new_line(l, first, s->n, &to, err));
  name_mesh(first, to->label, sizeof to->label);
  if ((by_ranks ? o->threads.n : o->ranks.n) > 1)
    snprintf(to->label + strlen(to->label), 24, ", %d %s%s", fixed,
             by_ranks ? "thread" : "rank", fixed > 1 ? "s" : "");
  for (size_t i = 0; i < s->n; i++) {
    const struct vg_sweep_case *c = &s->item[i];
    double seconds = NAN;

    if (!vg_sweep_same_mesh(c, first) || c->repeat != 1 ||
        (by_ranks ? c->threads != first->threads : c->ranks != first->ranks))
      continue;
    VG_TRY(median(s, c, &seconds, err));
    if (!(seconds > 0)) continue;
    add_point(to, c->ranks * c->threads, base / seconds);
  }
done:
  return st;
}

/* Add the curve that the model predicts from the run on one worker. */
static vg_status add_model(const struct vg_sweep *s,
                           const struct vg_sweep_case *mesh, double base,
                           double most, struct lines *l, struct vg_error *err)
{
  const struct vg_sweep_case *c = NULL;
  struct line *to;
  vg_status st;

  for (size_t i = 0; i < s->n && !c; i++)
    if (s->item[i].has_timeline && vg_sweep_same_mesh(&s->item[i], mesh) &&
        s->item[i].ranks * s->item[i].threads == 1)
      c = &s->item[i];
  if (!c) return VG_OK;
  VG_TRY(new_line(l, mesh, 64, &to, err));
  for (size_t i = 0; i + 1 < l->n; i++)
    if (vg_sweep_same_mesh(l->line[i].mesh, mesh)) {
      to->colour = l->line[i].colour;
      break;
    }
  name_mesh(mesh, to->label, sizeof to->label - 8);
  snprintf(to->label + strlen(to->label), 8, ", model");
  for (int n = 1; n <= most && to->n<64; n = most> 16 ? 2 * n : n + 1) {
    struct vg_machine m = VG_MACHINE_INIT;
    struct vg_model_result f;

    m.ranks = m.ranks_per_node = n;
    m.cyclic = c->t.cyclic;
    vg_timeline_outside(&c->t, &m);
    VG_TRY(vg_model_replay(&c->t.spans, &m, &f, NULL, err));
    if (!(f.wall > 0)) break;
    add_point(to, n, base / f.wall);
  }
done:
  return st;
}

/* Returns 1 if item i is the first with its mesh and, unless by_ranks < 0, with
 * its fixed number of threads or ranks. */
static int is_first(const struct vg_sweep *s, size_t i, int by_ranks)
{
  for (size_t k = 0; k < i; k++)
    if (vg_sweep_same_mesh(&s->item[k], &s->item[i]) &&
        (by_ranks < 0 || (by_ranks ? s->item[k].threads == s->item[i].threads
                                   : s->item[k].ranks == s->item[i].ranks)))
      return 0;
  return 1;
}

static vg_status draw_speedup(const struct vg_sweep *s, struct vg_error *err)
{
  const struct vg_sweep_case *base = vg_sweep_base(s);
  int by_ranks = s->o->ranks.n >= s->o->threads.n;
  struct lines l = { 0, 0, NULL, NULL };
  char *path = NULL, subtitle[160], seconds[32];
  double time, most = 2;
  size_t n_measured;
  vg_status st = VG_OK;

  if (!base) return VG_OK;
  VG_TRY(median(s, base, &time, err));
  seconds[vg_format_real(floor(time * 100 + 0.5) / 100, seconds)] = 0;
  time *= base->ranks * base->threads; /* time of one worker */
  for (size_t i = 0; i < s->n; i++) {
    double workers = s->item[i].ranks * s->item[i].threads;

    if (workers > most) most = workers;
    if (is_first(s, i, by_ranks))
      VG_TRY(add_measured(s, &s->item[i], by_ranks, time, &l, err));
  }
  n_measured = l.n;
  for (size_t i = 0; i < s->n; i++)
    if (is_first(s, i, -1))
      VG_TRY(add_model(s, &s->item[i], time, most, &l, err));
  l.series = vg_calloc(l.n, sizeof *l.series);
  if (!l.series) {
    st = vg_fail_memory(err, "a figure");
    goto done;
  }
  for (size_t i = 0; i < l.n; i++)
    l.series[i] = (struct vg_plot_series){
      l.line[i].label, l.line[i].colour,  i >= n_measured,
      l.line[i].n,     l.line[i].workers, l.line[i].speedup
    };
  snprintf(subtitle, sizeof subtitle, "relative to %s: %s s", base->name,
           seconds);
  VG_TRY(vg_folder_path(s->o->dir, "speedup.svg", &path, err));
  VG_TRY(vg_plot_speedup(path, s->o->project, subtitle, l.n, l.series, err));
done:
  lines_release(&l);
  free(path);
  return st;
}

vg_status vg_sweep_draw(const struct vg_sweep *s, struct vg_error *err)
{
  vg_status st = draw_cases(s, err);

  if (st >= 0) st = draw_phases(s, err);
  return st < 0 ? st : draw_speedup(s, err);
}
