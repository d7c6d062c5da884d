/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on the quality of a mesh in the terms of solvers that work on finite
 * volumes. */
#include "run/common/text.h"
#include "run/report/report_parts.h"

/* A figure of the table: its name, its worst and mean value, and the number of
 * faces or cells beyond the limit of checkMesh. Absent: NAN. */
struct row {
  const char *name;
  double worst, mean;
  int digits;
  const char *limit;
  size_t n;
};

static void put_row(FILE *to, const struct row *r)
{
  char count[32];

  fprintf(to, "    %-30s %10.*f", r->name, r->digits, r->worst);
  if (isfinite(r->mean)) fprintf(to, " %10.*f", r->digits, r->mean);
  else fprintf(to, " %10s", "");
  if (r->limit)
    fprintf(to, "   %11s: %11s", r->limit, vg_text_count(r->n, count));
  fputc('\n', to);
}

void vg_report_volumes_text(FILE *to, const struct vg_solver_quality *q)
{
  const struct row row[] = {
    { "non-orthogonality (degrees)", q->angle_max, q->angle_mean, 2, "above 70",
      q->n_angle },
    { "skewness of faces", q->skewness_max, NAN, 3, "above 4", q->n_skewness },
    { "face weight", q->weight_min, NAN, 4, "below 0.05", q->n_weight },
    { "volume ratio of neighbours", q->volume_ratio_min, NAN, 4, "below 0.01",
      q->n_volume_ratio },
    { "cell determinant", q->determinant_min, NAN, 6, "below 0.001",
      q->n_determinant },
    { "orthogonal quality", q->quality_min, q->quality_mean, 4, NULL, 0 },
  };

  fprintf(to, "  %-32s %10s %10s   %s\n", "quality in the terms of solvers",
          "worst", "mean", "faces or cells");
  for (size_t i = 0; i < sizeof row / sizeof *row; i++)
    if (!isnan(row[i].worst)) put_row(to, &row[i]);
  if (q->n_skewness)
    fputs(
      "    skewness above 4 is mostly due to sharp edges with one column per "
      "point, which\n    fans avoid (--cells mixed, --fan-angle 85), and to "
      "points where such edges end\n",
      to);
}

void vg_report_places(FILE *to, size_t n, const struct vg_worst_place *worst,
                      const char *title, const char *of, const char *unit)
{
  if (n) fprintf(to, "\n  %s\n", title);
  for (size_t i = 0; i < n; i++) {
    const struct vg_worst_place *w = &worst[i];

    fprintf(to, "    %s %zu: %.4g%s at (%g, %g, %g)\n", of, w->cell + 1,
            w->value, unit, w->at[0], w->at[1], w->at[2]);
  }
}

json_t *vg_report_places_json(size_t n, const struct vg_worst_place *worst,
                              const char *of)
{
  json_t *all = json_array();

  for (size_t i = 0; i < n; i++) {
    const struct vg_worst_place *w = &worst[i];

    json_array_append_new(all, json_pack("{s:o s:o s:o}", of,
                                         vg_json_count(w->cell + 1), "value",
                                         vg_json_real(w->value), "at",
                                         vg_json_reals(w->at, 3)));
  }
  return all;
}

static void put_bars(FILE *to, const char *title, const size_t *hist, size_t n,
                     double width, int digits)
{
  double limit[VG_HIST_ANGLE + 1];

  for (size_t i = 0; i <= n; i++) limit[i] = width * (double)i;
  vg_report_bars(to, title, n, hist, limit, digits);
}

void vg_report_volumes_bars(FILE *to, const struct vg_solver_quality *q)
{
  put_bars(to, "Non-orthogonality of each face (degrees)", q->hist_angle,
           VG_HIST_ANGLE, 5, 0);
  put_bars(to, "Skewness of each face", q->hist_skewness, VG_HIST_SKEW, 0.25,
           2);
  put_bars(to, "Orthogonal quality of each cell", q->hist_quality, VG_HIST_UNIT,
           0.05, 2);
  vg_report_places(to, q->n_worst[VG_WORST_ANGLE], q->worst[VG_WORST_ANGLE],
                   "Worst non-orthogonality", "face of cell", " degrees");
  vg_report_places(to, q->n_worst[VG_WORST_SKEWNESS],
                   q->worst[VG_WORST_SKEWNESS], "Worst skewness",
                   "face of cell", "");
  vg_report_places(to, q->n_worst[VG_WORST_QUALITY], q->worst[VG_WORST_QUALITY],
                   "Worst orthogonal quality", "cell", "");
}

json_t *vg_report_volumes_json(const struct vg_solver_quality *q)
{
  const struct {
    const char *name;
    double v;
  } real[] = {
    { "non_orthogonality_max", q->angle_max },
    { "non_orthogonality_mean", q->angle_mean },
    { "skewness_max", q->skewness_max },
    { "face_weight_min", q->weight_min },
    { "volume_ratio_min", q->volume_ratio_min },
    { "determinant_min", q->determinant_min },
    { "orthogonal_quality_min", q->quality_min },
    { "orthogonal_quality_mean", q->quality_mean },
  };
  const struct {
    const char *name;
    size_t n;
  } count[] = {
    { "non_orthogonality", q->n_angle }, { "skewness", q->n_skewness },
    { "face_weight", q->n_weight },      { "volume_ratio", q->n_volume_ratio },
    { "determinant", q->n_determinant },
  };
  json_t *o = json_object(), *beyond = json_object();

  for (size_t i = 0; i < sizeof real / sizeof *real; i++)
    json_object_set_new(o, real[i].name, vg_json_real(real[i].v));
  for (size_t i = 0; i < sizeof count / sizeof *count; i++)
    json_object_set_new(beyond, count[i].name, vg_json_count(count[i].n));
  json_object_set_new(o, "beyond_limits", beyond);
  json_object_set_new(o, "inner_faces", vg_json_count(q->n_face));
  json_object_set_new(o, "boundary_faces", vg_json_count(q->n_boundary_face));
  json_object_set_new(o, "histogram_non_orthogonality",
                      vg_json_counts(q->hist_angle, VG_HIST_ANGLE));
  json_object_set_new(o, "histogram_skewness",
                      vg_json_counts(q->hist_skewness, VG_HIST_SKEW));
  json_object_set_new(o, "histogram_orthogonal_quality",
                      vg_json_counts(q->hist_quality, VG_HIST_UNIT));
  json_object_set_new(o, "worst_non_orthogonality",
                      vg_report_places_json(q->n_worst[VG_WORST_ANGLE],
                                            q->worst[VG_WORST_ANGLE], "cell"));
  json_object_set_new(o, "worst_skewness",
                      vg_report_places_json(q->n_worst[VG_WORST_SKEWNESS],
                                            q->worst[VG_WORST_SKEWNESS],
                                            "cell"));
  json_object_set_new(o, "worst_orthogonal_quality",
                      vg_report_places_json(q->n_worst[VG_WORST_QUALITY],
                                            q->worst[VG_WORST_QUALITY],
                                            "cell"));
  return o;
}
