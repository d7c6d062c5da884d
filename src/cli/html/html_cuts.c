/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cuts through field and layers. */
#include <stdio.h>

#include "cli/html/page.h"

static const char *const axis_name[3] = { "x", "y", "z" };

static const char *view_words(enum vg_cut_view view)
{
  switch (view) {
  case VG_VIEW_BODY: return "Section of the body";
  case VG_VIEW_DOMAIN: return "Whole domain";
  case VG_VIEW_FIRST: return "Close-up at the lower end of the section";
  case VG_VIEW_LAST: return "Close-up at the upper end of the section";
  case VG_VIEW_POOREST: return "Location with the most missing layers";
  }
  return "";
}

/* Write "x = 0.5" and the width of the view. */
static void place(struct page *p, const struct vg_cut *c)
{
  vg_page_format(p, "%s = ", axis_name[c->axis]);
  vg_page_real(p, c->at, 5);
  vg_page_markup(p, "; width of the view ");
  vg_page_real(p, c->width, 3);
}

static void figure(struct page *p, size_t i, int picture, const char *what)
{
  const struct vg_cut_plan *plan = &p->h->run->pictures.plan;
  const struct vg_cut *c = &plan->cut[i];
  char alt[160], id[24];

  snprintf(alt, sizeof alt, "%s, cut normal to %s: %s.",
           view_words(plan->view[i]), axis_name[c->axis], what);
  snprintf(id, sizeof id, "cut%zu", i);
  vg_page_figure(p, picture, picture < PICTURE_ANGLE ? id : NULL, alt);
  vg_page_markup(p, view_words(plan->view[i]));
  vg_page_markup(p, ", ");
  place(p, c);
  vg_page_end_figure(p);
}

static void kind_keys(struct page *p)
{
  static const char *const name[VG_CUT_KINDS] = {
    "tetrahedra outside the layers", "tetrahedra in layers", "pyramids",
    "prisms", "hexahedra"
  };
  const struct vg_run *run = p->h->run;
  const uint64_t *layer = run->zones ? run->unsorted.n_layer_cell
                                     : run->slices.n_layer_cell;
  const uint64_t n[VG_CUT_KINDS] = { 1, layer[VG_SLICE_TET],
                                     layer[VG_SLICE_PYR], layer[VG_SLICE_PRI],
                                     layer[VG_SLICE_HEX] };

  vg_page_markup(p, "<p class=\"keys\">");
  for (int k = 0; k < VG_CUT_KINDS; k++)
    if (n[k]) vg_page_key(p, vg_cut_kind_colour[k], name[k]);
  vg_page_markup(p, "</p>\n");
}

static void angle_keys(struct page *p)
{
  char word[40];

  vg_page_markup(p, "<p class=\"keys\">Smallest dihedral angle of each cell: ");
  for (int k = 0; k <= VG_CUT_ANGLES; k++) {
    if (k < VG_CUT_ANGLES)
      snprintf(word, sizeof word, "below %d\302\260", vg_cut_angle[k]);
    else
      snprintf(word, sizeof word, "%d\302\260 and more",
               vg_cut_angle[VG_CUT_ANGLES - 1]);
    vg_page_key(p, vg_cut_angle_colour[k], word);
  }
  vg_page_markup(p, "</p>\n");
}

void vg_html_cuts(struct page *p)
{
  const struct vg_cut_plan *plan = &p->h->run->pictures.plan;

  vg_page_section(p, "cuts", "Cuts through the mesh");
  vg_page_markup(
    p, "<p>Each picture shows the cells that a plane cuts, as they are in the "
       "output files. Edges fade where cells are thinner than a "
       "line.</p>\n<div class=\"pair\">\n");
  for (size_t i = 0; i < plan->n; i++)
    figure(p, i, PICTURE_CUT + (int)i, "cells by type");
  vg_page_markup(p, "</div>\n");
  kind_keys(p);
  vg_page_end_section(p);
}

void vg_html_angles(struct page *p)
{
  if (!p->h->run->pictures.plan.n) return;
  vg_page_markup(p, "<div>");
  figure(p, 0, PICTURE_ANGLE, "cells by smallest angle");
  angle_keys(p);
  vg_page_markup(p, "</div>\n");
}

void vg_html_partition(struct page *p)
{
  static const struct {
    const char *name, *path;
  } row[] = {
    { "Cuts", "partition.cuts" },
    { "Edge separators (pencils)", "partition.pencils" },
    { "Face separators (tiles)", "partition.tiles" },
    { "Cells of separators", "partition.separator_cells" },
    { "Subdomains (leaves)", "partition.leaves" },
    { "Separators abandoned", "partition.separators_failed" },
    { "Cuts repeated elsewhere", "partition.recuts" },
    { "Overloaded subdomains cut again", "partition.leaves_subdivided_again" },
    { "Subdomains left too large", "partition.leaves_left_overloaded" },
    { "Subdomains filled with their neighbours",
      "partition.subdomains_extended" },
    { "Regions with poor cells at interfaces", "partition.repair_regions" },
    { "Of these repaired", "partition.repair_regions_improved" },
  };

  vg_page_section(p, "partition", "Domain decomposition");
  vg_page_markup(p, "<div class=\"pair\">\n");
  if (p->h->run->pictures.plan.n)
    figure(p, p->part_cut, PICTURE_PART, "cells by subdomain");
  vg_page_markup(p, "<div><table class=\"facts\">\n");
  for (size_t i = 0; i < sizeof row / sizeof *row; i++)
    vg_page_fact_count(p, row[i].name,
                       (uint64_t)vg_page_number(p, row[i].path));
  vg_page_markup(p, "</table>\n<p class=\"keys\">");
  vg_page_key(p, vg_cut_zone_colour, "separators");
  if (p->has_layers) vg_page_markup(p, "Layers are light grey; ");
  vg_page_markup(p, "other colours distinguish neighbouring subdomains.</p>"
                    "</div>\n</div>\n");
  vg_page_end_section(p);
}
