/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Histograms as SVG, in the colours of the page. */
#include <math.h>

#include "cli/html/page.h"

enum {
  WIDTH = 460,
  HEIGHT = 210,
  LEFT = 52,
  RIGHT = 10,
  TOP = 14,
  BOTTOM = 34
};

/* Decimal logarithm, exact at integers times powers of ten and linear between
 * them: the same on every machine, and accurate enough for drawing. v >= 1. */
static double decades_of(double v)
{
  static const double log_digit[10] = { 0,       0.30103, 0.47712, 0.60206,
                                        0.69897, 0.77815, 0.8451,  0.90309,
                                        0.95424, 1 };
  double n = 0;
  int digit;

  for (; v >= 10; v /= 10) n++;
  digit = (int)v;
  return n + log_digit[digit - 1] +
         (v - digit) * (log_digit[digit] - log_digit[digit - 1]);
}

/* Height of a bar; counts have a logarithmic scale, since poor cells are
 * rare. */
static double height_of(double count, double decades)
{
  return count >= 1
         ? (HEIGHT - TOP - BOTTOM) * (decades_of(count) + 0.3) / (decades + 0.3)
         : 0;
}

/* Begin of bin i; of equal ratios: `lowest` times a power of 2^(1/4). */
static double begin_of(const struct bars *b, size_t i)
{
  static const double root[4] = { 1, 1.189207115002721, 1.4142135623730951,
                                  1.681792830507429 };
  size_t quarter;

  if (!(b->lowest > 0)) return b->step * (double)i;
  quarter = i * (size_t)(4 / b->per_octave);
  return ldexp(b->lowest * root[quarter % 4], (int)(quarter / 4));
}

/* Number of bins from one label to the next. */
static size_t label_each(const struct bars *b, size_t n)
{
  if (b->lowest > 0) return 2 * (size_t)b->per_octave;
  return n > 20 ? 6 : 4;
}

static void axes(struct page *p, const struct bars *b, size_t n, double decades)
{
  double wide = (WIDTH - LEFT - RIGHT) / (double)n;
  size_t each = label_each(b, n);
  double at = 1;

  for (int d = 0; d <= (int)decades; d++, at *= 10) {
    int y = (int)(HEIGHT - BOTTOM - height_of(at, decades));

    vg_page_format(p,
                   "<path class=\"grid\" d=\"M%d %dH%d\"/>"
                   "<text x=\"%d\" y=\"%d\" class=\"end\">",
                   LEFT, y, WIDTH - RIGHT, LEFT - 6, y + 4);
    if (d < 4) vg_page_format(p, "%.0f</text>", at);
    else
      vg_page_format(p, "10<tspan dy=\"-4\" class=\"up\">%d</tspan></text>", d);
  }
  for (size_t i = 0; i <= n; i += each) {
    vg_page_format(p, "<text x=\"%d\" y=\"%d\" class=\"middle\">",
                   (int)(LEFT + wide * (double)i), HEIGHT - BOTTOM + 15);
    if (b->lowest > 0) vg_page_real(p, begin_of(b, i), 3);
    else vg_page_fixed(p, begin_of(b, i), b->decimals);
    vg_page_markup(p, "</text>");
  }
  vg_page_format(p, "<text x=\"%d\" y=\"%d\" class=\"middle\">%s</text>",
                 (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 4, b->unit);
}

static void bar(struct page *p, const struct bars *b, size_t i, size_t n,
                double count, double decades)
{
  double wide = (WIDTH - LEFT - RIGHT) / (double)n;
  double low = begin_of(b, i), high = begin_of(b, i + 1);
  double height = height_of(count, decades);
  int is_bad = high <= b->bad_below + 1e-9 || low >= b->bad_from - 1e-9;

  if (!(count > 0)) return;
  vg_page_format(p, "<rect class=\"%s\" x=\"", is_bad ? "bad" : "bar");
  vg_page_fixed(p, LEFT + wide * (double)i + 0.5, 1);
  vg_page_markup(p, "\" y=\"");
  vg_page_fixed(p, HEIGHT - BOTTOM - height, 1);
  vg_page_markup(p, "\" width=\"");
  vg_page_fixed(p, wide - 1, 1);
  vg_page_markup(p, "\" height=\"");
  vg_page_fixed(p, height, 1);
  vg_page_markup(p, "\"><title>");
  vg_page_real(p, low, 3);
  vg_page_markup(p, " to ");
  vg_page_real(p, high, 3);
  vg_page_markup(p, ": ");
  vg_page_count(p, (uint64_t)count);
  vg_page_markup(p, "</title></rect>\n");
}

void vg_html_bars(struct page *p, const struct bars *b, const json_t *counts)
{
  size_t n = json_array_size(counts);
  double most = 1, decades;

  if (!n) return;
  for (size_t i = 0; i < n; i++)
    most = fmax(most, json_number_value(json_array_get(counts, i)));
  decades = fmax(1, decades_of(most));
  vg_page_format(p,
                 "<figure class=\"chart\"><svg viewBox=\"0 0 %d %d\" "
                 "role=\"img\" aria-label=\"%s\">\n",
                 WIDTH, HEIGHT, b->alt);
  axes(p, b, n, decades);
  for (size_t i = 0; i < n; i++)
    bar(p, b, i, n, json_number_value(json_array_get(counts, i)), decades);
  vg_page_format(p,
                 "<path class=\"axis\" d=\"M%d %dH%d\"/></svg>\n"
                 "<figcaption>%s</figcaption></figure>\n",
                 LEFT, HEIGHT - BOTTOM, WIDTH - RIGHT, b->title);
}
