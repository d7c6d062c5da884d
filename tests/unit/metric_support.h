/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Sizing fields with a metric that varies in space, for tests. Header only. */
#ifndef TESTS_UNIT_METRIC_SUPPORT_H
#define TESTS_UNIT_METRIC_SUPPORT_H

#include "core/geometry/tensor.h"
#include "core/sizing/sizing.h"

/* Axes along (1, 2, 2) / 3, (2, 1, -2) / 3 and (2, -2, 1) / 3. The sizes grow
 * with x, the first one five times as fast as the others. */
static inline void metric_oblique(void *scale, const double x[3], double m[6])
{
  static const double axis[3][3] = { { 1. / 3, 2. / 3, 2. / 3 },
                                     { 2. / 3, 1. / 3, -2. / 3 },
                                     { 2. / 3, -2. / 3, 1. / 3 } };
  double h = *(const double *)scale * (1 + 0.04 * x[0] * x[0]), value[3];

  value[0] = 1 / (25 * h * h);
  value[1] = value[2] = 1 / (h * h);
  vg_tensor_from_eigen(value, axis, m);
}

static inline double metric_oblique_size(void *scale, const double x[3])
{
  return *(const double *)scale * (1 + 0.04 * x[0] * x[0]);
}

static inline struct vg_sizing *metric_field(const struct vg_size_map *map,
                                             const struct vg_mesh *m)
{
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *sizing = NULL;
  struct vg_error err = VG_ERROR_INIT;

  options.from_surface = 0;
  options.h_max = 1e3;
  options.map = map;
  if (vg_sizing_new(&options, 0, NULL, m, &sizing, &err) < 0)
    fail_msg("%s", err.text);
  return sizing;
}

/* The field of metric_oblique; *scale must live as long as the field. */
static inline struct vg_sizing *metric_oblique_field(const struct vg_mesh *m,
                                                     double *scale)
{
  const struct vg_size_map map = { .at = metric_oblique_size,
                                   .metric = metric_oblique,
                                   .user = scale };

  return metric_field(&map, m);
}

struct field_digest {
  size_t n;
  uint64_t sum;
};

static inline void field_bytes(void *user, size_t n, const void *data)
{
  struct field_digest *d = user;
  const unsigned char *byte = data;

  for (size_t i = 0; i < n; i++) d->sum = (d->sum ^ byte[i]) * 1099511628211ull;
  d->n += n;
}

/* Number and digest of the bytes of a field. */
static inline struct field_digest field_digest(const struct vg_sizing *s)
{
  struct field_digest d = { 0, 0 };

  vg_sizing_show(s, field_bytes, &d);
  return d;
}

#endif
