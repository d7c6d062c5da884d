/* Quality: histograms and figures. */
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
    snprintf(name, sizeof name, "cells below %d\302\260", below[i]);
    fact(p, name, item(p, "percent_below_5_10_15_20_30", i), 4, " %");
  }
  for (size_t i = 0; i < 3; i++) {
    snprintf(name, sizeof name, "cells above %d\302\260", above[i]);
    fact(p, name, item(p, "percent_above_150_160_170", i), 4, " %");
  }
}

static void facts(struct page *p)
{
  const json_t *edges = block(p, "edges");

  vg_page_markup(p, "<table class=\"facts\">\n");
  vg_page_fact_count(p, "tetrahedra judged", (uint64_t)of(p, "cells"));
  fact(p, "smallest dihedral angle", of(p, "angle_min"), 2, "&deg;");
  fact(p, "largest", of(p, "angle_max"), 2, "&deg;");
  fact(p, "1 % of the cells have a smallest below", of(p, "angle_min_p1"), 1,
       "&deg;");
  shares(p);
  fact(p, "radius ratio, mean", of(p, "radius_ratio_mean"), 4, "");
  fact(p, "radius ratio, smallest", of(p, "radius_ratio_min"), 4, "");
  fact(p, "mean ratio, mean", of(p, "mean_ratio_mean"), 4, "");
  fact(p, "volume ratio of neighbours, median",
       item(p, "volume_ratio_median_95_max", 0), 2, "");
  fact(p, "5 % exceed", item(p, "volume_ratio_median_95_max", 1), 2, "");
  fact(p, "largest", item(p, "volume_ratio_median_95_max", 2), 2, "");
  if (json_is_object(edges)) {
    fact(p, "edge over target, mean",
         json_number_value(json_object_get(edges, "mean")), 3, "");
    fact(p, "edges within 0.7 to 1.5 of it",
         json_number_value(json_object_get(edges, "percent_within")), 2, " %");
  }
  vg_page_markup(p, "</table>\n");
}

void vg_html_quality(struct page *p)
{
  static const struct bars least = {
    "Smallest dihedral angle of each cell",
    "degrees",
    "Histogram of the smallest dihedral angle of each cell.",
    0,
    5,
    10,
    1e9
  };
  static const struct bars most = {
    "Largest dihedral angle of each cell",
    "degrees",
    "Histogram of the largest dihedral angle of each cell.",
    0,
    5,
    0,
    160
  };
  static const struct bars ratio = { "Radius ratio, 3 inradius / "
                                     "circumradius",
                                     "1: regular",
                                     "Histogram of radius ratios.",
                                     1,
                                     0.05,
                                     0.1,
                                     1e9 };
  static const struct bars edge = { "Edges over the size asked for there",
                                    "1: as asked",
                                    "Histogram of edge lengths over target.",
                                    1,
                                    0.1,
                                    0.4,
                                    1.8 };
  const json_t *edges = block(p, "edges");

  vg_page_section(p, "quality", "Quality of the cells");
  vg_page_markup(
    p, p->has_layers
         ? "<p>Of the field. Cells of the layers are flat by intent; their "
           "heights and volumes are judged above.</p>\n"
         : "");
  vg_page_markup(p, "<p>Counts are drawn by their logarithm, as what matters "
                    "is rare; bars of cells to look at are red.</p>\n"
                    "<div class=\"charts\">\n");
  vg_html_bars(p, &least, block(p, "histogram_angle_min"));
  vg_html_bars(p, &most, block(p, "histogram_angle_max"));
  vg_html_bars(p, &ratio, block(p, "histogram_radius_ratio"));
  if (json_is_object(edges))
    vg_html_bars(p, &edge, json_object_get(edges, "histogram"));
  vg_page_markup(p, "</div>\n<div class=\"pair\">\n");
  vg_html_angles(p);
  facts(p);
  vg_page_markup(p, "</div>\n");
  vg_page_end_section(p);
}
