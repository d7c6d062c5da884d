/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on surfaces and domains. Declared in run/report/report.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/mesh/sheets.h"
#include "core/surface/surface_quality.h"
#include "run/common/text.h"
#include "run/report/report.h"
#include "run/settings/length.h"

static void count_line(FILE *to, const char *what, size_t n)
{
  char text[32];

  if (n) fprintf(to, "  %-24s %15s\n", what, vg_text_count(n, text));
}

static size_t n_shown(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t i = 0; i < m->n_patch; i++)
    n += !vg_patch_is_sheet_back(&m->patch[i]);
  return n;
}

void vg_report_size_text(FILE *to, const struct vg_mesh *m)
{
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  vg_report_counts_text(to, m, lo, hi);
}

void vg_report_counts_text(FILE *to, const struct vg_mesh *m,
                           const double lo[3], const double hi[3])
{
  count_line(to, "points", m->n_point);
  count_line(to, "boundary triangles", m->n_tri);
  count_line(to, "boundary quadrilaterals", m->n_quad);
  count_line(to, "tetrahedra", m->n_tet);
  count_line(to, "pyramids", m->n_pyr);
  count_line(to, "prisms", m->n_pri);
  count_line(to, "hexahedra", m->n_hex);
  count_line(to, "patches", n_shown(m));
  fprintf(to, "  %-24s %g %g %g to %g %g %g\n", "bounding box", lo[0], lo[1],
          lo[2], hi[0], hi[1], hi[2]);
}

void vg_report_error_json(json_t *report, const struct vg_error *err)
{
  json_object_set_new(report, "error", vg_text_json(err->text));
  json_object_set_new(report, "error_kind",
                      json_string(vg_status_name(err->code)));
}

json_t *vg_report_notes_json(const struct vg_notes *notes)
{
  json_t *list = json_array();

  for (size_t i = 0; i < notes->n; i++)
    json_array_append_new(list, vg_text_json(notes->text[i]));
  return list;
}

json_t *vg_report_size_json(const struct vg_mesh *m)
{
  double lo[3], hi[3];

  vg_mesh_bounds(m, lo, hi);
  return vg_report_counts_json(m, lo, hi);
}

json_t *vg_report_counts_json(const struct vg_mesh *m, const double lo[3],
                              const double hi[3])
{
  return json_pack("{s:I s:I s:I s:I s:I s:I s:I s:I s:I s:[fff] s:[fff]}",
                   "points", (json_int_t)m->n_point, "triangles",
                   (json_int_t)m->n_tri, "quadrilaterals",
                   (json_int_t)m->n_quad, "cells",
                   (json_int_t)vg_mesh_n_cell(m), "tetrahedra",
                   (json_int_t)m->n_tet, "pyramids", (json_int_t)m->n_pyr,
                   "prisms", (json_int_t)m->n_pri, "hexahedra",
                   (json_int_t)m->n_hex, "patches", (json_int_t)n_shown(m),
                   "lower", lo[0], lo[1], lo[2], "upper", hi[0], hi[1], hi[2]);
}

/* Faces, area and bounding box of a patch. */
struct extent {
  size_t n;
  double area, lo[3], hi[3];
};

static void add_face(struct extent *e, const struct vg_mesh *m,
                     const uint32_t *node, int n)
{
  const double *o = m->point[node[0]];

  e->n++;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) {
      const double x = m->point[node[i]][k];

      if (x < e->lo[k]) e->lo[k] = x;
      if (x > e->hi[k]) e->hi[k] = x;
    }
  for (int i = 2; i < n; i++) {
    double u[3], v[3], normal[3];

    vg_sub(m->point[node[i - 1]], o, u);
    vg_sub(m->point[node[i]], o, v);
    vg_cross(u, v, normal);
    e->area += vg_norm(normal) / 2;
  }
}

/* Array [n_patch], to be freed by the caller; NULL if out of memory. */
static struct extent *patch_extents(const struct vg_mesh *m)
{
  struct extent *e = vg_calloc(m->n_patch, sizeof *e);

  for (size_t i = 0; e && i < m->n_patch; i++)
    for (int k = 0; k < 3; k++) {
      e[i].lo[k] = INFINITY;
      e[i].hi[k] = -INFINITY;
    }
  for (size_t i = 0; e && i < m->n_tri; i++)
    add_face(&e[m->tri_patch[i]], m, m->tri[i], 3);
  for (size_t i = 0; e && i < m->n_quad; i++)
    add_face(&e[m->quad_patch[i]], m, m->quad[i], 4);
  return e;
}

static void code_text(int32_t code, char *text, size_t size)
{
  if (code == VG_BC_NONE) snprintf(text, size, "-");
  else snprintf(text, size, "%d", (int)code);
}

vg_status vg_report_patches_text(FILE *to, const struct vg_mesh *m,
                                 struct vg_error *err)
{
  struct extent *e = patch_extents(m);
  char count[32], bc[16], fun3d[16], name[VG_NAME_MAX];
  size_t shown = 0;

  if (!e) return vg_fail_memory(err, "a report");
  fprintf(to, "  %8s %13s %6s %6s %10s  %s\n", "patch", "faces", "USM3D",
          "FUN3D", "area", "name; bounding box");
  for (size_t i = 0; i < m->n_patch && shown < VG_SHOWN_PATCHES; i++) {
    if (vg_patch_is_sheet_back(&m->patch[i])) continue;
    shown++;
    code_text(m->patch[i].bc, bc, sizeof bc);
    code_text(m->patch[i].bc_fun3d, fun3d, sizeof fun3d);
    fprintf(to, "  %8d %13s %6s %6s %10.4g  %s", (int)m->patch[i].id,
            vg_text_count(e[i].n, count), bc, fun3d, e[i].area,
            vg_text_clean(m->patch[i].name, name, sizeof name));
    if (e[i].n)
      fprintf(to, "; %.5g %.5g %.5g to %.5g %.5g %.5g", e[i].lo[0], e[i].lo[1],
              e[i].lo[2], e[i].hi[0], e[i].hi[1], e[i].hi[2]);
    fputc('\n', to);
  }
  if (n_shown(m) > shown)
    fprintf(to, "  ... and %zu more patches\n", n_shown(m) - shown);
  free(e);
  return VG_OK;
}

static json_t *code_json(int32_t code)
{
  return code == VG_BC_NONE ? json_null() : json_integer(code);
}

json_t *vg_report_patches_json(const struct vg_mesh *m)
{
  struct extent *e = patch_extents(m);
  json_t *list = e ? json_array() : NULL;

  for (size_t i = 0; list && i < m->n_patch; i++) {
    json_t *one;

    if (vg_patch_is_sheet_back(&m->patch[i])) continue;
    one = json_pack("{s:i s:o s:o s:o s:I s:f}", "id", (int)m->patch[i].id,
                    "name", vg_text_json(m->patch[i].name), "usm3d",
                    code_json(m->patch[i].bc), "fun3d",
                    code_json(m->patch[i].bc_fun3d), "faces",
                    (json_int_t)e[i].n, "area", e[i].area);

    if (e[i].n) {
      json_object_set_new(one, "lower",
                          json_pack("[fff]", e[i].lo[0], e[i].lo[1],
                                    e[i].lo[2]));
      json_object_set_new(one, "upper",
                          json_pack("[fff]", e[i].hi[0], e[i].hi[1],
                                    e[i].hi[2]));
    }
    json_array_append_new(list, one);
  }
  free(e);
  return list;
}

static void shells_text(FILE *to, const struct vg_surface_report *r)
{
  char count[32];

  fprintf(to, "  %-24s %15s%s\n", "shells", vg_text_count(r->n_shell, count),
          r->is_closed ? "  (closed)" : "  (not closed)");
  for (size_t i = 0; i < r->n_shell && i < VG_SHOWN_ITEMS; i++) {
    const struct vg_shell *s = &r->shell[i];

    fprintf(
      to,
      "    shell %zu: %s triangles, nesting depth %d, volume %g, bounding "
      "box %g %g %g to %g %g %g\n",
      i + 1, vg_text_count(s->n_tri, count), s->depth, s->volume, s->lo[0],
      s->lo[1], s->lo[2], s->hi[0], s->hi[1], s->hi[2]);
  }
  if (r->n_shell > VG_SHOWN_ITEMS)
    fprintf(to, "    ... and %zu more\n", r->n_shell - VG_SHOWN_ITEMS);
}

static void repair_text(FILE *to, const struct vg_surface_report *r)
{
  /* If the whole surface was inverted, the other triangles disagreed. */
  size_t single = r->n_flipped;

  if (r->shells_reoriented) {
    single = 0;
    for (size_t i = 0; i < r->n_shell; i++)
      single += r->shell[i].n_tri - r->shell[i].n_flipped;
    fprintf(to, "  repaired: the orientation of the whole surface was "
                "reversed, so that normals point into the fluid\n");
  }
  if (single)
    fprintf(to,
            "  repaired: %zu triangles reversed for a consistent orientation\n",
            single);
  if (r->n_removed_point)
    fprintf(to, "  repaired: %zu unused or duplicate points removed\n",
            r->n_removed_point);
  if (r->n_removed_tri)
    fprintf(to, "  repaired: %zu duplicate or degenerate triangles removed\n",
            r->n_removed_tri);
  if (r->n_removed_wall)
    fprintf(to,
            "  repaired: %zu triangles of walls shared by touching bodies "
            "removed\n",
            r->n_removed_wall);
}

/* List triangles that prevent good cells on them. */
static void slivers_text(FILE *to, const struct vg_mesh *m,
                         const struct vg_surface_quality *q)
{
  if (!q->n_worst) return;
  fprintf(to,
          "  slivers: %zu caps (three nodes nearly on a line), %zu needles "
          "(one very short edge).\n"
          "  They cause poor cells. surface_swap removes those that it can "
          "without visibly changing\n"
          "  the surface; remesh_surface also replaces the others. Neither "
          "is possible with periodic\n"
          "  patches or inner surfaces:\n",
          q->n_cap, q->n_needle);
  for (size_t i = 0; i < q->n_worst && i < VG_SHOWN_FACES; i++) {
    const struct vg_worst_face *w = &q->worst[i];
    const struct vg_patch *p = &m->patch[m->tri_patch[w->face]];
    char name[VG_NAME_MAX];

    fprintf(to,
            "    %s, patch %d%s%s, face %zu, angle %.2g degrees, at (%.6g, "
            "%.6g, %.6g)\n",
            w->is_cap ? "cap" : "needle", (int)p->id, *p->name ? " " : "",
            vg_text_clean(p->name, name, sizeof name), w->face + 1, w->angle,
            w->at[0], w->at[1], w->at[2]);
  }
  if (q->n_cap + q->n_needle > VG_SHOWN_FACES)
    fprintf(to, "    ... and %zu more\n",
            q->n_cap + q->n_needle - VG_SHOWN_FACES);
}

static void quality_text(FILE *to, const struct vg_mesh *m, int is_stretched)
{
  struct vg_surface_quality q;

  vg_surface_quality(m, &q);
  if (!q.n) return;
  fprintf(
    to,
    "  triangles: smallest angle %.2g, 1st percentile %.1f degrees; "
    "below 5, 10, 20, 30 degrees:\n  %.4f %.4f %.4f %.4f %%; radius ratio "
    "(2 r/R): mean %.3f; mean edge length %.6g\n",
    q.angle_min, q.angle_min_p1, q.below[0], q.below[1], q.below[2], q.below[3],
    q.ratio_mean, q.edge_mean);
  if (!is_stretched) slivers_text(to, m, &q);
}

static json_t *quality_json(const struct vg_mesh *m)
{
  struct vg_surface_quality q;
  json_t *list = json_array();

  vg_surface_quality(m, &q);
  for (size_t i = 0; i < q.n_worst; i++) {
    const struct vg_worst_face *w = &q.worst[i];

    json_array_append_new(list,
                          json_pack("{s:s s:I s:i s:f s:[fff]}", "kind",
                                    w->is_cap ? "cap" : "needle", "face",
                                    (json_int_t)w->face + 1, "patch",
                                    (int)m->patch[m->tri_patch[w->face]].id,
                                    "angle", w->angle, "at", w->at[0], w->at[1],
                                    w->at[2]));
  }
  return json_pack("{s:f s:f s:[ffff] s:f s:f s:I s:I s:o}", "angle_min",
                   q.angle_min, "angle_min_percentile_1", q.angle_min_p1,
                   "percent_below_5_10_20_30", q.below[0], q.below[1],
                   q.below[2], q.below[3], "radius_ratio_mean", q.ratio_mean,
                   "edge_mean", q.edge_mean, "caps", (json_int_t)q.n_cap,
                   "needles", (json_int_t)q.n_needle, "worst", list);
}

void vg_report_surface_text(FILE *to, const struct vg_mesh *m,
                            const struct vg_surface_report *r, int unit,
                            int is_stretched, size_t shown)
{
  char text[1024], count[32];
  size_t at = 0;

  fprintf(to, "  unit of length                   %s\n",
          unit ? vg_unit_name(unit) : "not known");
  shells_text(to, r);
  repair_text(to, r);
  quality_text(to, m, is_stretched);
  for (int kind = 0; kind < VG_DEFECT_N; kind++) {
    size_t n = r->count[kind], said = 0;

    if (n)
      fprintf(to, "  %s: %s\n", vg_defect_heading((enum vg_defect_kind)kind),
              vg_text_count(n, count));
    /* The array `defect` is sorted by kind. */
    for (; at < r->n_defect && (int)r->defect[at].kind == kind; at++) {
      if (said++ >= shown) continue;
      vg_defect_text(m, &r->defect[at], text, sizeof text);
      fprintf(to, "    %s\n", text);
    }
    if (n > shown) fprintf(to, "    ... and %zu more\n", n - shown);
  }
}

static json_t *defects_json(const struct vg_mesh *m,
                            const struct vg_surface_report *r, size_t shown)
{
  json_t *list = json_array();
  size_t said[VG_DEFECT_N] = { 0 };
  char text[1024];

  for (size_t i = 0; i < r->n_defect; i++) {
    const struct vg_defect *d = &r->defect[i];
    json_t *one;

    if (said[d->kind]++ >= shown) continue;
    vg_defect_text(m, d, text, sizeof text);
    one = json_pack("{s:s s:o}", "kind", vg_defect_name(d->kind), "text",
                    vg_text_json(text));
    /* JSON has no NaN: the position of such a defect is omitted. */
    json_object_set_new(one, "at",
                        json_pack("[fff]", d->at[0], d->at[1], d->at[2]));
    for (int k = 0; k < 2; k++)
      if (d->face[k] != SIZE_MAX)
        json_object_set_new(one, k ? "face2" : "face",
                            json_integer((json_int_t)d->face[k] + 1));
    json_array_append_new(list, one);
  }
  return list;
}

json_t *vg_report_defects_json(const struct vg_mesh *m,
                               const struct vg_surface_report *r, int unit,
                               size_t shown)
{
  json_t *counts = json_object(), *shells = json_array();

  for (int kind = 0; kind < VG_DEFECT_N; kind++)
    json_object_set_new(counts, vg_defect_name((enum vg_defect_kind)kind),
                        json_integer((json_int_t)r->count[kind]));
  for (size_t i = 0; i < r->n_shell; i++) {
    const struct vg_shell *s = &r->shell[i];

    json_array_append_new(shells,
                          json_pack("{s:I s:i s:f s:[fff] s:[fff]}",
                                    "triangles", (json_int_t)s->n_tri, "depth",
                                    s->depth, "volume", s->volume, "lower",
                                    s->lo[0], s->lo[1], s->lo[2], "upper",
                                    s->hi[0], s->hi[1], s->hi[2]));
  }
  return json_pack("{s:s? s:b s:b s:I s:o s:o s:I s:I s:I s:I s:b s:o}", "unit",
                   unit ? vg_unit_name(unit) : NULL, "ok", r->n_defect == 0,
                   "closed", r->is_closed, "defects", (json_int_t)r->n_defect,
                   "count", counts, "shells", shells, "flipped",
                   (json_int_t)r->n_flipped, "removed_points",
                   (json_int_t)r->n_removed_point, "removed_triangles",
                   (json_int_t)r->n_removed_tri, "removed_wall_triangles",
                   (json_int_t)r->n_removed_wall, "shells_reoriented",
                   r->shells_reoriented, "first", defects_json(m, r, shown));
}

json_t *vg_report_surface_json(const struct vg_mesh *m,
                               const struct vg_surface_report *r, int unit,
                               size_t shown)
{
  json_t *all = vg_report_defects_json(m, r, unit, shown);

  if (!json_object_set_new(all, "quality", quality_json(m))) return all;
  json_decref(all);
  return NULL;
}

void vg_report_flow_text(FILE *to, const struct vg_flow *f, int adds_farfield)
{
  char statement[VG_FLOW_TEXT];

  vg_flow_statement(f, adds_farfield, statement);
  fprintf(to, "Flow domain\n  %s.\n", statement);
  for (int i = 0; i < f->n_evidence; i++)
    fprintf(to, "  %s %s\n", i ? "         " : "Evidence:", f->evidence[i]);
  if (f->kind == VG_FLOW_EXTERNAL)
    fprintf(to, "  If the fluid is inside the surface, use --flow internal.\n");
  if (f->kind == VG_FLOW_INTERNAL)
    fprintf(to, "  If the surface is a body immersed in the fluid, use --flow "
                "external.\n");
}

json_t *vg_report_flow_json(const struct vg_flow *f, int adds_farfield)
{
  static const char *const kind[] = { "unknown", "external", "internal" };
  char statement[VG_FLOW_TEXT];
  json_t *evidence = json_array();

  vg_flow_statement(f, adds_farfield, statement);
  for (int i = 0; i < f->n_evidence; i++)
    json_array_append_new(evidence, vg_text_json(f->evidence[i]));
  return json_pack("{s:s s:o s:o s:I s:I s:I s:I s:I s:s s:f}", "kind",
                   kind[f->kind], "statement", vg_text_json(statement),
                   "evidence", evidence, "bodies", (json_int_t)f->n_body,
                   "outer_boundaries", (json_int_t)f->n_outer,
                   "sealed_cavities", (json_int_t)f->n_cavity, "inlets",
                   (json_int_t)f->n_inlet, "outlets", (json_int_t)f->n_outlet,
                   "half",
                   f->axis < 0    ? "no"
                   : f->axis == 0 ? "x"
                   : f->axis == 1 ? "y"
                                  : "z",
                   "half_at", f->axis < 0 ? 0.0 : f->at);
}

void vg_report_domain_text(FILE *to, const struct vg_domain_report *r)
{
  char count[32];

  if (r->added_symmetry)
    fprintf(to, "  added: symmetry plane %c = %g\n", "xyz"[r->symmetry_axis],
            r -> symmetry_at);
  if (r->added_farfield) fprintf(to, "  added: farfield\n");
  if (r->n_added_tri)
    fprintf(to, "  added: %s boundary triangles\n",
            vg_text_count(r->n_added_tri, count));
}

json_t *vg_report_domain_json(const struct vg_domain_report *r)
{
  return json_pack("{s:b s:b s:i s:f s:I}", "farfield", r->added_farfield,
                   "symmetry", r->added_symmetry, "symmetry_axis",
                   r->added_symmetry ? r->symmetry_axis : -1, "symmetry_at",
                   r->added_symmetry ? r->symmetry_at : 0.0, "triangles",
                   (json_int_t)r->n_added_tri);
}
