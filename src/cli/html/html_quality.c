/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Quality of the cells: histograms and figures. */
#include <stdio.h>

#include "cli/html/page.h"

static void fact(struct page *p, const char *name, double v, int decimals,
                 const char *unit)
{
  vg_page_fact(p, name);
  vg_page_fixed(p, v, decimals);
  vg_page_format(p, "%s</td></tr>\n", unit);
}

static double of(const struct page *p, const char *name)
{
  char path[64];

  snprintf(path, sizeof path, "%s.%s", vg_page_judged(p), name);
  return vg_page_number(p, path);
}

static const json_t *block(const struct page *p, const char *name)
{
  char path[64];

  snprintf(path, sizeof path, "%s.%s", vg_page_judged(p), name);
  return vg_page_json(p, path);
}

static double item(const struct page *p, const char *name, size_t i)
{
  return json_number_value(json_array_get(block(p, name), i));
}

static void shares(struct page *p)
{
  static const int below[] = { 5, 10, 15, 20, 30 }, above[] = { 150, 160, 170 };
  char name[60];

  for (size_t i = 0; i < 5; i++) {
    snprintf(name, sizeof name, "Cells with an angle below %d\302\260",
             below[i]);
    fact(p, name, item(p, "percent_below_5_10_15_20_30", i), 4, " %");
  }
  for (size_t i = 0; i < 3; i++) {
    snprintf(name, sizeof name, "Cells with an angle above %d\302\260",
             above[i]);
    fact(p, name, item(p, "percent_above_150_160_170", i), 4, " %");
  }
}

static double share_of(const json_t *metric, const char *name, size_t i)
{
  return json_number_value(json_array_get(json_object_get(metric, name), i));
}

static double real_of(const json_t *metric, const char *name)
{
  return json_number_value(json_object_get(metric, name));
}

static void metric_facts(struct page *p, const json_t *m)
{
  fact(p, "Edges with a length of 0.7 to 1.4 in the metric",
       share_of(m, "percent_within", 0), 2, " %");
  fact(p, "Edges with a length of 0.71 to 1.41",
       share_of(m, "percent_within", 1), 2, " %");
  fact(p, "Edges with a length of 0.5 to 2", share_of(m, "percent_within", 2),
       2, " %");
  fact(p, "Length in the metric, smallest", real_of(m, "length_min"), 3, "");
  fact(p, "Length in the metric, largest", real_of(m, "length_max"), 3, "");
  fact(p, "Mean ratio in the metric, mean", real_of(m, "mean_ratio_mean"), 4,
       "");
  fact(p, "Mean ratio in the metric, smallest", real_of(m, "mean_ratio_min"), 4,
       "");
  fact(p, "Cells with a mean ratio below 0.1 in the metric",
       share_of(m, "percent_below", 0), 4, " %");
  fact(p, "Cells with a mean ratio below 0.2 in the metric",
       share_of(m, "percent_below", 1), 4, " %");
  vg_page_fact_count(p, "Complexity of the metric",
                     (uint64_t)real_of(m, "complexity"));
  fact(p, "Number of cells / ideal number in the metric",
       real_of(m, "cells_per_ideal"), 3, "");
}

static void facts(struct page *p)
{
  const json_t *edges = block(p, "edges");

  vg_page_markup(p, "<table class=\"facts\">\n");
  vg_page_fact_count(p, "Tetrahedra examined", (uint64_t)of(p, "cells"));
  fact(p, "Smallest dihedral angle", of(p, "angle_min"), 2, "&deg;");
  fact(p, "Largest dihedral angle", of(p, "angle_max"), 2, "&deg;");
  fact(p, "Smallest angle of each cell, 1st percentile", of(p, "angle_min_p1"),
       1, "&deg;");
  shares(p);
  fact(p, "Radius ratio, mean", of(p, "radius_ratio_mean"), 4, "");
  fact(p, "Radius ratio, smallest", of(p, "radius_ratio_min"), 4, "");
  fact(p, "Mean ratio, mean", of(p, "mean_ratio_mean"), 4, "");
  fact(p, "Volume ratio of neighbouring cells, median",
       item(p, "volume_ratio_median_95_max", 0), 2, "");
  fact(p, "Volume ratio, 95th percentile",
       item(p, "volume_ratio_median_95_max", 1), 2, "");
  fact(p, "Volume ratio, largest", item(p, "volume_ratio_median_95_max", 2), 2,
       "");
  if (json_is_object(block(p, "metric"))) {
    metric_facts(p, block(p, "metric"));
  } else if (json_is_object(edges)) {
    fact(p, "Edge length / target edge length, mean",
         json_number_value(json_object_get(edges, "mean")), 3, "");
    fact(p, "Edges with a ratio of 0.7 to 1.5",
         json_number_value(json_object_get(edges, "percent_within")), 2, " %");
  }
  vg_page_markup(p, "</table>\n");
}

/* Counts of histogram_length with three bins joined to one. */
static json_t *joined(const json_t *counts)
{
  json_t *list = json_array();

  for (size_t i = 0; i + 2 < json_array_size(counts); i += 3) {
    json_int_t sum = 0;

    for (size_t k = 0; k < 3; k++)
      sum += json_integer_value(json_array_get(counts, i + k));
    json_array_append_new(list, json_integer(sum));
  }
  return list;
}

static void metric_bars(struct page *p, const json_t *metric)
{
  static const struct bars length = {
    .title = "Edge length in the metric",
    .unit = "1: as requested",
    .alt = "Histogram of the edge length in the metric.",
    .bad_below = 0.5,
    .bad_from = 2,
    .lowest = VG_LENGTH_LOWEST,
    .per_octave = 4
  };
  static const struct bars ratio = {
    .title = "Mean ratio in the metric",
    .unit = "1: regular tetrahedron in the metric",
    .alt = "Histogram of the mean ratio of each cell in the metric.",
    .decimals = 1,
    .step = 0.05,
    .bad_below = 0.2,
    .bad_from = 1e9
  };
  json_t *counts = joined(json_object_get(metric, "histogram_length"));

  vg_html_bars(p, &length, counts);
  vg_html_bars(p, &ratio, json_object_get(metric, "histogram_mean_ratio"));
  json_decref(counts);
}

void vg_html_quality(struct page *p)
{
  static const struct bars least = {
    .title = "Smallest dihedral angle of each cell",
    .unit = "degrees",
    .alt = "Histogram of the smallest dihedral angle of each cell.",
    .step = 5,
    .bad_below = 10,
    .bad_from = 1e9
  };
  static const struct bars most = {
    .title = "Largest dihedral angle of each cell",
    .unit = "degrees",
    .alt = "Histogram of the largest dihedral angle of each cell.",
    .step = 5,
    .bad_from = 160
  };
  static const struct bars ratio = {
    .title = "Radius ratio (3 inradius / circumradius)",
    .unit = "1: regular tetrahedron",
    .alt = "Histogram of the radius ratio of each cell.",
    .decimals = 1,
    .step = 0.05,
    .bad_below = 0.1,
    .bad_from = 1e9
  };
  static const struct bars edge = {
    .title = "Edge length / target edge length",
    .unit = "1: as requested",
    .alt = "Histogram of edge length over target edge length.",
    .decimals = 1,
    .step = 0.1,
    .bad_below = 0.4,
    .bad_from = 1.8
  };
  const json_t *edges = block(p, "edges");

  vg_page_section(p, "quality", "Quality of the cells");
  vg_page_markup(
    p, p->has_layers
         ? "<p>Cells outside the layers. Layer cells are flat by design; "
           "their heights and volume ratios are shown above.</p>\n"
         : "");
  vg_page_markup(p, "<p>Counts have a logarithmic scale, since poor cells are "
                    "rare; bins of poor cells are red.</p>\n"
                    "<div class=\"charts\">\n");
  vg_html_bars(p, &least, block(p, "histogram_angle_min"));
  vg_html_bars(p, &most, block(p, "histogram_angle_max"));
  vg_html_bars(p, &ratio, block(p, "histogram_radius_ratio"));
  if (json_is_object(block(p, "metric"))) metric_bars(p, block(p, "metric"));
  else if (json_is_object(edges))
    vg_html_bars(p, &edge, json_object_get(edges, "histogram"));
  vg_page_markup(p, "</div>\n<div class=\"pair\">\n");
  vg_html_angles(p);
  facts(p);
  vg_page_markup(p, "</div>\n");
  vg_page_end_section(p);
}
