/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Zones of cells. */
#include "cli/html/page.h"
#include "core/mesh/zones.h"

void vg_html_zones(struct page *p)
{
  const struct vg_mesh *m = p->h->run->slices.boundary;
  const struct vg_zone_report *r = p->h->run->zone_report;

  if (!r) return;
  vg_page_section(p, "zones", "Zones");
  vg_page_markup(p,
                 "<div class=\"wide\"><table>\n<thead><tr>"
                 "<th scope=\"col\">Zone</th><th scope=\"col\">Name</th>"
                 "<th scope=\"col\">Kind</th><th scope=\"col\">Cells</th>"
                 "<th scope=\"col\">Volume</th><th scope=\"col\">Smallest "
                 "dihedral angle</th><th scope=\"col\">Mean edge</th>"
                 "<th scope=\"col\">Largest edge</th></tr></thead><tbody>\n");
  for (size_t z = 0; z < m->n_zone; z++) {
    vg_page_format(p, "<tr><th scope=\"row\">%d</th><td>", (int)m->zone[z].id);
    vg_page_text(p, m->zone[z].name);
    vg_page_format(p, "</td><td>%s</td><td>",
                   vg_zone_kind_word[m->zone[z].kind]);
    vg_page_count(p, r[z].n_cell);
    vg_page_markup(p, "</td><td>");
    vg_page_real(p, r[z].volume, 6);
    vg_page_markup(p, "</td><td>");
    vg_page_fixed(p, r[z].angle_min, 2);
    vg_page_markup(p, "&deg;</td><td>");
    vg_page_real(p, r[z].edge_mean, 4);
    vg_page_markup(p, "</td><td>");
    vg_page_real(p, r[z].edge_max, 4);
    vg_page_markup(p, "</td></tr>\n");
  }
  vg_page_markup(p, "</tbody></table></div>\n");
  vg_page_end_section(p);
}
