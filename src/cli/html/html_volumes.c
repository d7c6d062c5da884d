/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Quality in the terms of solvers: figures, histograms and worst places. */
#include <math.h>

#include "cli/html/page.h"

static void row(struct page *p, const char *name, double worst, double mean,
                int decimals, const char *limit, size_t n)
{
  vg_page_format(p, "<tr><th scope=\"row\">%s</th><td>", name);
  vg_page_fixed(p, worst, decimals);
  vg_page_markup(p, "</td><td>");
  if (isfinite(mean)) vg_page_fixed(p, mean, decimals);
  vg_page_format(p, "</td><td>%s</td><td>", limit);
  if (*limit) vg_page_count(p, n);
  vg_page_markup(p, "</td></tr>\n");
}

static void figures(struct page *p, const struct vg_solver_quality *q)
{
  vg_page_markup(p, "<div class=\"wide\"><table>\n<thead><tr>"
                    "<th scope=\"col\"></th><th scope=\"col\">Worst</th>"
                    "<th scope=\"col\">Mean</th>"
                    "<th scope=\"col\">Limit of checkMesh</th>"
                    "<th scope=\"col\">Beyond it</th></tr></thead>\n<tbody>");
  row(p, "Non-orthogonality of faces (degrees)", q->angle_max, q->angle_mean, 2,
      "above 70", q->n_angle);
  row(p, "Skewness of faces", q->skewness_max, NAN, 3, "above 4",
      q->n_skewness);
  row(p, "Weight of faces", q->weight_min, NAN, 4, "below 0.05", q->n_weight);
  row(p, "Volume ratio of neighbouring cells", q->volume_ratio_min, NAN, 4,
      "below 0.01", q->n_volume_ratio);
  row(p, "Cell determinant", q->determinant_min, NAN, 6, "below 0.001",
      q->n_determinant);
  row(p, "Orthogonal quality of cells", q->quality_min, q->quality_mean, 4, "",
      0);
  vg_page_markup(p, "</tbody></table></div>\n");
}

static void dual(struct page *p, const struct vg_dual_quality *q)
{
  static const char *const name[VG_WORST_DUAL_LISTS] = {
    "Orthogonality of points", "Orthogonality of dual faces",
    "Ratio of sub-volumes at points"
  };

  vg_page_markup(p, "<p>Orthogonality of the median dual, for solvers with "
                    "unknowns in the points (SU2, FUN3D): 90&deg; minus the "
                    "angle between an edge and the area vector of its dual "
                    "face; at a point, the mean weighted by area. 90&deg; is "
                    "best.</p>\n<div class=\"wide\"><table>\n<thead><tr>"
                    "<th scope=\"col\"></th><th scope=\"col\">Worst</th>"
                    "<th scope=\"col\">Where</th>"
                    "<th scope=\"col\">Share</th></tr></thead>\n<tbody>");
  for (int k = 0; k < VG_WORST_DUAL_LISTS; k++) {
    vg_page_format(p, "<tr><th scope=\"row\">%s</th><td>", name[k]);
    vg_page_fixed(p, q->worst[k][0].value, 2);
    vg_page_format(p, "%s</td><td>", k == VG_WORST_DUAL_VOLUME ? "" : "&deg;");
    for (int i = 0; i < 3; i++) {
      if (i) vg_page_markup(p, ", ");
      vg_page_real(p, q->worst[k][0].at[i], 6);
    }
    vg_page_markup(p, "</td><td>");
    if (k == VG_WORST_DUAL_POINT) {
      vg_page_format(p, "below 1&deg;, 10&deg;, 20&deg;: %.3g, %.3g, %.3g %%",
                     q->below[0], q->below[1], q->below[2]);
    } else if (k == VG_WORST_DUAL_FACE) {
      vg_page_markup(p, "0&deg; or less: ");
      vg_page_count(p, q->n_opposed);
    }
    vg_page_markup(p, "</td></tr>\n");
  }
  vg_page_markup(p, "</tbody></table></div>\n");
}

static void places(struct page *p, const struct vg_solver_quality *q, int list,
                   const char *name, const char *unit)
{
  for (size_t k = 0; k < q->n_worst[list]; k++) {
    const struct vg_worst_place *w = &q->worst[list][k];

    vg_page_format(p, "<tr><th scope=\"row\">%s</th><td>", k ? "" : name);
    vg_page_count(p, w->cell + 1);
    vg_page_markup(p, "</td><td>");
    vg_page_fixed(p, w->value, 4);
    vg_page_format(p, "%s</td>", unit);
    for (int i = 0; i < 3; i++) {
      vg_page_markup(p, "<td>");
      vg_page_real(p, w->at[i], 6);
      vg_page_markup(p, "</td>");
    }
    vg_page_markup(p, "</tr>\n");
  }
}

static void all_places(struct page *p, const struct vg_solver_quality *q)
{
  vg_page_markup(p, "<p>The worst faces and cells. For a face, the cell is the "
                    "one with the lower number, and the position its "
                    "centre.</p>\n"
                    "<div class=\"wide\"><table>\n<thead><tr>"
                    "<th scope=\"col\"></th><th scope=\"col\">Cell</th>"
                    "<th scope=\"col\">Value</th><th scope=\"col\">x</th>"
                    "<th scope=\"col\">y</th><th scope=\"col\">z</th></tr>"
                    "</thead>\n<tbody>");
  places(p, q, VG_WORST_ANGLE, "Non-orthogonality", "&deg;");
  places(p, q, VG_WORST_SKEWNESS, "Skewness", "");
  places(p, q, VG_WORST_QUALITY, "Orthogonal quality", "");
  vg_page_markup(p, "</tbody></table></div>\n");
}

void vg_html_volumes(struct page *p)
{
  static const struct bars angle = {
    .title = "Non-orthogonality of each face",
    .unit = "degrees",
    .alt = "Histogram of the non-orthogonality of each face between cells.",
    .step = 5,
    .bad_from = 70
  };
  static const struct bars skewness = {
    .title = "Skewness of each face",
    .unit = "4: limit of checkMesh",
    .alt = "Histogram of the skewness of each face.",
    .decimals = 1,
    .step = 0.25,
    .bad_from = 4
  };
  static const struct bars quality = {
    .title = "Orthogonal quality of each cell",
    .unit = "1: best",
    .alt = "Histogram of the orthogonal quality of each cell.",
    .decimals = 1,
    .step = 0.05,
    .bad_below = 0.1,
    .bad_from = 1e9
  };
  const struct vg_mesh_report *r = &p->h->run->judge;

  if (!r->has_solver) return;
  vg_page_section(p, "solvers", "Quality in the terms of solvers");
  vg_page_markup(p, "<p>All cells, including the layers. Non-orthogonality, "
                    "skewness, weight, volume ratio and determinant as defined "
                    "by OpenFOAM, orthogonal quality as defined by Fluent."
                    "</p>\n");
  figures(p, &r->solver);
  if (r->has_dual) dual(p, &r->dual);
  vg_page_markup(p, "<div class=\"charts\">\n");
  vg_html_bars(p, &angle,
               vg_page_json(p,
                            "mesh.solver_quality.histogram_non_orthogonality"));
  vg_html_bars(p, &skewness,
               vg_page_json(p, "mesh.solver_quality.histogram_skewness"));
  vg_html_bars(
    p, &quality,
    vg_page_json(p, "mesh.solver_quality.histogram_orthogonal_quality"));
  vg_page_markup(p, "</div>\n");
  all_places(p, &r->solver);
  vg_page_end_section(p);
}
