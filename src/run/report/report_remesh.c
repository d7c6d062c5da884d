/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "run/report/report.h"

#include "core/remesh/remesh.h"
#include "run/common/text.h"

static double percent(size_t part, size_t whole)
{
  return whole ? 100 * (double)part / (double)whole : 0;
}

static void distance_text(FILE *to, const char *what,
                          const struct vg_remesh_distance *d)
{
  fprintf(to,
          "  %s: largest %.3g, at (%.6g, %.6g, %.6g); 99th percentile %.3g\n",
          what, d->most, d->at[0], d->at[1], d->at[2], d->most_99);
}

/* A cause in texts; vg_remesh_cause_name is its JSON key. */
static const char *cause_text(enum vg_remesh_cause c)
{
  static const char *const text[VG_REMESH_N] = { "corner", "narrow strip",
                                                 "feature curve",
                                                 "smooth surface" };

  return text[c];
}

static void bad_text(FILE *to, const struct vg_remesh_report *r)
{
  size_t shown = 0;

  if (!r->n_bad) return;
  fprintf(to,
          "  triangles with an angle below %g degrees: %zu; by "
          "cause:",
          VG_REMESH_BAD, r->n_bad);
  for (int c = 0; c < VG_REMESH_N; c++)
    fprintf(to, "%s %s %zu", c ? "," : "", cause_text((enum vg_remesh_cause)c),
            r->cause[c]);
  fprintf(to, "\n");
  for (size_t i = 0; i < r->n_bad && shown < VG_SHOWN_FACES; i++, shown++)
    fprintf(to, "    %s, face %zu, angle %.2g degrees, at (%.6g, %.6g, %.6g)\n",
            cause_text(r->bad[i].cause), r->bad[i].face + 1, r->bad[i].angle,
            r->bad[i].at[0], r->bad[i].at[1], r->bad[i].at[2]);
  if (r->n_bad > shown) fprintf(to, "    ... and %zu more\n", r->n_bad - shown);
}

static void back_text(FILE *to, const struct vg_put_back *b)
{
  fprintf(to,
          "  projected onto the CAD model: %zu points, %zu of them onto its "
          "curves; rejected %zu, too far away %zu\n",
          b->n_point - b->n_refused - b->n_far, b->n_curve, b->n_refused,
          b->n_far);
  distance_text(to, "distance of points from CAD before projection",
                &b->off[0]);
  distance_text(to, "distance of points from CAD after projection", &b->off[1]);
}

/* Each row by itself if several request the same place. */
static void spacing_text(FILE *to, const struct vg_remeshing *n)
{
  static const char *const place[VG_SPACING_N] = {
    "edge length at leading edges, % of the local chord",
    "edge length at trailing edges, % of the local chord",
    "edge length along the span at roots, % of the semispan",
    "edge length along the span at tips, % of the semispan"
  };

  for (int k = 0; k < VG_SPACING_N; k++) {
    size_t n_row = 0;

    for (size_t i = 0; i < n->n_row; i++) n_row += n->row[i][k].n > 0;
    for (size_t i = 0; i < n->n_row; i++) {
      const struct vg_edge_spacing *s = &n->row[i][k];
      char row[64] = "";

      if (!s->n) continue;
      if (n_row > 1) snprintf(row, sizeof row, ", row %zu of `surface`", i + 1);
      fprintf(to, "  %s%s: requested %.4g, reached %.4g\n", place[k], row,
              100 * s->asked, 100 * s->reached);
    }
  }
}

static void stretch_text(FILE *to, const struct vg_remesh_report *r)
{
  const size_t *n = r->n_aspect;

  if (!(r->aspect_most > 0)) return;
  fprintf(to,
          "  stretched triangles by aspect ratio: to 1.5 %zu, to 3 %zu, to 6 "
          "%zu, to 12 %zu, more %zu; largest %.3g\n",
          n[0], n[1], n[2], n[3], n[4], r->aspect_most);
  fprintf(to,
          "  smallest angle %.3g degrees; it and the angles listed below are "
          "measured without the stretching\n",
          r->angle_min);
}

void vg_report_remesh_text(FILE *to, const struct vg_remeshing *n)
{
  const struct vg_remesh_report *r = &n->report;
  char was[32], now[32];

  if (!n->is_done) return;
  fprintf(to,
          "  remeshed: triangles %s -> %s; %zu corners and %zu feature curves "
          "preserved, length of curves %.6g -> %.6g\n",
          vg_text_count(r->n_tri[0], was), vg_text_count(r->n_tri[1], now),
          r->n_corner, r->n_line, r->line_length[0], r->line_length[1]);
  if (r->n_left)
    fprintf(to,
            "  strips narrower than the tolerance kept: %zu, since triangles "
            "would intersect\n",
            r->n_left);
  if (r->n_closed)
    fprintf(to,
            "  strips narrower than the tolerance collapsed: %zu, total "
            "length %.6g, largest width %.3g, at (%g, %g, %g)\n",
            r->n_closed, r->closed_length, r->closed_width, r->closed_at[0],
            r->closed_at[1], r->closed_at[2]);
  fprintf(to,
          "  target edge length %.3g to %.3g; edges within a factor of 1.41 "
          "of it: %.2f %%\n",
          r->h_min, r->h_max, percent(r->n_edge_fit, r->n_edge));
  fprintf(to, "  tolerance %.3g, at most 0.05 of the target edge length\n",
          r->tolerance);
  if (r->far > 0)
    fprintf(to,
            "  tolerance on the outer boundary, where the target edge length "
            "exceeds %.3g: 0.05 of it\n",
            r->far);
  distance_text(to, "distance of the remeshed from the input surface",
                &n->off[0]);
  distance_text(to, "distance of the input from the remeshed surface",
                &n->off[1]);
  if (n->back.is_done) back_text(to, &n->back);
  if (n->volume[1] > 0)
    fprintf(to, "  volume %.9g, volume of the CAD model %.9g (%+.3g %%)\n",
            n->volume[0], n->volume[1],
            100 * (n->volume[0] / n->volume[1] - 1));
  if (r->n_round > 1)
    fprintf(to,
            "  remeshed %d times, with the target edge length halved where "
            "triangles intersected\n",
            r->n_round);
  spacing_text(to, n);
  stretch_text(to, r);
  bad_text(to, r);
}

static json_t *distance_json(const struct vg_remesh_distance *d)
{
  return json_pack("{s:f s:[fff] s:f}", "largest", d->most, "at", d->at[0],
                   d->at[1], d->at[2], "percentile_99", d->most_99);
}

static json_t *back_json(const struct vg_put_back *b)
{
  if (!b->is_done) return json_null();
  return json_pack("{s:I s:f s:I s:I s:I s:o s:o s:f}", "points",
                   (json_int_t)b->n_point, "percent_on",
                   percent(b->n_point - b->n_far - b->n_refused, b->n_point),
                   "on_curves", (json_int_t)b->n_curve, "refused",
                   (json_int_t)b->n_refused, "off_model", (json_int_t)b->n_far,
                   "before", distance_json(&b->off[0]), "now",
                   distance_json(&b->off[1]), "seconds", b->seconds);
}

static json_t *volume_json(double v)
{
  return v > 0 ? json_real(v) : json_null();
}

static json_t *closed_json(const struct vg_remesh_report *r)
{
  if (!r->n_closed && !r->n_left) return json_null();
  return json_pack("{s:I s:I s:f s:f s:[fff]}", "number",
                   (json_int_t)r->n_closed, "left", (json_int_t)r->n_left,
                   "length", r->closed_length, "width", r->closed_width, "at",
                   r->closed_at[0], r->closed_at[1], r->closed_at[2]);
}

static json_t *patches_json(const struct vg_remeshing *n,
                            const struct vg_mesh *m)
{
  json_t *list = json_array();

  for (size_t i = 0; i < n->n_patch; i++)
    json_array_append_new(list,
                          json_pack("{s:i s:o s:[ff]}", "id",
                                    (int)m->patch[i].id, "name",
                                    vg_text_json(m->patch[i].name), "area",
                                    n->area[2 * i], n->area[2 * i + 1]));
  return list;
}

static json_t *bad_json(const struct vg_remesh_report *r, size_t shown)
{
  json_t *list = json_array();

  for (size_t i = 0; i < r->n_bad && i < shown; i++) {
    const struct vg_remesh_bad *b = &r->bad[i];

    json_array_append_new(list,
                          json_pack("{s:s s:I s:f s:[fff]}", "cause",
                                    vg_remesh_cause_name(b->cause), "face",
                                    (json_int_t)b->face + 1, "angle", b->angle,
                                    "at", b->at[0], b->at[1], b->at[2]));
  }
  return list;
}

static json_t *stretch_json(const struct vg_remesh_report *r)
{
  const size_t *n = r->n_aspect;

  if (!(r->aspect_most > 0)) return json_null();
  return json_pack("{s:f s:f s:[IIIII]}", "most", r->aspect_most,
                   "smallest_angle", r->angle_min,
                   "triangles_to_1.5_3_6_12_more", (json_int_t)n[0],
                   (json_int_t)n[1], (json_int_t)n[2], (json_int_t)n[3],
                   (json_int_t)n[4]);
}

static json_t *spacing_json(const struct vg_remeshing *n, int place)
{
  const struct vg_edge_spacing *s = &n->spacing[place];
  json_t *rows;

  if (!s->n) return json_null();
  rows = json_array();
  for (size_t i = 0; i < n->n_row; i++) {
    const struct vg_edge_spacing *r = &n->row[i][place];

    if (r->n)
      json_array_append_new(rows, json_pack("{s:I s:f s:f s:I}", "row",
                                            (json_int_t)(i + 1),
                                            "requested_percent", 100 * r->asked,
                                            "reached_percent", 100 * r->reached,
                                            "triangles", (json_int_t)r->n));
  }
  return json_pack("{s:f s:f s:I s:o}", "requested_percent", 100 * s->asked,
                   "reached_percent", 100 * s->reached, "triangles",
                   (json_int_t)s->n, "rows", rows);
}

json_t *vg_report_remesh_json(const struct vg_remeshing *n,
                              const struct vg_mesh *m)
{
  const struct vg_remesh_report *r = &n->report;

  if (!n->is_done) return json_null();
  return json_pack(
    "{s:[II] s:[II] s:I s:I s:[ff] s:f s:f s:f s:f s:i s:f s:o "
    "s:o s:o s:o s:o s:o s:{s:I s:I s:I s:I} s:f s:o s:o s:o "
    "s:o s:o s:o s:o}",
    "triangles", (json_int_t)r->n_tri[0], (json_int_t)r->n_tri[1], "points",
    (json_int_t)r->n_point[0], (json_int_t)r->n_point[1], "corners",
    (json_int_t)r->n_corner, "lines", (json_int_t)r->n_line, "line_length",
    r->line_length[0], r->line_length[1], "tolerance", r->tolerance,
    "body_length", r->length, "size_min", r->h_min, "size_max", r->h_max,
    "rounds", r->n_round, "percent_edges_fit",
    percent(r->n_edge_fit, r->n_edge), "strips_closed", closed_json(r),
    "new_from_given", distance_json(&n->off[0]), "given_from_new",
    distance_json(&n->off[1]), "cad", back_json(&n->back), "volume",
    volume_json(n->volume[0]), "cad_volume", volume_json(n->volume[1]),
    "changes", "splits", (json_int_t)r->n_split, "collapses",
    (json_int_t)r->n_collapse, "swaps", (json_int_t)r->n_swap, "moves",
    (json_int_t)r->n_move, "seconds", n->seconds, "patches", patches_json(n, m),
    "below_20_degrees", bad_json(r, SIZE_MAX), "stretched", stretch_json(r),
    "leading_edges", spacing_json(n, VG_AT_LEAD), "trailing_edges",
    spacing_json(n, VG_AT_TRAIL), "roots", spacing_json(n, VG_AT_ROOT), "tips",
    spacing_json(n, VG_AT_TIP));
}

void vg_report_lines_text(FILE *to, const struct vg_remesh_report *r, int fit)
{
  fprintf(to,
          "  feature curves (sharp edges, rims, borders between conditions): "
          "%zu, length %.6g, corners %zu\n",
          r->n_line, r->line_length[0], r->n_corner);
  if (fit)
    fprintf(to,
            "  edges within a factor of 1.41 of the target edge length given "
            "by shape and deck: %.2f %%\n",
            percent(r->n_edge_fit, r->n_edge));
  bad_text(to, r);
}

json_t *vg_report_lines_json(const struct vg_remesh_report *r, int fit)
{
  json_t *cause = json_object();

  for (int c = 0; c < VG_REMESH_N; c++)
    json_object_set_new(cause, vg_remesh_cause_name((enum vg_remesh_cause)c),
                        json_integer((json_int_t)r->cause[c]));
  return json_pack("{s:I s:I s:f s:o s:I s:o s:o}", "lines",
                   (json_int_t)r->n_line, "corners", (json_int_t)r->n_corner,
                   "line_length", r->line_length[0], "percent_edges_fit",
                   fit ? json_real(percent(r->n_edge_fit, r->n_edge))
                       : json_null(),
                   "below_20_degrees", (json_int_t)r->n_bad, "causes", cause,
                   "first", bad_json(r, VG_LISTED_DEFECTS));
}

void vg_report_distances_text(FILE *to, const char *file,
                              const struct vg_remesh_distance d[2])
{
  fprintf(to, "  comparison with %s\n", file);
  distance_text(to, "distance of this surface from that one", &d[0]);
  distance_text(to, "distance of that surface from this one", &d[1]);
}

json_t *vg_report_distances_json(const char *file,
                                 const struct vg_remesh_distance d[2])
{
  return json_pack("{s:o s:o s:o}", "file", vg_text_json(file),
                   "this_from_that", distance_json(&d[0]), "that_from_this",
                   distance_json(&d[1]));
}
