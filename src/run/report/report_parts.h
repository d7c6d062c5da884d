/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to run/report: numbers as JSON, histograms, and figures in the
 * metric. */
#ifndef VG_RUN_REPORT_REPORT_PARTS_H
#define VG_RUN_REPORT_REPORT_PARTS_H

#include <math.h>
#include <stdio.h>

#include "core/judge/quality.h"
#include "run/common/json_build.h"

/** null if v is not finite. */
static inline json_t *vg_json_real(double v)
{
  return isfinite(v) ? json_real(v) : json_null();
}

static inline json_t *vg_json_reals(const double *v, size_t n)
{
  json_t *list = json_array();

  for (size_t i = 0; i < n; i++)
    json_array_append_new(list, vg_json_real(v[i]));
  return list;
}

static inline json_t *vg_json_count(size_t n)
{
  return json_integer((json_int_t)n);
}

static inline json_t *vg_json_counts(const size_t *v, size_t n)
{
  json_t *list = json_array();

  for (size_t i = 0; i < n; i++)
    json_array_append_new(list, vg_json_count(v[i]));
  return list;
}

/** A histogram as text, without empty bins at both ends; nothing if all bins
 * are empty.
 *
 * @param limit   [n + 1] limits of the bins
 * @param digits  decimals of the limits */
void vg_report_bars(FILE *to, const char *title, size_t n, const size_t *hist,
                    const double *limit, int digits);

/** report_metric.c: figures in the metric; their histograms. */
void vg_report_metric_text(FILE *to, const struct vg_metric_report *r);
void vg_report_metric_bars(FILE *to, const struct vg_metric_report *r);
json_t *vg_report_metric_json(const struct vg_metric_report *r);

/** report_volumes.c: quality in the terms of solvers; histograms and worst
 * places. */
void vg_report_volumes_text(FILE *to, const struct vg_solver_quality *q);
void vg_report_volumes_bars(FILE *to, const struct vg_solver_quality *q);
json_t *vg_report_volumes_json(const struct vg_solver_quality *q);

/** report_volumes.c: n worst places as text, nothing if n is 0, and as JSON.
 *
 * @param of    what the numbers count; in JSON the name of their member
 * @param unit  of the figures, with a space in front; "": none */
void vg_report_places(FILE *to, size_t n, const struct vg_worst_place *worst,
                      const char *title, const char *of, const char *unit);
json_t *vg_report_places_json(size_t n, const struct vg_worst_place *worst,
                              const char *of);

/** report_dual.c: orthogonality of the median dual; worst places. */
void vg_report_dual_text(FILE *to, const struct vg_dual_quality *q);
void vg_report_dual_places(FILE *to, const struct vg_dual_quality *q);
json_t *vg_report_dual_json(const struct vg_dual_quality *q);

#endif
