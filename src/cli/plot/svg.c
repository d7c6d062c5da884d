/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "cli/plot/svg.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/common/text.h"

#define FONT "font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\""
#define LABEL_SIZE 11.0
#define COORDINATE_MAX 1e9 /* pixels; larger coordinates are clamped */

/* A coordinate with at most two decimals. */
static void put(struct vg_svg *s, double v)
{
  long long n;
  char text[32];
  int len;

  if (!(v > -COORDINATE_MAX)) v = -COORDINATE_MAX;
  if (v > COORDINATE_MAX) v = COORDINATE_MAX;
  n = (long long)floor(v * 100 + 0.5);
  len = snprintf(text, sizeof text, "%s%lld.%02d", n < 0 ? "-" : "",
                 (n < 0 ? -n : n) / 100, (int)((n < 0 ? -n : n) % 100));
  while (text[len - 1] == '0') text[--len] = 0;
  if (text[len - 1] == '.') text[--len] = 0;
  vg_output_text(&s->out, text);
}

static void attribute(struct vg_svg *s, const char *name, double v)
{
  vg_output_format(&s->out, " %s=\"", name);
  put(s, v);
  vg_output_text(&s->out, "\"");
}

/* Write text as XML permits it: UTF-8, no control characters, markup
 * escaped. */
static void put_text(struct vg_svg *s, const char *text)
{
  char *clean = vg_text_copy(text);

  if (clean) vg_output_markup(&s->out, clean);
  free(clean);
}

vg_status vg_svg_open(const char *path, double w, double h, const char *title,
                      const char *subtitle, struct vg_svg *s,
                      struct vg_error *err)
{
  vg_status st = vg_output_open(path, &s->out, err);

  if (st < 0) return st;
  vg_output_text(&s->out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
                          "<svg xmlns=\"http://www.w3.org/2000/svg\" " FONT);
  attribute(s, "width", w);
  attribute(s, "height", h);
  vg_output_text(&s->out, " viewBox=\"0 0 ");
  put(s, w);
  vg_output_text(&s->out, " ");
  put(s, h);
  vg_output_text(&s->out, "\">\n<title>");
  put_text(s, title);
  vg_output_text(&s->out, "</title>\n");
  vg_svg_rect(s, 0, 0, w, h, "#ffffff");
  if (*title) {
    vg_output_text(&s->out, "<g font-weight=\"bold\">");
    vg_svg_text(s, 16, 26, 15, VG_SVG_START, VG_SVG_TEXT, title);
    vg_output_text(&s->out, "</g>\n");
  }
  if (*subtitle) vg_svg_text(s, 16, 44, 12, VG_SVG_START, "#666666", subtitle);
  return VG_OK;
}

vg_status vg_svg_close(struct vg_svg *s, struct vg_error *err)
{
  vg_output_text(&s->out, "</svg>\n");
  return vg_output_commit(&s->out, err);
}

void vg_svg_release(struct vg_svg *s)
{
  vg_output_release(&s->out);
}

void vg_svg_rect(struct vg_svg *s, double x, double y, double w, double h,
                 const char *fill)
{
  vg_output_text(&s->out, "<rect");
  attribute(s, "x", x);
  attribute(s, "y", y);
  attribute(s, "width", w > 0 ? w : 0);
  attribute(s, "height", h > 0 ? h : 0);
  vg_output_format(&s->out, " fill=\"%s\"/>\n", fill);
}

static void stroke_of(struct vg_svg *s, const char *stroke, double width,
                      int dashed)
{
  vg_output_format(&s->out, " stroke=\"%s\"", stroke);
  attribute(s, "stroke-width", width);
  if (dashed) vg_output_text(&s->out, " stroke-dasharray=\"6 4\"");
  vg_output_text(&s->out, "/>\n");
}

void vg_svg_line(struct vg_svg *s, const double from[2], const double to[2],
                 const char *stroke, double width, int dashed)
{
  vg_output_text(&s->out, "<line");
  attribute(s, "x1", from[0]);
  attribute(s, "y1", from[1]);
  attribute(s, "x2", to[0]);
  attribute(s, "y2", to[1]);
  stroke_of(s, stroke, width, dashed);
}

void vg_svg_polyline(struct vg_svg *s, size_t n, const double (*at)[2],
                     const char *stroke, double width, int dashed)
{
  vg_output_text(&s->out, "<polyline fill=\"none\" stroke-linejoin=\"round\" "
                          "points=\"");
  for (size_t i = 0; i < n; i++) {
    if (i) vg_output_text(&s->out, " ");
    put(s, at[i][0]);
    vg_output_text(&s->out, ",");
    put(s, at[i][1]);
  }
  vg_output_text(&s->out, "\"");
  stroke_of(s, stroke, width, dashed);
}

void vg_svg_dot(struct vg_svg *s, double x, double y, double radius,
                const char *fill)
{
  vg_output_text(&s->out, "<circle");
  attribute(s, "cx", x);
  attribute(s, "cy", y);
  attribute(s, "r", radius);
  vg_output_format(&s->out, " fill=\"%s\" stroke=\"#ffffff\"/>\n", fill);
}

void vg_svg_text(struct vg_svg *s, double x, double y, double size,
                 enum vg_svg_anchor anchor, const char *fill, const char *text)
{
  static const char *const names[] = { "start", "middle", "end" };

  vg_output_text(&s->out, "<text");
  attribute(s, "x", x);
  attribute(s, "y", y);
  attribute(s, "font-size", size);
  vg_output_format(&s->out, " text-anchor=\"%s\" fill=\"%s\">", names[anchor],
                   fill);
  put_text(s, text);
  vg_output_text(&s->out, "</text>\n");
}

/* Text rotated to read upwards, centred at x, y. */
static void text_up(struct vg_svg *s, double x, double y, double size,
                    const char *fill, const char *text)
{
  vg_output_text(&s->out, "<g transform=\"translate(");
  put(s, x);
  vg_output_text(&s->out, " ");
  put(s, y);
  vg_output_text(&s->out, ") rotate(-90)\">");
  vg_svg_text(s, 0, 0, size, VG_SVG_MIDDLE, fill, text);
  vg_output_text(&s->out, "</g>\n");
}

void vg_svg_boxes_begin(struct vg_svg *s, const char *fill, double gap)
{
  vg_output_format(&s->out, "<path fill=\"%s\"", fill);
  if (gap > 0) {
    vg_output_text(&s->out, " stroke=\"#ffffff\"");
    attribute(s, "stroke-width", gap);
  }
  vg_output_text(&s->out, " d=\"");
}

void vg_svg_box(struct vg_svg *s, double x, double y, double w, double h)
{
  vg_output_text(&s->out, "M");
  put(s, x);
  vg_output_text(&s->out, " ");
  put(s, y);
  vg_output_text(&s->out, "h");
  put(s, w);
  vg_output_text(&s->out, "v");
  put(s, h);
  vg_output_text(&s->out, "h");
  put(s, -w);
  vg_output_text(&s->out, "z\n");
}

void vg_svg_boxes_end(struct vg_svg *s)
{
  vg_output_text(&s->out, "\"/>\n");
}

double vg_svg_width(const char *text, double size)
{
  size_t n = 0;

  for (; *text; text++)
    if ((*text & 0xc0) != 0x80) n++;
  return 0.56 * size * (double)n;
}

double vg_svg_key(struct vg_svg *s, double x, double y, const char *fill,
                  const char *text)
{
  vg_svg_rect(s, x, y - 9, 10, 10, fill);
  vg_svg_text(s, x + 15, y, LABEL_SIZE + 0.5, VG_SVG_START, VG_SVG_TEXT, text);
  return x + 15 + vg_svg_width(text, LABEL_SIZE + 0.5) + 16;
}

/* --- axes ---------------------------------------------------------------- */

/* The least of 1, 2, 5, 10, ... that is not below range / n. */
static double step_of(double range, int n)
{
  double step = 1, wanted;

  if (!(range > 1e-9)) range = 1e-9;
  if (range > 1e30) range = 1e30;
  wanted = range / n;
  while (step > wanted) step /= 10;
  while (step * 10 <= wanted) step *= 10;
  return wanted <= step     ? step
       : wanted <= 2 * step ? 2 * step
       : wanted <= 5 * step ? 5 * step
                            : 10 * step;
}

struct vg_axis vg_axis_linear(double most, int n, double from, double to)
{
  struct vg_axis a = { 0, 1, step_of(most, n), from, to, 0 };

  if (!(most > 1e-9)) most = 1e-9;
  if (most > 1e30) most = 1e30;
  a.hi = a.step * ceil(most / a.step * (1 - 1e-9));
  return a;
}

struct vg_axis vg_axis_range(double least, double most, int n, double from,
                             double to)
{
  struct vg_axis a = { 0, 1, step_of(most - least, n), from, to, 0 };

  a.lo = a.step * floor(fmax(least, -1e30) / a.step);
  a.hi = a.step * ceil(fmin(most, 1e30) / a.step);
  if (a.hi <= a.lo) a.hi = a.lo + a.step;
  return a;
}

struct vg_axis vg_axis_log(double most, double from, double to)
{
  struct vg_axis a = { 1, 2, 2, from, to, 1 };

  while (a.hi < most && a.hi < 1e9) a.hi *= 2;
  return a;
}

double vg_axis_at(const struct vg_axis *a, double v)
{
  double part;

  if (a->is_log) part = log2(v > 1e-3 ? v : 1e-3) / log2(a->hi);
  else part = (v - a->lo) / (a->hi - a->lo);
  return a->from + part * (a->to - a->from);
}

static double next_tick(const struct vg_axis *a, double v, int i)
{
  return a->is_log ? v * 2 : a->lo + a->step * (i + 1);
}

static int is_within(const struct vg_axis *a, double v)
{
  return v <= (a->is_log ? a->hi * (1 + 1e-9) : a->hi + 1e-9 * a->step);
}

void vg_axis_draw_x(struct vg_svg *s, const struct vg_axis *a, double y,
                    double top, const char *label)
{
  double v = a->lo;
  char text[32];

  for (int i = 0; is_within(a, v); v = next_tick(a, v, i++)) {
    double x = vg_axis_at(a, v);
    const double from[2] = { x, y }, to[2] = { x, top };

    vg_svg_line(s, from, to, VG_SVG_GRID, 1, 0);
    vg_svg_text(s, x, y + 15, LABEL_SIZE, VG_SVG_MIDDLE, VG_SVG_TEXT,
                vg_svg_number(v, text));
  }
  vg_svg_line(s, (const double[2]){ a->from, y }, (const double[2]){ a->to, y },
              VG_SVG_AXIS, 1, 0);
  vg_svg_text(s, (a->from + a->to) / 2, y + 33, 12, VG_SVG_MIDDLE, VG_SVG_TEXT,
              label);
}

void vg_axis_draw_y(struct vg_svg *s, const struct vg_axis *a, double x,
                    double right, const char *label)
{
  double v = a->lo;
  char text[32];

  for (int i = 0; is_within(a, v); v = next_tick(a, v, i++)) {
    double y = vg_axis_at(a, v);
    const double from[2] = { x, y }, to[2] = { right, y };

    vg_svg_line(s, from, to, VG_SVG_GRID, 1, 0);
    vg_svg_text(s, x - 6, y + 4, LABEL_SIZE, VG_SVG_END, VG_SVG_TEXT,
                vg_svg_number(v, text));
  }
  text_up(s, x - 42, (a->from + a->to) / 2, 12, VG_SVG_TEXT, label);
}

char *vg_svg_number(double v, char *text)
{
  static const struct {
    double unit;
    const char *letter;
  } units[] = {
    { 1e9, "G" },
    { 1e6, "M" },
    { 1e4, "k" },
  };
  const char *letter = "";
  double milli;
  size_t len;

  if (!isfinite(v)) v = 0;
  for (size_t i = 0; i < 3; i++)
    if (fabs(v) >= units[i].unit * (1 - 1e-9)) {
      v /= units[i].unit == 1e4 ? 1e3 : units[i].unit;
      letter = units[i].letter;
      break;
    }
  if (fabs(v) > 1e12) v = v > 0 ? 1e12 : -1e12;
  milli = *letter ? 10 * floor(fabs(v) * 100 + 0.5)
                  : floor(fabs(v) * 1000 + 0.5);
  if (*letter == 'k') milli = 100 * floor(fabs(v) * 10 + 0.5);
  snprintf(text, 32, "%s%lld.%03d", v < 0 && milli > 0 ? "-" : "",
           (long long)milli / 1000, (int)((long long)milli % 1000));
  len = strlen(text);
  while (text[len - 1] == '0') text[--len] = 0;
  if (text[len - 1] == '.') text[--len] = 0;
  snprintf(text + len, 32 - len, "%s", letter);
  return text;
}
