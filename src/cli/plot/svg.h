/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/plot/svg.h: shapes, text and axes of a plot in an SVG file. Numbers are
 * written with two decimals and independently of the locale, so that equal data
 * give equal bytes. */
#ifndef VG_CLI_PLOT_SVG_H
#define VG_CLI_PLOT_SVG_H

#include <stddef.h>

#include "base/status.h"
#include "io/stream/stream.h"

/* Greys of lines and text; the palette of Okabe and Ito, whose colours can be
 * distinguished with any kind of colour vision. */
#define VG_SVG_GRID "#e4e4e4"
#define VG_SVG_AXIS "#8a8a8a"
#define VG_SVG_TEXT "#333333"
#define VG_SVG_BLUE "#0072b2"
#define VG_SVG_SKY "#56b4e9"
#define VG_SVG_ORANGE "#e69f00"
#define VG_SVG_RED "#d55e00"
#define VG_SVG_GREEN "#009e73"
#define VG_SVG_PURPLE "#cc79a7"
#define VG_SVG_YELLOW "#f0e442"
#define VG_SVG_GREY "#9a9a9a"

enum vg_svg_anchor { VG_SVG_START, VG_SVG_MIDDLE, VG_SVG_END };

struct vg_svg {
  struct vg_output out;
};
#define VG_SVG_INIT                                                            \
  {                                                                            \
    VG_OUTPUT_INIT                                                             \
  }

/** Start a plot of w x h pixels on white, with a title (also for screen
 * readers) and a subtitle; either may be "". */
vg_status vg_svg_open(const char *path, double w, double h, const char *title,
                      const char *subtitle, struct vg_svg *s,
                      struct vg_error *err);

/** Finish the plot and commit the file. Releases *s. */
vg_status vg_svg_close(struct vg_svg *s, struct vg_error *err);

/** Discard the plot unless it is closed. Accepts VG_SVG_INIT. */
void vg_svg_release(struct vg_svg *s);

void vg_svg_rect(struct vg_svg *s, double x, double y, double w, double h,
                 const char *fill);
void vg_svg_line(struct vg_svg *s, const double from[2], const double to[2],
                 const char *stroke, double width, int dashed);
void vg_svg_polyline(struct vg_svg *s, size_t n, const double (*at)[2],
                     const char *stroke, double width, int dashed);
void vg_svg_dot(struct vg_svg *s, double x, double y, double radius,
                const char *fill);
void vg_svg_text(struct vg_svg *s, double x, double y, double size,
                 enum vg_svg_anchor anchor, const char *fill, const char *text);

/** Many boxes of one colour in one element; gap: width of the white outline of
 * each box. */
void vg_svg_boxes_begin(struct vg_svg *s, const char *fill, double gap);
void vg_svg_box(struct vg_svg *s, double x, double y, double w, double h);
void vg_svg_boxes_end(struct vg_svg *s);

/** A legend entry: a coloured square and a word. Returns the x of the next
 * entry. */
double vg_svg_key(struct vg_svg *s, double x, double y, const char *fill,
                  const char *text);

/** Approximate width of text in pixels. */
double vg_svg_width(const char *text, double size);

/* An axis maps lo .. hi to pixels from .. to, with ticks at multiples of step
 * or, if it is logarithmic (lo >= 1), at powers of 2. */
struct vg_axis {
  double lo, hi, step, from, to;
  int is_log;
};

/** A linear axis from 0 to at least `most`, with about n ticks. */
struct vg_axis vg_axis_linear(double most, int n, double from, double to);

/** A linear axis from `least` or less to `most` or more, with about n ticks. */
struct vg_axis vg_axis_range(double least, double most, int n, double from,
                             double to);

/** A logarithmic axis from 1 to the smallest power of 2 not below `most`. */
struct vg_axis vg_axis_log(double most, double from, double to);

double vg_axis_at(const struct vg_axis *a, double v);

/** Draw grid lines and labels. y: position of the axis; top: end of the grid
 * lines. */
void vg_axis_draw_x(struct vg_svg *s, const struct vg_axis *a, double y,
                    double top, const char *label);
void vg_axis_draw_y(struct vg_svg *s, const struct vg_axis *a, double x,
                    double right, const char *label);

/** Format a number for a label, as 0.25, 3, 20k, 1.5M, in text[32]; returns
 * text. */
char *vg_svg_number(double v, char *text);

#endif
