/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Patches, and the surface that was meshed. */
#include "cli/html/page.h"

static void code(struct page *p, int32_t bc)
{
  if (bc == VG_BC_NONE) vg_page_markup(p, "<td>&ndash;</td>");
  else vg_page_format(p, "<td>%d</td>", (int)bc);
}

static void patches(struct page *p)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  const json_t *list = vg_page_json(p, "patches");

  vg_page_markup(
    p, "<div class=\"wide\"><table>\n<thead><tr>"
       "<th scope=\"col\">Patch</th><th scope=\"col\">Triangles</th>"
       "<th scope=\"col\">USM3D code</th><th scope=\"col\">FUN3D code</th>"
       "<th scope=\"col\" class=\"words\">Layers requested by</th></tr>"
       "</thead>\n"
       "<tbody>\n");
  for (size_t i = 0; i < m->n_patch; i++) {
    const struct vg_patch *patch = &m->patch[i];

    vg_page_format(p, "<tr><th scope=\"row\">%d ", (int)patch->id);
    vg_page_text(p, patch->name);
    vg_page_markup(p, "</th><td>");
    vg_page_count(p, (uint64_t)json_integer_value(
                       json_object_get(json_array_get(list, i), "faces")));
    vg_page_markup(p, "</td>");
    code(p, patch->bc);
    code(p, patch->bc_fun3d);
    vg_page_format(p, "<td class=\"words\">%s</td></tr>\n",
                   p->has_layers ? vg_wall_reason_name(p->h->layers->reason[i])
                                 : "no");
  }
  vg_page_markup(p, "</tbody></table></div>\n");
}

void vg_html_patches(struct page *p)
{
  vg_page_section(p, "patches", "Patches");
  patches(p);
  vg_page_markup(p, "<table class=\"facts\">\n");
  vg_page_fact_count(p, "Points of the surface",
                     p->h->problem->boundary.surface.n_point);
  vg_page_fact_count(p, "Triangles", p->h->problem->boundary.surface.n_tri);
  vg_page_fact_count(p, "Closed shells",
                     json_array_size(vg_page_json(p, "surface.shells")));
  vg_page_fact(p, "Smallest angle of a triangle");
  vg_page_fixed(p, vg_page_number(p, "surface.quality.angle_min"), 2);
  vg_page_markup(p, "&deg;</td></tr>\n");
  vg_page_fact_count(p, "Caps (an angle near 180 degrees)",
                     (uint64_t)vg_page_number(p, "surface.quality.caps"));
  vg_page_fact_count(p, "Needles (a short edge)",
                     (uint64_t)vg_page_number(p, "surface.quality.needles"));
  vg_page_fact(p, "Volume: sum of cells, enclosed by the boundary");
  vg_page_real(p, vg_page_number(p, "mesh.volume"), 10);
  vg_page_markup(p, ", ");
  vg_page_real(p, vg_page_number(p, "mesh.enclosed"), 10);
  vg_page_markup(p, "</td></tr>\n</table>\n");
  vg_page_end_section(p);
}
