/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on the orthogonality of the median dual. */
#include "run/common/text.h"
#include "run/report/report_parts.h"

void vg_report_dual_text(FILE *to, const struct vg_dual_quality *q)
{
  char count[32];

  fprintf(to,
          "  orthogonality of the median dual (degrees; 90 is best)\n"
          "    at points, least %.2f; below 1, 10, 20: %.3g, %.3g, %.3g %% of "
          "the points\n"
          "    of faces, least %.2f; 0 or less: %s faces\n"
          "    ratio of sub-volumes at points, largest: %.4g\n",
          q->point_min, q->below[0], q->below[1], q->below[2], q->face_min,
          vg_text_count(q->n_opposed, count), q->volume_ratio_max);
}

static void put_places(FILE *to, const struct vg_dual_quality *q, int list,
                       const char *title, const char *of, const char *unit)
{
  if (q->n_worst[list]) fprintf(to, "\n  %s\n", title);
  for (size_t i = 0; i < q->n_worst[list]; i++) {
    const struct vg_worst_place *w = &q->worst[list][i];

    fprintf(to, "    %s %zu: %.4g%s at (%g, %g, %g)\n", of, w->cell + 1,
            w->value, unit, w->at[0], w->at[1], w->at[2]);
  }
}

void vg_report_dual_places(FILE *to, const struct vg_dual_quality *q)
{
  put_places(to, q, VG_WORST_DUAL_POINT,
             "Worst orthogonality of the median dual at points", "point",
             " degrees");
  put_places(to, q, VG_WORST_DUAL_FACE,
             "Worst orthogonality of faces of the median dual",
             "edge from point", " degrees");
  put_places(to, q, VG_WORST_DUAL_VOLUME,
             "Worst ratio of sub-volumes of the median dual", "point", "");
}

static json_t *places_json(const struct vg_dual_quality *q, int list)
{
  json_t *all = json_array();

  for (size_t i = 0; i < q->n_worst[list]; i++) {
    const struct vg_worst_place *w = &q->worst[list][i];

    json_array_append_new(all, json_pack("{s:o s:o s:o}", "point",
                                         vg_json_count(w->cell + 1), "value",
                                         vg_json_real(w->value), "at",
                                         vg_json_reals(w->at, 3)));
  }
  return all;
}

json_t *vg_report_dual_json(const struct vg_dual_quality *q)
{
  return json_pack("{s:o s:o s:o s:o s:o s:o s:o s:o s:o s:o}", "points",
                   vg_json_count(q->n_point), "faces", vg_json_count(q->n_face),
                   "orthogonality_min", vg_json_real(q->point_min),
                   "percent_points_below_1_10_20", vg_json_reals(q->below, 3),
                   "face_orthogonality_min", vg_json_real(q->face_min),
                   "opposed_faces", vg_json_count(q->n_opposed), "worst_points",
                   places_json(q, VG_WORST_DUAL_POINT), "worst_faces",
                   places_json(q, VG_WORST_DUAL_FACE), "volume_ratio_max",
                   vg_json_real(q->volume_ratio_max), "worst_volume_ratio",
                   places_json(q, VG_WORST_DUAL_VOLUME));
}
