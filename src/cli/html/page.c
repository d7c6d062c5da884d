/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Elements of a page. */
#include "cli/html/page.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "run/common/text.h"

void vg_page_markup(struct page *p, const char *markup)
{
  vg_output_text(&p->out, markup);
}

void vg_page_text(struct page *p, const char *text)
{
  char *clean = vg_text_copy(text);

  if (clean) vg_output_markup(&p->out, clean);
  free(clean);
}

void vg_page_format(struct page *p, const char *format, ...)
{
  char text[512];
  va_list args;

  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  vg_page_markup(p, text);
}

void vg_page_count(struct page *p, uint64_t n)
{
  char text[32];

  vg_page_markup(p, vg_text_count(n, text));
}

void vg_page_real(struct page *p, double v, int digits)
{
  char text[40];

  snprintf(text, sizeof text, "%.*g", digits, v);
  vg_page_markup(p, isfinite(v) ? text : "&ndash;");
}

void vg_page_fixed(struct page *p, double v, int decimals)
{
  char text[360];

  snprintf(text, sizeof text, "%.*f", decimals, v);
  vg_page_markup(p, isfinite(v) ? text : "&ndash;");
}

void vg_page_base64(struct page *p, const unsigned char *data, size_t n)
{
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"
                              "abcdefghijklmnopqrstuvwxyz0123456789+/";
  char text[4096];
  size_t at = 0;

  for (size_t i = 0; i < n; i += 3) {
    unsigned long v = (unsigned long)data[i] << 16 |
                      (unsigned long)(i + 1 < n ? data[i + 1] : 0) << 8 |
                      (unsigned long)(i + 2 < n ? data[i + 2] : 0);

    for (int k = 0; k < 4; k++) text[at++] = digit[v >> (18 - 6 * k) & 63];
    if (i + 1 >= n) text[at - 2] = '=';
    if (i + 2 >= n) text[at - 1] = '=';
    if (at < sizeof text && i + 3 < n) continue;
    vg_output_bytes(&p->out, text, at);
    at = 0;
  }
}

void vg_page_colour(struct page *p, const uint8_t rgb[3])
{
  vg_page_format(p, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
}

void vg_page_key(struct page *p, const uint8_t rgb[3], const char *word)
{
  vg_page_markup(p, "<span class=\"key\"><i style=\"background:");
  vg_page_colour(p, rgb);
  vg_page_markup(p, "\"></i>");
  vg_page_text(p, word);
  vg_page_markup(p, "</span>\n");
}

void vg_page_section(struct page *p, const char *id, const char *title)
{
  vg_page_format(p,
                 "<section id=\"%s\" aria-labelledby=\"%s-title\">\n"
                 "<h2 id=\"%s-title\">%s</h2>\n",
                 id, id, id, title);
}

void vg_page_end_section(struct page *p)
{
  vg_page_markup(p, "</section>\n\n");
}

void vg_page_figure(struct page *p, int picture, const char *id,
                    const char *alt)
{
  const struct vg_bytes *png = &p->png[picture];

  vg_page_format(p, "<figure><img width=\"%d\" height=\"%d\"", VG_CUT_WIDTH,
                 VG_CUT_HEIGHT);
  if (id) vg_page_format(p, " id=\"%s\"", id);
  vg_page_markup(p, " alt=\"");
  vg_page_text(p, alt);
  vg_page_markup(p, "\" src=\"data:image/png;base64,");
  vg_page_base64(p, png->data, png->n);
  vg_page_markup(p, "\">\n<figcaption>");
}

void vg_page_end_figure(struct page *p)
{
  vg_page_markup(p, "</figcaption></figure>\n");
}

void vg_page_fact(struct page *p, const char *name)
{
  vg_page_markup(p, "<tr><th scope=\"row\">");
  vg_page_text(p, name);
  vg_page_markup(p, "</th><td>");
}

void vg_page_fact_count(struct page *p, const char *name, uint64_t n)
{
  vg_page_fact(p, name);
  vg_page_count(p, n);
  vg_page_markup(p, "</td></tr>\n");
}

const json_t *vg_page_json(const struct page *p, const char *path)
{
  const json_t *o = p->h->report;
  char name[64];

  while (*path && o) {
    size_t n = strcspn(path, ".");

    snprintf(name, sizeof name, "%.*s", (int)n, path);
    o = json_object_get(o, name);
    path += n + (path[n] == '.');
  }
  return o;
}

double vg_page_number(const struct page *p, const char *path)
{
  return json_number_value(vg_page_json(p, path));
}

const char *vg_page_judged(const struct page *p)
{
  return p->has_layers ? "field" : "mesh";
}
