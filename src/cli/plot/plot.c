/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Plots of one run: its timeline and the sizes of its leaves. */
#include "cli/plot/plot.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/plot/svg.h"
#include "run/common/text.h"

#define WIDTH 960.0
#define LEFT 110.0
#define RIGHT 890.0
#define LANES_HEIGHT_MAX 1400.0
#define N_BIN 30

/* Pseudo kind of task: workers that help in loops of another worker's task,
 * which only joins have. */
#define HELP 'h'

static const struct {
  char kind;
  const char *name, *colour;
} kinds[] = {
  { VG_SPAN_JOIN, "join", VG_SVG_RED },
  { VG_SPAN_PENCIL, "pencil", VG_SVG_BLUE },
  { VG_SPAN_TILE, "tile", VG_SVG_SKY },
  { VG_SPAN_LEAF, "leaf", VG_SVG_ORANGE },
  { VG_SPAN_REPAIR, "repair", VG_SVG_PURPLE },
  { HELP, "help", VG_SVG_YELLOW },
  { 0, "other", VG_SVG_GREY },
};
#define N_KIND (sizeof kinds / sizeof *kinds)

/* A time in which a worker is busy, with a task or with help. */
struct mark {
  size_t kind, lane;
  double start, end;
};

struct lanes {
  const struct vg_timeline *t;
  size_t n_mark;
  struct mark *mark;  /* [n_mark], in existing lanes */
  size_t n;           /* number of workers */
  double offset, end; /* seconds: start of the engine; end of the run */
  double top, height; /* pixels: top of the lanes; height of one lane */
  struct vg_axis axis;
};

static size_t kind_of(char kind)
{
  size_t i = 0;

  while (i + 1 < N_KIND && kinds[i].kind != kind) i++;
  return i;
}

/* Marks of invalid workers are skipped, since the timeline may come from a test
 * or another program. */
static void add_mark(struct lanes *l, char kind, int rank, int thread,
                     double start, double end)
{
  size_t lane = (size_t)rank * (size_t)l->t->spans.n_thread + (size_t)thread;

  if (lane >= l->n) return;
  l->mark[l->n_mark++] = (struct mark){ kind_of(kind), lane, start, end };
}

static vg_status add_marks(struct lanes *l, struct vg_error *err)
{
  const struct vg_spans *s = &l->t->spans;

  l->mark = vg_alloc(s->n + s->n_help, sizeof *l->mark);
  if (!l->mark) return vg_fail_memory(err, "a figure");
  for (size_t i = 0; i < s->n; i++)
    add_mark(l, s->span[i].kind, s->span[i].rank, s->span[i].thread,
             s->span[i].start, s->span[i].end);
  for (size_t i = 0; i < s->n_help; i++)
    add_mark(l, HELP, s->help[i].rank, s->help[i].thread, s->help[i].start,
             s->help[i].end);
  return VG_OK;
}

static vg_status measure(const struct vg_timeline *t, struct lanes *l,
                         struct vg_error *err)
{
  const struct vg_spans *s = &t->spans;
  double after = 0, last = s->wall;

  memset(l, 0, sizeof *l);
  l->t = t;
  l->n = (size_t)s->n_rank * (size_t)s->n_thread;
  for (int i = 0; i < VG_PHASE_TOTAL; i++) {
    if (i < VG_PHASE_ENGINE) l->offset += t->seconds[i];
    if (i > VG_PHASE_ENGINE) after += t->seconds[i];
  }
  for (size_t i = 0; i < s->n; i++)
    if (s->span[i].end > last) last = s->span[i].end;
  l->end = l->offset + last + after;
  if (!(l->end > 1e-6)) l->end = 1e-6;
  l->height = LANES_HEIGHT_MAX / (double)l->n;
  if (l->height > 24) l->height = 24;
  l->top = 92;
  l->axis = vg_axis_linear(l->end, 9, LEFT, RIGHT);
  /* Nothing is drawn past the end, so the axis need not reach its last tick. */
  l->axis.hi = l->end;
  return add_marks(l, err);
}

/* Draw the stages outside the engine over all lanes. */
static void draw_stages(struct vg_svg *svg, const struct lanes *l)
{
  double at = 0, bottom = l->top + l->height * (double)l->n;

  for (int i = 0; i < VG_PHASE_TOTAL; i++) {
    const char *name = vg_phase_label((enum vg_phase)i);
    double took = i == VG_PHASE_ENGINE ? l->t->spans.wall : l->t->seconds[i];
    double x = vg_axis_at(&l->axis, at), w;

    at += took;
    w = vg_axis_at(&l->axis, at) - x;
    if (i == VG_PHASE_ENGINE || !(w > 0)) continue;
    vg_svg_rect(svg, x, l->top, w, bottom - l->top,
                i & 1 ? "#d4d4d4" : "#e2e2e2");
    if (w > vg_svg_width(name, 11) + 4)
      vg_svg_text(svg, x + w / 2, l->top - 5, 11, VG_SVG_MIDDLE, "#666666",
                  name);
  }
}

static void draw_tasks(struct vg_svg *svg, const struct lanes *l)
{
  double gap = l->height > 8 ? 2 : l->height > 4 ? 1 : 0;

  for (size_t k = 0; k < N_KIND; k++) {
    int any = 0;

    for (size_t i = 0; i < l->n_mark; i++) {
      const struct mark *one = &l->mark[i];
      double x = vg_axis_at(&l->axis, l->offset + one->start);
      double w = vg_axis_at(&l->axis, l->offset + one->end) - x;

      if (one->kind != k) continue;
      if (!any++) vg_svg_boxes_begin(svg, kinds[k].colour, gap ? 0.3 : 0);
      vg_svg_box(svg, x, l->top + l->height * (double)one->lane + gap,
                 w > 0.2 ? w : 0.2, l->height - 2 * gap);
    }
    if (any) vg_svg_boxes_end(svg);
  }
}

static int percent(double part, double whole)
{
  double v = 100 * part / whole + 0.5;

  return v > 0 && v < 1000 ? (int)v : v > 0 ? 999 : 0;
}

/* Draw names of lanes on the left and their busy percentages on the right,
 * skipping lanes where the text would overlap. */
static vg_status draw_names(struct vg_svg *svg, const struct lanes *l,
                            struct vg_error *err)
{
  const struct vg_spans *s = &l->t->spans;
  size_t every = (size_t)ceil(12.5 / l->height);
  double *busy = vg_calloc(l->n, sizeof *busy);
  char text[64];

  if (!busy) return vg_fail_memory(err, "a figure");
  for (size_t i = 0; i < l->n_mark; i++)
    busy[l->mark[i].lane] += l->mark[i].end - l->mark[i].start;
  if (every > 1 && s->n_thread > 1)
    every = (every + (size_t)s->n_thread - 1) / (size_t)s->n_thread *
            (size_t)s->n_thread;
  for (size_t i = 0; i < l->n; i += every) {
    double y = l->top + l->height * ((double)i + 0.5) + 4;
    size_t threads = (size_t)s->n_thread;

    if (threads > 1 && every == 1)
      snprintf(text, sizeof text, "rank %zu, thread %zu", i / threads,
               i % threads);
    else snprintf(text, sizeof text, "rank %zu", i / threads);
    vg_svg_text(svg, LEFT - 6, y, 11, VG_SVG_END, VG_SVG_TEXT, text);
    if (every > 1 || !(s->wall > 0)) continue;
    snprintf(text, sizeof text, "%d %%", percent(busy[i], s->wall));
    vg_svg_text(svg, RIGHT + 6, y, 11, VG_SVG_START, VG_SVG_TEXT, text);
  }
  if (every == 1 && s->wall > 0)
    vg_svg_text(svg, RIGHT + 6, l->top - 5, 11, VG_SVG_START, "#666666",
                "busy");
  free(busy);
  return VG_OK;
}

static void draw_keys(struct vg_svg *svg, const struct lanes *l)
{
  double time[N_KIND] = { 0 }, sum = 0, x = LEFT;
  char text[64];

  for (size_t i = 0; i < l->n_mark; i++) {
    double took = l->mark[i].end - l->mark[i].start;

    time[l->mark[i].kind] += took;
    sum += took;
  }
  for (size_t k = 0; k < N_KIND; k++) {
    if (!(time[k] > 0)) continue;
    snprintf(text, sizeof text, "%s %d.%d %%", kinds[k].name,
             (int)(1000 * time[k] / sum + 0.5) / 10,
             (int)(1000 * time[k] / sum + 0.5) % 10);
    x = vg_svg_key(svg, x, 66, kinds[k].colour, text);
  }
  if (x == LEFT) return;
  x = vg_svg_key(svg, x, 66, "#d4d4d4", "other stages");
}

/* Format a number with two decimals, independently of the locale. */
static char *two_decimals(double v, char text[32])
{
  long long n = v > 0 && v < 1e15 ? (long long)(v * 100 + 0.5) : 0;

  snprintf(text, 32, "%lld.%02d", n / 100, (int)(n % 100));
  return text;
}

vg_status vg_plot_timeline(const char *path, const struct vg_timeline *t,
                           struct vg_error *err)
{
  struct vg_svg svg = VG_SVG_INIT;
  struct lanes l;
  char subtitle[256], wall[32], imbalance[32], count[32];
  double bottom;
  vg_status st;

  VG_TRY(measure(t, &l, err));
  bottom = l.top + l.height * (double)l.n;
  snprintf(subtitle, sizeof subtitle,
           "%d rank%s x %d thread%s, %s cells, %zu "
           "tasks; cut and fill %s s, workers %d %% busy, imbalance %s",
           (int)t->spans.n_rank, t->spans.n_rank > 1 ? "s" : "",
           (int)t->spans.n_thread, t->spans.n_thread > 1 ? "s" : "",
           vg_text_count((unsigned long long)t->n_cell, count), t->spans.n,
           two_decimals(t->spans.wall, wall),
           percent(vg_spans_busy(&t->spans), 1),
           two_decimals(vg_spans_imbalance(&t->spans), imbalance));
  VG_TRY(vg_svg_open(path, WIDTH, bottom + 48, t->title, subtitle, &svg, err));
  draw_keys(&svg, &l);
  draw_stages(&svg, &l);
  vg_axis_draw_x(&svg, &l.axis, bottom, l.top, "time, s");
  draw_tasks(&svg, &l);
  VG_TRY(draw_names(&svg, &l, err));
  VG_TRY(vg_svg_close(&svg, err));
done:
  free(l.mark);
  vg_svg_release(&svg);
  return st;
}

/* --- sizes --------------------------------------------------------------- */

struct sizes {
  size_t n;
  double *cells, sum;
};

static int by_size(const void *a, const void *b)
{
  double s = *(const double *)a, t = *(const double *)b;

  return (s > t) - (s < t);
}

static vg_status leaf_sizes(const struct vg_spans *spans, struct sizes *out,
                            struct vg_error *err)
{
  out->n = 0;
  out->sum = 0;
  out->cells = vg_alloc(spans->n, sizeof *out->cells);
  if (!out->cells) return vg_fail_memory(err, "a figure");
  for (size_t i = 0; i < spans->n; i++) {
    if (spans->span[i].kind != VG_SPAN_LEAF) continue;
    out->cells[out->n++] = (double)spans->span[i].n_cell;
    out->sum += (double)spans->span[i].n_cell;
  }
  qsort(out->cells, out->n, sizeof *out->cells, by_size);
  return VG_OK;
}

static void mark(struct vg_svg *svg, const struct vg_axis *x, double v,
                 double y, const char *colour, const char *word)
{
  double at = vg_axis_at(x, v);
  char text[64], number[32];
  int right = at < (x->from + x->to) / 2;

  vg_svg_line(svg, (const double[2]){ at, y - 12 },
              (const double[2]){ at, 370 }, colour, 1.5, 1);
  snprintf(text, sizeof text, "%s %s", word, vg_svg_number(v, number));
  vg_svg_text(svg, at + (right ? 5 : -5), y - 3, 11,
              right ? VG_SVG_START : VG_SVG_END, colour, text);
}

static void draw_bins(struct vg_svg *svg, const struct sizes *z, double target)
{
  double most = z->n ? z->cells[z->n - 1] : 1, width;
  struct vg_axis x, y;
  size_t bin[N_BIN] = { 0 }, high = 1;

  if (target > most) most = target;
  x = vg_axis_linear(most, 8, 70, 610);
  width = x.hi / N_BIN;
  for (size_t i = 0; i < z->n; i++) {
    size_t k = (size_t)(z->cells[i] / width);

    if (++bin[k < N_BIN ? k : N_BIN - 1] > high)
      high = bin[k < N_BIN ? k : N_BIN - 1];
  }
  y = vg_axis_linear((double)high, 5, 370, 110);
  if (y.step < 1) y = vg_axis_linear((double)high, (int)high, 370, 110);
  vg_axis_draw_y(svg, &y, 70, 610, "leaves");
  vg_axis_draw_x(svg, &x, 370, 370, "cells per leaf");
  for (int k = 0; k < N_BIN; k++) {
    double from = vg_axis_at(&x, k * width);
    double top = vg_axis_at(&y, (double)bin[k]);

    if (bin[k])
      vg_svg_rect(svg, from + 0.5, top,
                  vg_axis_at(&x, (k + 1) * width) - from - 1, 370 - top,
                  VG_SVG_ORANGE);
  }
  if (z->n)
    mark(svg, &x, floor(z->sum / (double)z->n + 0.5), 105, VG_SVG_BLUE, "mean");
  if (target > 0) mark(svg, &x, target, 89, VG_SVG_RED, "requested");
}

vg_status vg_plot_sizes(const char *path, const struct vg_timeline *t,
                        double target, struct vg_error *err)
{
  struct vg_svg svg = VG_SVG_INIT;
  struct sizes z = { 0, NULL, 0 };
  char subtitle[256], low[32], high[32], middle[32];
  vg_status st;

  VG_TRY(leaf_sizes(&t->spans, &z, err));
  if (z.n)
    snprintf(subtitle, sizeof subtitle,
             "%zu leaves: smallest %s cells, "
             "median %s, largest %s",
             z.n, vg_svg_number(z.cells[0], low),
             vg_svg_number(z.cells[z.n / 2], middle),
             vg_svg_number(z.cells[z.n - 1], high));
  else snprintf(subtitle, sizeof subtitle, "no leaves");
  VG_TRY(vg_svg_open(path, 640, 420, t->title, subtitle, &svg, err));
  draw_bins(&svg, &z, target);
  VG_TRY(vg_svg_close(&svg, err));
done:
  vg_svg_release(&svg);
  free(z.cells);
  return st;
}
