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

void vg_report_dual_places(FILE *to, const struct vg_dual_quality *q)
{
  vg_report_places(to, q->n_worst[VG_WORST_DUAL_POINT],
                   q->worst[VG_WORST_DUAL_POINT],
                   "Worst orthogonality of the median dual at points", "point",
                   " degrees");
  vg_report_places(to, q->n_worst[VG_WORST_DUAL_FACE],
                   q->worst[VG_WORST_DUAL_FACE],
                   "Worst orthogonality of faces of the median dual",
                   "edge from point", " degrees");
  vg_report_places(to, q->n_worst[VG_WORST_DUAL_VOLUME],
                   q->worst[VG_WORST_DUAL_VOLUME],
                   "Worst ratio of sub-volumes of the median dual", "point",
                   "");
}

json_t *vg_report_dual_json(const struct vg_dual_quality *q)
{
  return json_pack(
    "{s:o s:o s:o s:o s:o s:o s:o s:o s:o s:o}", "points",
    vg_json_count(q->n_point), "faces", vg_json_count(q->n_face),
    "orthogonality_min", vg_json_real(q->point_min),
    "percent_points_below_1_10_20", vg_json_reals(q->below, 3),
    "face_orthogonality_min", vg_json_real(q->face_min), "opposed_faces",
    vg_json_count(q->n_opposed), "worst_points",
    vg_report_places_json(q->n_worst[VG_WORST_DUAL_POINT],
                          q->worst[VG_WORST_DUAL_POINT], "point"),
    "worst_faces",
    vg_report_places_json(q->n_worst[VG_WORST_DUAL_FACE],
                          q->worst[VG_WORST_DUAL_FACE], "point"),
    "volume_ratio_max", vg_json_real(q->volume_ratio_max), "worst_volume_ratio",
    vg_report_places_json(q->n_worst[VG_WORST_DUAL_VOLUME],
                          q->worst[VG_WORST_DUAL_VOLUME], "point"));
}
