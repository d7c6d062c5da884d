/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The worst cells: drawings with the adjacent cells, and a table. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/html/page.h"
#include "core/geometry/vector.h"

enum { SIZE = 300 };

/* View direction halfway between the normal of the largest face, from which a
 * flat cell shows its shape, and the plane of that face. */
static void look(const double (*x)[3], struct vg_camera *c)
{
  double normal[3], longest[3] = { 1, 0, 0 }, most = 0, length = 0;

  for (int i = 0; i < 4; i++) {
    double a[3], b[3], n[3];

    vg_sub(x[(i + 1) % 4], x[i], a);
    vg_sub(x[(i + 2) % 4], x[i], b);
    vg_cross(a, b, n);
    if (vg_norm(n) > most) {
      most = vg_norm(n);
      memcpy(normal, n, sizeof n);
    }
    if (vg_norm(a) > length) {
      length = vg_norm(a);
      memcpy(longest, a, sizeof a);
    }
  }
  if (!(most > 0)) memcpy(normal, (double[3]){ 0, 0, 1 }, sizeof normal);
  vg_unit(normal);
  vg_unit(longest);
  vg_cross(normal, longest, c->toward);
  for (int k = 0; k < 3; k++) c->toward[k] += normal[k];
  vg_unit(c->toward);
  vg_cross(normal, c->toward, c->right);
  if (!(vg_unit(c->right) > 0)) memcpy(c->right, longest, sizeof longest);
  vg_cross(c->toward, c->right, c->up);
}

static void frame(const double (*x)[3], struct vg_camera *c)
{
  double size = 0;

  for (int k = 0; k < 3; k++)
    c->centre[k] = (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
  for (int i = 0; i < 4; i++) size = fmax(size, vg_distance(x[i], c->centre));
  c->width = c->height = SIZE;
  c->scale = size > 0 ? 0.24 * SIZE / size : 1;
}

static void put_point(struct page *p, const struct vg_camera *c,
                      const double x[3], const char *lead)
{
  double at[3];

  vg_camera_see(c, x, at);
  vg_page_markup(p, lead);
  vg_page_fixed(p, at[0], 1);
  vg_page_markup(p, " ");
  vg_page_fixed(p, at[1], 1);
}

static void edges(struct page *p, const struct vg_camera *c,
                  const double (*x)[3])
{
  static const int pair[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 },
                                  { 1, 2 }, { 1, 3 }, { 2, 3 } };

  for (int e = 0; e < 6; e++) {
    put_point(p, c, x[pair[e][0]], "M");
    put_point(p, c, x[pair[e][1]], "L");
  }
}

static void drawing(struct page *p, const struct vg_around *a, size_t k,
                    const struct vg_worst_cell *w)
{
  struct vg_camera c;

  look((const double(*)[3])a->cell[0], &c);
  frame((const double(*)[3])a->cell[0], &c);
  vg_page_format(p,
                 "<figure class=\"cell\"><svg viewBox=\"0 0 %d %d\" "
                 "role=\"img\" aria-label=\"Worst cell %zu among its "
                 "neighbours.\">\n<path class=\"around\" d=\"",
                 SIZE, SIZE, k + 1);
  for (size_t i = 1; i < a->n; i++)
    edges(p, &c, (const double(*)[3])a->cell[i]);
  vg_page_markup(p, "\"/>\n<path class=\"worst\" d=\"");
  for (int f = 0; f < 4; f++)
    for (int i = 0; i < 3; i++)
      put_point(p, &c, a->cell[0][(f + i) % 4], i == 0 ? "M" : "L");
  vg_page_format(p, "Z\"/></svg>\n<figcaption>%zu: ", k + 1);
  vg_page_fixed(p, w->value, 2);
  vg_page_format(p, "&deg;, with %zu adjacent cells</figcaption></figure>\n",
                 a->n - 1);
}

/* The kinds of the points of a flat cell: "3 top 'wing', field". Equal points
 * are listed once. */
static void put_points(struct page *p, const struct vg_flat_points *points)
{
  const struct vg_mesh *m = &p->h->problem->boundary.surface;
  unsigned done = 0;

  for (int i = 0; i < 4 && points->kind[0] != VG_POINT_UNKNOWN; i++) {
    int n = 0;

    if (done >> i & 1) continue;
    for (int k = i; k < 4; k++)
      if (points->kind[k] == points->kind[i] &&
          points->patch[k] == points->patch[i]) {
        n++;
        done |= 1u << k;
      }
    vg_page_format(p, "%s%d %s", i ? ", " : "", n,
                   vg_point_kind_name((enum vg_point_kind)points->kind[i]));
    if (points->patch[i] >= m->n_patch) continue;
    vg_page_format(p, " %d ", (int)m->patch[points->patch[i]].id);
    vg_page_text(p, m->patch[points->patch[i]].name);
  }
}

/* Flat cells by the kinds of their points. */
static void flat_cells(struct page *p, const struct vg_mesh_report *m)
{
  size_t n = 0;

  for (int c = 0; c < VG_FLAT_CAUSES; c++) n += m->flat[c].n;
  if (!m->has_flat || !n) return;
  vg_page_format(p,
                 "<p>Cells with an angle below %g&deg; by the kinds of their "
                 "points:</p>\n<div class=\"wide\"><table>\n<thead><tr>"
                 "<th scope=\"col\">Points</th><th scope=\"col\">Cells</th>"
                 "<th scope=\"col\">At interfaces</th><th scope=\"col\">"
                 "Spanning two parts of the boundary</th>"
                 "<th scope=\"col\">On needles</th></tr></thead>\n<tbody>",
                 VG_FLAT_LIMIT);
  for (int c = 0; c < VG_FLAT_CAUSES; c++) {
    const struct vg_flat_count *f = &m->flat[c];

    if (!f->n) continue;
    vg_page_format(p, "<tr><th scope=\"row\">%s</th><td>",
                   vg_flat_cause_name((enum vg_flat_cause)c));
    vg_page_count(p, f->n);
    vg_page_markup(p, "</td><td>");
    vg_page_count(p, f->at_interface);
    vg_page_markup(p, "</td><td>");
    vg_page_count(p, f->spanning);
    vg_page_markup(p, "</td><td>");
    vg_page_count(p, f->needle);
    vg_page_markup(p, "</td></tr>\n");
  }
  vg_page_markup(p, "</tbody></table></div>\n");
}

void vg_html_worst(struct page *p)
{
  const struct vg_run *r = p->h->run;
  const struct vg_mesh_report *m = p->has_layers ? &r->field_judge : &r->judge;

  if (!m->n_worst) return;
  vg_page_section(p, "worst", "Worst cells");
  vg_page_markup(p, "<p>Cells with the smallest dihedral angles (red) and the "
                    "cells that touch them.</p>\n<div class=\"cells\">\n");
  for (size_t k = 0; k < VG_RUN_WORST; k++)
    if (r->pictures.worst[k].n)
      drawing(p, &r->pictures.worst[k], k, &m->worst[k]);
  vg_page_markup(p,
                 "</div>\n<div class=\"wide\"><table>\n<thead><tr>"
                 "<th scope=\"col\"></th><th scope=\"col\">Cell</th>"
                 "<th scope=\"col\">Smallest angle</th><th scope=\"col\">x</th>"
                 "<th scope=\"col\">y</th><th scope=\"col\">z</th>"
                 "<th scope=\"col\">Points</th></tr></thead>\n<tbody>");
  for (size_t k = 0; k < m->n_worst; k++) {
    vg_page_format(p, "<tr><th scope=\"row\">%zu</th><td>", k + 1);
    vg_page_count(p, m->worst[k].cell + 1);
    vg_page_markup(p, "</td><td>");
    vg_page_fixed(p, m->worst[k].value, 3);
    vg_page_markup(p, "&deg;</td>");
    for (int i = 0; i < 3; i++) {
      vg_page_markup(p, "<td>");
      vg_page_real(p, m->worst[k].at[i], 6);
      vg_page_markup(p, "</td>");
    }
    vg_page_markup(p, "<td>");
    put_points(p, &m->worst[k].points);
    vg_page_markup(p, "</td></tr>\n");
  }
  vg_page_markup(p, "</tbody></table></div>\n");
  flat_cells(p, m);
  vg_page_end_section(p);
}
