/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Table of the layers of each wall. */
#include <math.h>

#include "cli/html/page.h"

static size_t lacking(const size_t *count)
{
  size_t n = 0;

  for (int c = VG_CAUSE_PROXIMITY; c < VG_CAUSE_N; c++) n += count[c];
  return n;
}

/* Write the counts by cause, as in "fewer: proximity 12, corner 3". */
static void causes(struct page *p, const char *lead, const size_t *count)
{
  if (!lacking(count)) return;
  vg_page_format(p, "%s ", lead);
  for (int c = VG_CAUSE_PROXIMITY, n = 0; c < VG_CAUSE_N; c++) {
    if (!count[c]) continue;
    vg_page_format(p, "%s%s ", n++ ? ", " : "",
                   vg_layer_cause_name((enum vg_layer_cause)c));
    vg_page_count(p, count[c]);
  }
  vg_page_markup(p, "<br>");
}

static void cell(struct page *p, double v, int decimals)
{
  vg_page_markup(p, "<td>");
  vg_page_fixed(p, v, decimals);
  vg_page_markup(p, "</td>");
}

static void cell_real(struct page *p, double v)
{
  vg_page_markup(p, "<td>");
  vg_page_real(p, v, 4);
  vg_page_markup(p, "</td>");
}

static void row(struct page *p, const struct vg_patch_layers *w)
{
  const struct vg_patch *patch = w->patch == VG_NO_INDEX
                                 ? NULL
                                 : &p->h->problem->boundary.surface
                                      .patch[w->patch];

  vg_page_markup(p, patch ? "<tr><th scope=\"row\">"
                          : "<tr class=\"all\"><th scope=\"row\">");
  if (patch) {
    vg_page_format(p, "%d ", (int)patch->id);
    vg_page_text(p, patch->name);
  } else {
    vg_page_markup(p, "all walls");
  }
  vg_page_markup(p, "</th><td>");
  vg_page_count(p, w->n_face);
  vg_page_markup(p, "</td>");
  cell(p, w->full, 2);
  cell(p, w->any, 2);
  vg_page_markup(p, "<td>");
  vg_page_fixed(p, w->level.min, 0);
  vg_page_markup(p, " &ndash; ");
  vg_page_fixed(p, w->level.max, 0);
  vg_page_markup(p, "</td>");
  cell(p, w->level.mean, 1);
  cell_real(p, w->asked.mean);
  cell_real(p, w->first.mean);
  cell(p, 100 * w->first_error, 3);
  cell(p, w->y_plus.max > 0 ? w->y_plus.mean : NAN, 2);
  cell_real(p, w->total.mean);
  cell(p, w->share_mean, 3);
  cell(p, w->n_top ? w->top_ratio[1] : NAN, 2);
  vg_page_markup(p, "<td class=\"words\">");
  causes(p, "fewer:", w->cause);
  causes(p, "thinner:", w->compressed);
  if (w->n_bare) {
    vg_page_markup(p, "none (first height too large): ");
    vg_page_count(p, w->n_bare);
  }
  vg_page_markup(p, "</td></tr>\n");
}

void vg_html_layers(struct page *p)
{
  const struct vg_layer_stage *s = p->h->layers;

  if (!p->has_layers) return;
  vg_page_section(p, "layers", "Boundary layers");
  vg_page_markup(
    p,
    "<div class=\"wide\"><table>\n<thead><tr>"
    "<th scope=\"col\">Wall</th><th scope=\"col\">Faces</th>"
    "<th scope=\"col\">Full layers&nbsp;%</th>"
    "<th scope=\"col\">Any layer&nbsp;%</th>"
    "<th scope=\"col\">Layers, min &ndash; max</th>"
    "<th scope=\"col\">Layers, mean</th>"
    "<th scope=\"col\">First height, requested</th>"
    "<th scope=\"col\">First height, mean</th>"
    "<th scope=\"col\">First height, max error&nbsp;%</th>"
    "<th scope=\"col\">y+, mean</th>"
    "<th scope=\"col\">Total height, mean</th>"
    "<th scope=\"col\">Height / growth-law height</th>"
    "<th scope=\"col\">Volume ratio at the top, 95th&nbsp;percentile</th>"
    "<th scope=\"col\" class=\"words\">Faces with fewer or thinner layers, by "
    "cause</th>"
    "</tr></thead>\n<tbody>\n");
  for (size_t i = 0; i < s->n_wall; i++) row(p, &s->wall[i]);
  if (s->n_wall > 1) row(p, &s->all);
  vg_page_markup(
    p,
    "</tbody></table></div>\n<p class=\"note\">Full layers: all "
    "layers that the growth law and the local edge length require, and at "
    "least one. Faces with none have a first height above <code>layer_end"
    "</code> times the local edge length; they are not full. Heights are "
    "in the length unit of the surface and measured on the mesh points. Volume "
    "ratio: 95th percentile of the ratio between the cells on either side of "
    "the top of the layers.</p>\n<dl class=\"causes\">");
  for (int c = VG_CAUSE_PROXIMITY; c < VG_CAUSE_N; c++) {
    if (!s->all.cause[c] && !s->all.compressed[c]) continue;
    vg_page_format(p, "<dt>%s</dt><dd>%s</dd>",
                   vg_layer_cause_name((enum vg_layer_cause)c),
                   vg_cause_words((enum vg_layer_cause)c));
  }
  vg_page_markup(p, "</dl>\n");
  vg_page_end_section(p);
}
