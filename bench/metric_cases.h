/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* bench/metric_cases.h: the analytic metrics of the Unstructured Grid
 * Adaptation Working Group (github.com/UGAWG/adapt-benchmarks) in the unit
 * cube, scaled to a complexity; meshes measured in them.
 *
 * With r and t the polar coordinates of (x, y) and h0 = 0.001:
 *
 *   linear  h_x = h_y = 0.1, h_z = h0 + 2 (0.1 - h0) |z - 0.5|
 *   polar1  h_t = h_z = 0.1, h_r = h0 + 2 (0.1 - h0) |r - 0.5|
 *   polar2  as polar1, with h_t = d / 40 + (1 - d) / 10, d = 10 (0.6 - r),
 *           where d > 0
 *
 * The published h_t of polar2 has a zero at r = 0.4667, where the complexity is
 * infinite; the groups evaluated it at the points of an initial mesh. Here
 * |h_t| is at least 1/40, its value at r = 0.5, where h_r is smallest. */
#ifndef VG_BENCH_METRIC_CASES_H
#define VG_BENCH_METRIC_CASES_H

#include <stdio.h>

#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"

enum metric_kind { METRIC_LINEAR, METRIC_POLAR1, METRIC_POLAR2, METRIC_KINDS };

struct metric_case {
  enum metric_kind kind;
  int is_cylinder; /* 1: without the cylinder of radius 0.5 around the z axis */
  double scale;    /* factor on the sizes */
};

/** "linear", "polar1", "polar2", each also with "-cylinder". -1: unknown. */
int metric_case_find(const char *name, struct metric_case *out);

/** Set the scale for a complexity: the integral of sqrt(det M) over the domain,
 * by the midpoint rule along the only coordinate on which it depends. */
void metric_case_scale(struct metric_case *c, double complexity);

/** Metric M at x. */
void metric_case_at(const struct metric_case *c, const double x[3],
                    double m[6]);

/** Smallest and largest size at x, and smallest one within a box. */
void metric_case_sizes(const struct metric_case *c, const double x[3],
                       double *least, double *most);
double metric_case_least(const struct metric_case *c, const double lo[3],
                         const double hi[3]);

/** The case as a map of the sizing field, which refers to *c. */
struct vg_size_map metric_case_map(struct metric_case *c);

/* Figures of a mesh, from the metrics at its points. */
struct metric_figures {
  size_t n_point, n_cell, n_edge;
  double within[4]; /* % of lengths in [0.7, 1.4], [1/sqrt 2, sqrt 2],
                       [0.5, 2], [0.3, 3] */
  double shortest, longest;
  double mean, worst; /* mean ratio */
  double below[2];    /* % of mean ratios below 0.1, 0.2 */
};

/** Measure the tetrahedra of m by the definitions alone (logarithms, powers,
 * every edge once), independent of the mesh check. VG_ERR_MEMORY. */
vg_status metric_measure(const struct metric_case *c, const struct vg_mesh *m,
                         struct metric_figures *out, struct vg_error *err);

/** Write a row of a table, or its head. seconds < 0: not known. */
void metric_head(FILE *to);
void metric_row(FILE *to, const char *name, double complexity,
                const struct metric_figures *f, double seconds);

/** Write a background mesh that is finer than the metric, STEM.meshb with the
 * metrics at its points in STEM.sol. */
vg_status metric_background(const struct metric_case *c, const char *stem,
                            struct vg_error *err);

#endif
