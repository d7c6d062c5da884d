/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Plots that compare several runs: speed-up and phases. */
#include "cli/plot/plot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "cli/plot/svg.h"

#define LABEL_HEIGHT 15.0

static const char *const colours[] = { VG_SVG_BLUE,   VG_SVG_RED,
                                       VG_SVG_GREEN,  VG_SVG_PURPLE,
                                       VG_SVG_ORANGE, VG_SVG_SKY,
                                       "#000000" };
#define N_COLOUR (sizeof colours / sizeof *colours)

static const char *const phase_colours[VG_PHASE_TOTAL] = {
  "#c8c8c8",   VG_SVG_GREY, VG_SVG_YELLOW, VG_SVG_ORANGE,
  VG_SVG_BLUE, VG_SVG_SKY,  VG_SVG_PURPLE, VG_SVG_GREEN
};

/* Label at the end of a curve. */
struct label {
  double y;
  const char *text, *colour;
};

static int by_height(const void *a, const void *b)
{
  const struct label *s = a, *t = b;

  return (s->y > t->y) - (s->y < t->y);
}

/* Separate overlapping labels: move them down, then up again from the
 * bottom. */
static void spread(size_t n, struct label *l, double bottom)
{
  qsort(l, n, sizeof *l, by_height);
  for (size_t i = 1; i < n; i++)
    if (l[i].y < l[i - 1].y + LABEL_HEIGHT) l[i].y = l[i - 1].y + LABEL_HEIGHT;
  for (size_t i = n; i-- > 0;) {
    double limit = i + 1 < n ? l[i + 1].y - LABEL_HEIGHT : bottom;

    if (l[i].y > limit) l[i].y = limit;
  }
}

static void draw_series(struct vg_svg *svg, const struct vg_plot_series *s,
                        const struct vg_axis *x, const struct vg_axis *y,
                        double (*at)[2])
{
  const char *colour = colours[(size_t)s->colour % N_COLOUR];

  for (size_t i = 0; i < s->n; i++) {
    at[i][0] = vg_axis_at(x, s->workers[i]);
    at[i][1] = vg_axis_at(y, s->speedup[i]);
  }
  if (s->n > 1)
    vg_svg_polyline(svg, s->n, (const double(*)[2])at, colour,
                    s->is_model ? 1.5 : 2, s->is_model);
  for (size_t i = 0; i < s->n && !s->is_model; i++)
    vg_svg_dot(svg, at[i][0], at[i][1], 4, colour);
}

static void limits(size_t n, const struct vg_plot_series *series,
                   double *workers, double *speedup, size_t *longest)
{
  *workers = *speedup = 1;
  *longest = 0;
  for (size_t i = 0; i < n; i++) {
    if (series[i].n > *longest) *longest = series[i].n;
    for (size_t k = 0; k < series[i].n; k++) {
      if (series[i].workers[k] > *workers) *workers = series[i].workers[k];
      if (series[i].speedup[k] > *speedup) *speedup = series[i].speedup[k];
    }
  }
  if (*workers > *speedup) *speedup = *workers;
}

static void draw_ideal(struct vg_svg *svg, const struct vg_axis *x,
                       const struct vg_axis *y, double most,
                       struct label *label)
{
  const double from[2] = { vg_axis_at(x, 1), vg_axis_at(y, 1) };
  const double to[2] = { vg_axis_at(x, most), vg_axis_at(y, most) };

  vg_svg_line(svg, from, to, VG_SVG_AXIS, 1.2, 0);
  label->y = to[1] + 4;
  label->text = "ideal";
  label->colour = "#666666";
}

vg_status vg_plot_speedup(const char *path, const char *title,
                          const char *subtitle, size_t n,
                          const struct vg_plot_series *series,
                          struct vg_error *err)
{
  struct vg_svg svg = VG_SVG_INIT;
  struct vg_axis x, y;
  struct label *label = vg_alloc(n + 1, sizeof *label);
  double most, high, (*at)[2] = NULL;
  size_t longest, n_label = 1;
  vg_status st;

  limits(n, series, &most, &high, &longest);
  at = vg_alloc(longest, sizeof *at);
  if (!label || !at) {
    st = vg_fail_memory(err, "a figure");
    goto done;
  }
  VG_TRY(vg_svg_open(path, 760, 520, title, subtitle, &svg, err));
  x = most > 16 ? vg_axis_log(most, 70, 560) : vg_axis_linear(most, 8, 70, 560);
  if (!x.is_log && x.step < 1) x = vg_axis_linear(most, (int)most, 70, 560);
  y = most > 16 ? vg_axis_log(high, 460, 64) : vg_axis_linear(high, 8, 460, 64);
  vg_axis_draw_y(&svg, &y, 70, 560, "speed-up");
  vg_axis_draw_x(&svg, &x, 460, 64, "workers (ranks x threads)");
  draw_ideal(&svg, &x, &y, most, &label[0]);
  for (size_t i = 0; i < n; i++) {
    const struct vg_plot_series *s = &series[i];

    if (!s->n) continue;
    draw_series(&svg, s, &x, &y, at);
    label[n_label].y = at[s->n - 1][1] + 4;
    label[n_label].text = s->label;
    label[n_label++].colour = colours[(size_t)s->colour % N_COLOUR];
  }
  spread(n_label, label, 460);
  for (size_t i = 0; i < n_label; i++)
    vg_svg_text(&svg, 570, label[i].y, 11.5, VG_SVG_START, label[i].colour,
                label[i].text);
  VG_TRY(vg_svg_close(&svg, err));
done:
  vg_svg_release(&svg);
  free(label);
  free(at);
  return st;
}

/* --- phases -------------------------------------------------------------- */

static double length(const struct vg_plot_bar *bar)
{
  double sum = 0;

  for (int i = 0; i < VG_PHASE_TOTAL; i++) sum += bar->seconds[i];
  return sum > bar->seconds[VG_PHASE_TOTAL] ? sum
                                            : bar->seconds[VG_PHASE_TOTAL];
}

static void draw_bar(struct vg_svg *svg, const struct vg_plot_bar *bar,
                     const struct vg_axis *x, double y)
{
  double at = 0, end = vg_axis_at(x, length(bar));
  char text[40], number[32];

  vg_svg_text(svg, x->from - 8, y + 14, 11.5, VG_SVG_END, VG_SVG_TEXT,
              bar->label);
  vg_svg_rect(svg, x->from, y, end - x->from, 20, "#eeeeee");
  for (int i = 0; i < VG_PHASE_TOTAL; i++) {
    double from = vg_axis_at(x, at);

    at += bar->seconds[i];
    if (bar->seconds[i] > 0)
      vg_svg_rect(svg, from, y, vg_axis_at(x, at) - from, 20, phase_colours[i]);
  }
  snprintf(text, sizeof text, "%s s", vg_svg_number(length(bar), number));
  vg_svg_text(svg, end + 6, y + 14, 11.5, VG_SVG_START, VG_SVG_TEXT, text);
}

vg_status vg_plot_phases(const char *path, const char *title, size_t n,
                         const struct vg_plot_bar *bar, struct vg_error *err)
{
  struct vg_svg svg = VG_SVG_INIT;
  struct vg_axis x;
  double most = 0, left = 40, bottom = 80 + 26 * (double)n, key;
  vg_status st;

  for (size_t i = 0; i < n; i++) {
    double width = vg_svg_width(bar[i].label, 11.5) + 24;

    if (length(&bar[i]) > most) most = length(&bar[i]);
    if (width > left) left = width < 400 ? width : 400;
  }
  VG_TRY(vg_svg_open(path, left + 760, bottom + 48, title, "", &svg, err));
  x = vg_axis_linear(most, 8, left, left + 690);
  vg_axis_draw_x(&svg, &x, bottom, 70, "time, s");
  key = left;
  for (int i = 0; i < VG_PHASE_TOTAL; i++)
    key = vg_svg_key(&svg, key, 54, phase_colours[i],
                     vg_phase_label((enum vg_phase)i));
  vg_svg_key(&svg, key, 54, "#eeeeee", "rest");
  for (size_t i = 0; i < n; i++)
    draw_bar(&svg, &bar[i], &x, 76 + 26 * (double)i);
  VG_TRY(vg_svg_close(&svg, err));
done:
  vg_svg_release(&svg);
  return st;
}
