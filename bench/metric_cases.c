/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "metric_cases.h"

#include <math.h>
#include <string.h>

#include "core/geometry/tensor.h"

#define H0 0.001
#define H1 0.1
#define LAYER 0.5 /* z or r of the smallest size */
#define PANELS (1 << 20)

int metric_case_find(const char *name, struct metric_case *out)
{
  static const char *const known[METRIC_KINDS] = { "linear", "polar1",
                                                   "polar2" };
  const char *dash = strchr(name, '-');
  size_t n = dash ? (size_t)(dash - name) : strlen(name);

  if (dash && strcmp(dash, "-cylinder") != 0) return -1;
  for (int k = 0; k < METRIC_KINDS; k++) {
    if (strlen(known[k]) != n || strncmp(known[k], name, n) != 0) continue;
    *out = (struct metric_case){ (enum metric_kind)k, dash != NULL, 1 };
    return 0;
  }
  return -1;
}

/* Sizes across and along the layer and along z at a distance r from the axis,
 * or z from the base. */
static void sizes(const struct metric_case *c, double r, double h[3])
{
  double d = 10 * (0.6 - r);

  h[0] = H0 + 2 * (H1 - H0) * fabs(r - LAYER);
  h[1] = h[2] = H1;
  if (c->kind == METRIC_POLAR2 && d > 0)
    h[1] = fmax(fabs(d / 40 + (1 - d) / 10), 1. / 40);
  for (int k = 0; k < 3; k++) h[k] *= c->scale;
}

/* Area of the domain at z, or area per dr at r. */
static double section(const struct metric_case *c, double r)
{
  if (c->kind == METRIC_LINEAR)
    return c->is_cylinder ? 1 - M_PI * LAYER * LAYER / 4 : 1;
  if (c->is_cylinder && r < LAYER) return 0;
  return r * (r <= 1 ? M_PI / 2 : M_PI / 2 - 2 * acos(1 / r));
}

void metric_case_scale(struct metric_case *c, double complexity)
{
  double end = c->kind == METRIC_LINEAR ? 1 : sqrt(2), sum = 0, h[3];

  c->scale = 1;
  for (int i = 0; i < PANELS; i++) {
    double r = end * (i + 0.5) / PANELS;

    sizes(c, r, h);
    sum += section(c, r) / (h[0] * h[1] * h[2]) * end / PANELS;
  }
  c->scale = cbrt(sum / complexity);
}

static double place(const struct metric_case *c, const double x[3])
{
  return c->kind == METRIC_LINEAR ? x[2] : hypot(x[0], x[1]);
}

void metric_case_at(const struct metric_case *c, const double x[3], double m[6])
{
  double r = place(c, x), h[3], l[3], u, v;

  sizes(c, r, h);
  for (int k = 0; k < 3; k++) l[k] = 1 / (h[k] * h[k]);
  memset(m, 0, 6 * sizeof *m);
  if (c->kind == METRIC_LINEAR) {
    m[0] = l[1];
    m[3] = l[2];
    m[5] = l[0];
    return;
  }
  u = r > 0 ? x[0] / r : 1;
  v = r > 0 ? x[1] / r : 0;
  m[0] = l[0] * u * u + l[1] * v * v;
  m[1] = (l[0] - l[1]) * u * v;
  m[3] = l[0] * v * v + l[1] * u * u;
  m[5] = l[2];
}

void metric_case_sizes(const struct metric_case *c, const double x[3],
                       double *least, double *most)
{
  double h[3];

  sizes(c, place(c, x), h);
  *least = fmin(h[0], fmin(h[1], h[2]));
  *most = fmax(h[0], fmax(h[1], h[2]));
}

double metric_case_least(const struct metric_case *c, const double lo[3],
                         const double hi[3])
{
  double first[3], last[3], near, h[3];

  for (int k = 0; k < 3; k++) { /* nearest to and farthest from the axis */
    first[k] = lo[k] > 0 ? lo[k] : hi[k] < 0 ? -hi[k] : 0;
    last[k] = fmax(fabs(lo[k]), fabs(hi[k]));
  }
  near = fmin(fmax(LAYER, place(c, first)), place(c, last));
  sizes(c, near, h);
  if (c->kind != METRIC_POLAR2) return h[0];
  return fmin(h[0], c->scale / 40);
}

static void map_metric(void *user, const double x[3], double m[6])
{
  metric_case_at(user, x, m);
}

/* The geometric mean of the sizes. */
static double map_at(void *user, const double x[3])
{
  const struct metric_case *c = user;
  double h[3];

  sizes(c, place(c, x), h);
  return cbrt(h[0] * h[1] * h[2]);
}

static double map_least(void *user, const double lo[3], const double hi[3])
{
  return metric_case_least(user, lo, hi);
}

struct vg_size_map metric_case_map(struct metric_case *c)
{
  /* h_r is largest at the edge x = y = 1, h_t at r = 0 */
  const double far[3] = { 1, 1, 1 }, axis[3] = { 0, 0, 0 };
  double least, most, at_axis;

  metric_case_sizes(c, far, &least, &most);
  metric_case_sizes(c, axis, &least, &at_axis);
  return (struct vg_size_map){ .at = map_at,
                               .least = map_least,
                               .metric = map_metric,
                               .most = fmax(most, at_axis),
                               .user = c };
}
