/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Report on a mesh in two dimensions. Declared in run/report/report.h. */
#include "run/common/text.h"
#include "run/report/report.h"
#include "run/report/report_parts.h"

void vg_report_plane_text(FILE *to, const struct vg_plane_report *r)
{
  char count[32];

  fprintf(to, "  %-24s %15s\n", "points", vg_text_count(r->n_point, count));
  fprintf(to, "  %-24s %15s\n", "quadrilaterals",
          vg_text_count(r->n_quad, count));
  fprintf(to, "  %-24s %15s\n", "triangles", vg_text_count(r->n_tri, count));
  fprintf(to, "  %-24s %15s\n", "of these in layers",
          vg_text_count(r->n_layer_tri, count));
  if (r->n_quad)
    fprintf(to,
            "  angles of quadrilaterals (degrees): smallest %.2f, largest "
            "%.2f\n",
            r->quad_min, r->quad_max);
  if (!r->n_field) return;
  fprintf(to,
          "  angles of triangles outside the layers (degrees): smallest %.2f "
          "at (%.6g, %.6g),\n  largest %.2f; 1st percentile of each "
          "triangle's smallest %.2f\n  triangles with an angle below",
          r->angle_min, r->at[0], r->at[1], r->angle_max, r->angle_percentile);
  for (int k = 0; k < VG_PLANE_LIMITS; k++)
    fprintf(to, "%s %g", k ? "," : "", vg_plane_limit[k]);
  fprintf(to, " degrees:");
  for (int k = 0; k < VG_PLANE_LIMITS; k++)
    fprintf(to, " %s", vg_text_count(r->n_below[k], count));
  fprintf(to, "\n");
}

json_t *vg_report_plane_json(const struct vg_plane_report *r)
{
  json_t *o = json_object();

  json_object_set_new(o, "points", vg_json_count(r->n_point));
  json_object_set_new(o, "quadrilaterals", vg_json_count(r->n_quad));
  json_object_set_new(o, "triangles", vg_json_count(r->n_tri));
  json_object_set_new(o, "layer_triangles", vg_json_count(r->n_layer_tri));
  json_object_set_new(o, "quadrilateral_angle_min", vg_json_real(r->quad_min));
  json_object_set_new(o, "quadrilateral_angle_max", vg_json_real(r->quad_max));
  json_object_set_new(o, "angle_min", vg_json_real(r->angle_min));
  json_object_set_new(o, "angle_max", vg_json_real(r->angle_max));
  json_object_set_new(o, "angle_percentile", vg_json_real(r->angle_percentile));
  json_object_set_new(o, "angle_min_at", vg_json_reals(r->at, 2));
  json_object_set_new(o, "angle_limits",
                      vg_json_reals(vg_plane_limit, VG_PLANE_LIMITS));
  json_object_set_new(o, "triangles_below",
                      vg_json_counts(r->n_below, VG_PLANE_LIMITS));
  return o;
}
