/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Whether a flat cap looks like the root of half a body: like the section of a
 * wing or a fuselage, and not like the base of a heat sink, the end of a pipe
 * or the feet of a model. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/domain/planar.h"
#include "core/flow/half.h"
#include "core/geometry/vector.h"

/* F5 */
#define LEAN 0.05  /* skewness of a section with a front and a rear */
#define SHARE 0.03 /* of the body's projection: least area of a root */
#define SPAN 0.5   /* of the body: least width of a symmetric root */
#define DEEP 1.5   /* widths of a symmetric root: largest depth of the body */

struct outline {
  double area;
  double width, span; /* Its longer side; extent of the body along it. */
  int is_lopsided;    /* Front and rear differ along a coordinate axis. */
};

/* Integral of x^n over a triangle of unit area with the values v at its
 * corners; n is 1, 2 or 3. */
static double moment(const double v[3], int n)
{
  const double a = v[0], b = v[1], c = v[2];

  if (n == 1) return (a + b + c) / 3;
  if (n == 2) return (a * a + b * b + c * c + a * b + b * c + c * a) / 6;
  return ((a * a + b * b + c * c) * (a + b + c) + a * b * c) / 10;
}

/* Mean of (x - mid)^n over the cap along axis k. */
static double mean_power(const struct vg_mesh *m, const struct vg_flow_cap *cap,
                         int k, double mid, int n)
{
  double sum = 0, area = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *p = m->tri[t];
    const double *x[3] = { m->point[p[0]], m->point[p[1]], m->point[p[2]] };
    double v[3], a;

    if (!cap->tri[t]) continue;
    for (int i = 0; i < 3; i++) v[i] = x[i][k] - mid;
    a = vg_triangle_area(x[0], x[1], x[2]);
    sum += a * moment(v, n);
    area += a;
  }
  return area > 0 ? sum / area : 0;
}

/* Add one direction in the plane of the cap. */
static void measure(const struct vg_mesh *m, const struct vg_flow_cap *cap,
                    int k, struct outline *o)
{
  const double mid = mean_power(m, cap, k, 0, 1);
  const double two = mean_power(m, cap, k, mid, 2);
  const double three = mean_power(m, cap, k, mid, 3);
  double lo = INFINITY, hi = -INFINITY, all_lo[3], all_hi[3];

  o->is_lopsided |= three * three > LEAN * LEAN * two * two * two;
  for (size_t t = 0; t < m->n_tri; t++)
    for (int i = 0; i < 3 && cap->tri[t]; i++) {
      lo = fmin(lo, m->point[m->tri[t][i]][k]);
      hi = fmax(hi, m->point[m->tri[t][i]][k]);
    }
  if (hi - lo <= o->width) return;
  vg_mesh_bounds(m, all_lo, all_hi);
  o->width = hi - lo;
  o->span = all_hi[k] - all_lo[k];
}

/* Area of the cap, and of the body's projection on its plane. */
static void measure_areas(const struct vg_mesh *m,
                          const struct vg_flow_cap *cap, double *area,
                          double *projected)
{
  *area = *projected = 0;
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *p = m->tri[t];
    double a[3], b[3], n[3];

    vg_sub(m->point[p[1]], m->point[p[0]], a);
    vg_sub(m->point[p[2]], m->point[p[0]], b);
    vg_cross(a, b, n);
    *projected += fabs(n[cap->axis]) / 4;
    if (cap->tri[t]) *area += vg_norm(n) / 2;
  }
}

/* Number of connected parts of the cap. */
static vg_status count_parts(const struct vg_mesh *m,
                             const struct vg_flow_cap *cap, size_t *n,
                             struct vg_error *err)
{
  uint32_t *up = vg_alloc(m->n_point, sizeof *up);
  uint8_t *used = vg_calloc(m->n_point, 1);
  vg_status st = VG_OK;

  if (!up || !used) VG_TRY(vg_fail_memory(err, "the cap of a half model"));
  for (uint32_t i = 0; i < m->n_point; i++) up[i] = i;
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && cap->tri[t]; k++) {
      used[m->tri[t][k]] = 1;
      vg_union(up, m->tri[t][0], m->tri[t][k]);
    }
  *n = 0;
  for (uint32_t i = 0; i < m->n_point; i++) *n += used[i] && up[i] == i;
done:
  free(up);
  free(used);
  return st;
}

/* Has the cap no hole? Each part then has one rim. */
static vg_status is_full(const struct vg_mesh *m, const struct vg_mesh *open,
                         const struct vg_flow_cap *cap, int *full,
                         struct vg_error *err)
{
  struct vg_error why = VG_ERROR_INIT;
  struct vg_rim *rim = NULL;
  size_t n_rim = 0, n_part = 0;
  vg_status st;

  *full = 0;
  st = vg_domain_rims(open, &n_rim, &rim, &why);
  free(rim);
  if (st == VG_ERR_GEOMETRY) return VG_OK; /* rims meet */
  if (st < 0) return vg_fail(err, st, "%s", why.text);
  VG_TRY(count_parts(m, cap, &n_part, err));
  *full = n_rim == n_part;
done:
  return st;
}

vg_status vg_flow_looks_like_root(const struct vg_mesh *m,
                                  const struct vg_mesh *open,
                                  const struct vg_flow_cap *cap, int *is_root,
                                  struct vg_error *err)
{
  struct outline o = { 0 };
  double lo[3], hi[3], projected;

  measure_areas(m, cap, &o.area, &projected);
  for (int i = 1; i < 3; i++) measure(m, cap, (cap->axis + i) % 3, &o);
  vg_mesh_bounds(m, lo, hi);
  *is_root = o.area >= SHARE * projected &&
             (o.is_lopsided ||
              (o.width >= SPAN * o.span &&
               hi[cap->axis] - lo[cap->axis] <= DEEP * o.width));
  return *is_root ? is_full(m, open, cap, is_root, err) : VG_OK;
}
