/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Reports on lengths and cells in the metric of the sizing field. */
#include "run/common/text.h"
#include "run/report/report_parts.h"

/* In texts, four bins per octave. */
enum { MERGED = VG_PER_OCTAVE / 4, SHOWN = VG_HIST_LENGTH / MERGED };

static double cells_per_ideal(const struct vg_metric_report *r)
{
  return r->ideal > 0 ? (double)r->n_cell / r->ideal : 0;
}

void vg_report_metric_text(FILE *to, const struct vg_metric_report *r)
{
  char edges[32], cells[32], complexity[32], ideal[32];

  fprintf(to,
          "  in the metric of the sizing field:\n"
          "    lengths of %s edges: between 0.7 and 1.4 %.2f %%, 0.71 and 1.41 "
          "%.2f %%, 0.5 and 2 %.2f %%;\n    shortest %.3f, longest %.3f\n",
          vg_text_count(r->n_edge, edges), r->within[0], r->within[1],
          r->within[2], r->length_min, r->length_max);
  fprintf(to,
          "    mean ratio of %s cells: mean %.4f, smallest %.4f; below 0.1 "
          "%.4f %%, below 0.2 %.4f %%\n",
          vg_text_count(r->n_cell, cells), r->mean_ratio_mean,
          r->mean_ratio_min, r->below[0], r->below[1]);
  fprintf(to,
          "    complexity %s; ideal number of cells %s, actual number / ideal "
          "%.3f\n",
          vg_text_count((unsigned long long)(r->complexity + 0.5), complexity),
          vg_text_count((unsigned long long)(r->ideal + 0.5), ideal),
          cells_per_ideal(r));
}

void vg_report_metric_bars(FILE *to, const struct vg_metric_report *r)
{
  static const double root[4] = { 1, 1.189207115002721, 1.4142135623730951,
                                  1.681792830507429 };
  size_t hist[SHOWN] = { 0 };
  double limit[SHOWN + 1], octave = VG_LENGTH_LOWEST;

  for (size_t i = 0; i < VG_HIST_LENGTH; i++)
    hist[i / MERGED] += r->hist_length[i];
  for (size_t i = 0; i <= SHOWN; i++) {
    limit[i] = octave * root[i % 4];
    if (i % 4 == 3) octave *= 2;
  }
  vg_report_bars(to, "Edge length in the metric", SHOWN, hist, limit, 3);
  for (size_t i = 0; i <= VG_HIST_UNIT; i++)
    limit[i] = (double)i / VG_HIST_UNIT;
  vg_report_bars(to, "Mean ratio in the metric", VG_HIST_UNIT,
                 r->hist_mean_ratio, limit, 2);
}

json_t *vg_report_metric_json(const struct vg_metric_report *r)
{
  json_t *o = json_object();

  json_object_set_new(o, "edges", vg_json_count(r->n_edge));
  json_object_set_new(o, "length_min", vg_json_real(r->length_min));
  json_object_set_new(o, "length_max", vg_json_real(r->length_max));
  json_object_set_new(o, "percent_within", vg_json_reals(r->within, 3));
  json_object_set_new(o, "histogram_length",
                      vg_json_counts(r->hist_length, VG_HIST_LENGTH));
  json_object_set_new(o, "cells", vg_json_count(r->n_cell));
  json_object_set_new(o, "mean_ratio_mean", vg_json_real(r->mean_ratio_mean));
  json_object_set_new(o, "mean_ratio_min", vg_json_real(r->mean_ratio_min));
  json_object_set_new(o, "percent_below", vg_json_reals(r->below, 2));
  json_object_set_new(o, "histogram_mean_ratio",
                      vg_json_counts(r->hist_mean_ratio, VG_HIST_UNIT));
  json_object_set_new(o, "complexity", vg_json_real(r->complexity));
  json_object_set_new(o, "ideal_cells", vg_json_real(r->ideal));
  json_object_set_new(o, "cells_per_ideal", vg_json_real(cells_per_ideal(r)));
  return o;
}
