/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Metrics of a file: order of their components, and checks. */
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/geometry/tensor.h"
#include "core/sizing/sizing_map.h"
#include "core/sizing/sizing_mesh.h"

/* Relative difference up to which two components of a full tensor count as
 * equal: files with seven digits. */
#define SYMMETRIC 1e-5

static const char *const names[] = { "file", "medit", "upper", "vtk" };
static const char *const lists[] = { "", "xx, xy, yy, xz, yz, zz",
                                     "xx, xy, xz, yy, yz, zz",
                                     "xx, yy, zz, xy, yz, xz" };

static void convert(int components, enum vg_tensor_order order, const double *v,
                    double m[6])
{
  static const int at[][6] = { { 0, 1, 2, 3, 4, 5 },
                               { 0, 1, 3, 2, 4, 5 },
                               { 0, 1, 2, 3, 4, 5 },
                               { 0, 3, 5, 1, 4, 2 } };
  static const int full[6] = { 0, 1, 2, 4, 5, 8 };
  const int *from = components == 9 ? full : at[order];

  for (int k = 0; k < 6; k++) m[k] = v[from[k]];
}

static int is_symmetric(const double v[9])
{
  double most = fmax(fabs(v[0]), fmax(fabs(v[4]), fabs(v[8])));

  return fabs(v[1] - v[3]) <= SYMMETRIC * most &&
         fabs(v[2] - v[6]) <= SYMMETRIC * most &&
         fabs(v[5] - v[7]) <= SYMMETRIC * most;
}

static int is_finite(const double *v, int n)
{
  for (int k = 0; k < n; k++)
    if (!isfinite(v[k])) return 0;
  return 1;
}

static int is_positive(const double m[6])
{
  double value[3], vector[3][3];

  if (!is_finite(m, 6) || !(m[0] > 0 && m[3] > 0 && m[5] > 0)) return 0;
  vg_tensor_eigen(m, value, vector);
  return value[0] > 0 && isfinite(1 / sqrt(value[0])) && isfinite(value[2]);
}

/* Sizes from 1e-40 to 1e40, whose products are numbers, too. */
static int is_in_range(const double m[6])
{
  double value[3], vector[3][3];

  vg_tensor_eigen(m, value, vector);
  return value[0] >= 1e-80 && value[2] <= 1e80;
}

/* Another order in which all metrics are positive, or the given one. */
static enum vg_tensor_order other_order(size_t n, const double *value,
                                        enum vg_tensor_order order)
{
  for (int o = VG_TENSOR_MEDIT; o <= VG_TENSOR_VTK; o++) {
    size_t i = 0;
    double m[6];

    for (; o != (int)order && i < n; i++) {
      convert(6, (enum vg_tensor_order)o, value + 6 * i, m);
      if (!is_positive(m)) break;
    }
    if (i == n) return (enum vg_tensor_order)o;
  }
  return order;
}

static vg_status refuse(const char *name, size_t i, const double x[3],
                        const double m[6], const char *what,
                        struct vg_error *err)
{
  return vg_fail(err, VG_ERR_INPUT,
                 "%s: the metric at point %zu, (%.9g, %.9g, %.9g), is not "
                 "%s: xx %g, xy %g, xz %g, yy %g, yz %g, zz %g",
                 name, i + 1, x[0], x[1], x[2], what, m[0], m[1], m[2], m[3],
                 m[4], m[5]);
}

static vg_status check_metric(const char *name, size_t n, size_t i,
                              const double x[3], int components,
                              enum vg_tensor_order order, const double *value,
                              const double m[6], struct vg_error *err)
{
  const double *v = value + i * (size_t)components;
  enum vg_tensor_order other;
  char what[240];

  if (!is_finite(v, components))
    return refuse(name, i, x, m,
                  "finite; write the metric of the largest edge length there "
                  "instead",
                  err);
  if (components == 9 && !is_symmetric(v)) {
    snprintf(what, sizeof what,
             "symmetric; by rows it is %g %g %g, %g %g %g, %g %g %g; its upper "
             "half",
             v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]);
    return refuse(name, i, x, m, what, err);
  }
  if (is_positive(m) && is_in_range(m)) return VG_OK;
  if (is_positive(m))
    return refuse(name, i, x, m,
                  "within 1e-80 and 1e80 (sizes from 1e-40 to 1e40); use "
                  "another unit of length",
                  err);
  other = components == 6 ? other_order(n, value, order) : order;
  if (other == order)
    return refuse(name, i, x, m,
                  "positive; its eigenvalues must be 1 / length^2, above 0",
                  err);
  snprintf(what, sizeof what,
           "positive if its components are %s; in the order %s, all metrics "
           "are: reorder them or, in the deck, set metric_order to %s",
           lists[order], lists[other], names[other]);
  return refuse(name, i, x, m, what, err);
}

size_t vg_size_metrics_beyond(size_t n, const double (*metric)[6],
                              double aspect_max)
{
  size_t beyond = 0;

  for (size_t i = 0; i < n; i++) {
    double value[3], vector[3][3];

    vg_tensor_eigen(metric[i], value, vector);
    beyond += value[2] > value[0] * aspect_max * aspect_max * (1 + 1e-9);
  }
  return beyond;
}

vg_status vg_size_metrics_read(const char *name, size_t n, const double (*x)[3],
                               int components, enum vg_tensor_order order,
                               const double *value, double (*out)[6],
                               struct vg_error *err)
{
  assert(components == 6 || components == 9);
  assert(order != VG_TENSOR_FILE);
  for (size_t i = 0; i < n; i++) {
    double m[6];
    vg_status st = vg_size_place_check(name, i, x[i], err);

    if (st < 0) return st;
    convert(components, order, value + i * (size_t)components, m);
    st = check_metric(name, n, i, x[i], components, order, value, m, err);
    if (st < 0) return st;
    memcpy(out[i], m, sizeof m);
  }
  return VG_OK;
}
