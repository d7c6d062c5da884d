/* cli/plot/svg.h: what figures are made of: shapes, text and axes in an SVG
 * file. Numbers have two decimals and no locale, so equal data make equal
 * bytes. */
#ifndef VG_CLI_PLOT_SVG_H
#define VG_CLI_PLOT_SVG_H

#include <stddef.h>

#include "base/status.h"
#include "io/stream/stream.h"

/* Grey of lines and text; the palette of Okabe and Ito, which people with any
 * kind of colour vision can tell apart. */
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

/** Start a figure of w x h pixels on white, with a title (also for screen
 * readers) and a line below it, either may be "". */
vg_status vg_svg_open(const char *path, double w, double h, const char *title,
                      const char *subtitle, struct vg_svg *s,
                      struct vg_error *err);

/** End it; the file gets its name. Releases *s. */
vg_status vg_svg_close(struct vg_svg *s, struct vg_error *err);

/** Drop it unless closed. Accepts an initialised one. */
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

/** Many boxes of one colour in one element; gap: width of the white line
 * around each. */
void vg_svg_boxes_begin(struct vg_svg *s, const char *fill, double gap);
void vg_svg_box(struct vg_svg *s, double x, double y, double w, double h);
void vg_svg_boxes_end(struct vg_svg *s);

/** A square of a colour with a word; returns where the next one goes. */
double vg_svg_key(struct vg_svg *s, double x, double y, const char *fill,
                  const char *text);

/** Width of text in pixels, about. */
double vg_svg_width(const char *text, double size);

/* An axis maps lo .. hi to pixels from .. to; ticks at multiples of step, or
 * at powers of 2 where it is logarithmic (then lo >= 1). */
struct vg_axis {
  double lo, hi, step, from, to;
  int is_log;
};

/** An axis from 0 to `most` or a little beyond, with about n ticks. */
struct vg_axis vg_axis_linear(double most, int n, double from, double to);

/** An axis from 1 to the power of 2 at or above `most`. */
struct vg_axis vg_axis_log(double most, double from, double to);

double vg_axis_at(const struct vg_axis *a, double v);

/** Grid lines and labels. y: where the axis is; top: to where lines go. */
void vg_axis_draw_x(struct vg_svg *s, const struct vg_axis *a, double y,
                    double top, const char *label);
void vg_axis_draw_y(struct vg_svg *s, const struct vg_axis *a, double x,
                    double right, const char *label);

/** A number for a label: 0.25, 3, 20k, 1.5M; text[32]; returns text. */
char *vg_svg_number(double v, char *text);

#endif
