/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cells across the wakes. */
#include "cli/html/page.h"
#include "run/report/report.h"

static void cell(struct page *p, double value)
{
  vg_page_markup(p, "<td>");
  vg_page_fixed(p, value, 1);
  vg_page_markup(p, "</td>");
}

static void row(struct page *p, const struct vg_wake_count *c, size_t wake)
{
  vg_page_format(p, "<tr><th scope=\"row\">%zu</th><td>", wake + 1);
  vg_page_fixed(p, c->chords, 1);
  vg_page_markup(p, "</td>");
  cell(p, c->asked);
  cell(p, c->mean);
  cell(p, c->least);
  cell(p, c->stretch);
  vg_page_format(p, "<td>%zu of %zu</td></tr>\n", c->n_measured, c->n_line);
}

void vg_html_wakes(struct page *p)
{
  const struct vg_run *r = p->h->run;
  const size_t n = p->h->problem->read.wakes.n;

  if (!n) return;
  vg_page_section(p, "wakes", "Wakes");
  vg_page_markup(
    p,
    "<p>Cells across each wake, in edge lengths of the cells, on lines "
    "across it at distances in chords behind the trailing edge. Lines that "
    "are mostly in walls or layers are not measured. The stretch is the edge "
    "length along the stream over that across the wake.</p>\n"
    "<div class=\"wide\"><table>\n<thead><tr><th scope=\"col\">Wake</th>"
    "<th scope=\"col\">Chords</th><th scope=\"col\">Requested</th>"
    "<th scope=\"col\">Reached, mean</th><th scope=\"col\">Least</th>"
    "<th scope=\"col\">Stretch</th>"
    "<th scope=\"col\">Lines</th></tr></thead>\n<tbody>");
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < VG_WAKE_STATIONS; k++) {
      const struct vg_wake_count c = vg_report_wake_count(r->n_probe, r->probe,
                                                          i, k);

      if (c.n_line) row(p, &c, i);
    }
  vg_page_markup(p, "</tbody></table></div>\n");
  vg_page_end_section(p);
}
