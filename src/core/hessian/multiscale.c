/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The metric of least interpolation error. */
#include "core/hessian/multiscale.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"

/* Least eigenvalue of a Hessian over the largest one of all points, so that
 * determinants are positive where the solution is linear. */
#define FLAT 1e-12

/* Second differences over a cell, relative to the largest value, that rounding
 * to 4-byte reals may cause: several units of 1.2e-7. */
#define NOISE 1e-6

/* The complexity is reached within CLOSE, after at most PASSES attempts. */
#define CLOSE 1e-3
enum { PASSES = 30, SWEEPS = 60 };

/* A metric that the growth would refine by less is left as it is: factor on the
 * square root of the determinant. */
#define UNCHANGED 1.002

/* x^(1 / n) for x > 0 and n from 1 to 64, by Newton's method from above. */
static double root_of(double x, int n)
{
  int e, q;
  double f = frexp(x, &e), y = 2;

  q = e >= 0 ? e / n : -((n - 1 - e) / n);
  f = ldexp(f, e - n * q); /* 0.5 to 2^n */
  for (int k = 0; k < 200; k++) {
    double power = 1, next;

    for (int i = 1; i < n; i++) power *= y;
    next = y - (y - f / power) / n;
    if (!(next < y)) break;
    y = next;
  }
  return ldexp(y, q);
}

static double largest_eigenvalue(const double h[6])
{
  double value[3], vector[3][3];

  vg_tensor_eigen(h, value, vector);
  return fmax(fabs(value[0]), fabs(value[2]));
}

static double complexity_of(const struct vg_estimate *e,
                            const double (*metric)[6])
{
  double sum = 0;

  for (size_t p = 0; p < e->m->n_point; p++)
    if (e->volume[p] > 0)
      sum += e->volume[p] * sqrt(fmax(vg_tensor_det(metric[p]), 0));
  return sum;
}

/* Factor on metrics that multiplies their complexity by x. */
static double factor_of(double x)
{
  return vg_cube_root(x * x);
}

static void scale(double a[6], double factor)
{
  for (int k = 0; k < 6; k++) a[k] *= factor;
}

/* det(|H|)^(-1 / (2 p + 3)) |H|, for eigenvalues relative to `most`. */
static void make_metric(const double hessian[6], double most, int norm,
                        double out[6])
{
  double value[3], vector[3][3], det = 1;

  vg_tensor_eigen(hessian, value, vector);
  for (int k = 0; k < 3; k++) {
    value[k] = fmax(fabs(value[k]) / most, FLAT);
    det *= value[k];
  }
  vg_tensor_from_eigen(value, (const double(*)[3])vector, out);
  if (norm != VG_NORM_MAX) scale(out, 1 / root_of(det, 2 * norm + 3));
}

/* Largest eigenvalue of the Hessians at the points of the estimate. *rise: the
 * largest difference from a linear function over the length of a cell, relative
 * to the largest value. */
static double largest_of(const struct vg_estimate *e, const double *value,
                         const double (*hessian)[6], double *rise)
{
  double most = 0, size = 0;

  *rise = 0;
  for (size_t p = 0; p < e->m->n_point; p++) {
    double own = largest_eigenvalue(hessian[p]), length;

    size = fmax(size, fabs(value[p]));
    if (!(own <= most)) most = own;
    if (!(e->volume[p] > 0)) continue;
    length = vg_cube_root(e->volume[p]);
    *rise = fmax(*rise, own * length * length);
  }
  *rise = size > 0 ? *rise / size : 0;
  return most;
}

vg_status vg_multiscale_add(const struct vg_estimate *e, const double *value,
                            const double (*hessian)[6], int norm, int is_first,
                            double (*metric)[6], struct vg_error *err)
{
  const size_t n = e->m->n_point;
  double rise, most = largest_of(e, value, hessian, &rise), factor;
  double(*own)[6];

  assert(norm >= 0 && norm <= 16 && metric);
  if (!isfinite(most))
    return vg_fail(err, VG_ERR_INPUT, "its second derivatives are not finite");
  if (!(rise > NOISE))
    return vg_fail(err, VG_ERR_INPUT,
                   "it is linear, but for %.1g of its largest value over the "
                   "length of a cell, which is the rounding of 4-byte reals; "
                   "omit it, or subtract its mean value if it has more digits",
                   rise);
  own = vg_alloc(n, sizeof *own);
  if (!own) return vg_fail_memory(err, "the metric of a solution");
  for (size_t p = 0; p < n; p++) make_metric(hessian[p], most, norm, own[p]);
  factor = factor_of(1 / complexity_of(e, (const double(*)[6])own));
  for (size_t p = 0; p < n; p++) {
    scale(own[p], factor);
    if (is_first) memcpy(metric[p], own[p], sizeof own[p]);
    else vg_metric_intersect(metric[p], own[p], metric[p]);
  }
  free(own);
  return VG_OK;
}

/* --- bounds and growth ---------------------------------------------------- */

struct bounds {
  double least, most; /* eigenvalues of the metric */
  double aspect2;     /* largest ratio of two eigenvalues */
};

static void bound(const struct bounds *b, double m[6])
{
  double value[3], vector[3][3];

  vg_tensor_eigen(m, value, vector);
  for (int k = 0; k < 3; k++)
    value[k] = fmin(fmax(value[k], b->least), b->most);
  for (int k = 0; k < 3; k++) value[k] = fmax(value[k], value[2] / b->aspect2);
  vg_tensor_from_eigen(value, (const double(*)[3])vector, m);
}

/* Is a at least as fine as b in all directions? Rounding may deny it. */
static int is_finer(const double a[6], const double b[6])
{
  double d[6];

  for (int k = 0; k < 6; k++) d[k] = a[k] - b[k];
  return d[0] > 0 && d[0] * d[3] > d[1] * d[1] && vg_tensor_det(d) > 0;
}

/* Refine the metric at one end of an edge so that it grows from the other end.
 * Returns 1 if it changes. */
static int grow(const double from[6], double to[6], const double edge[3],
                double log_growth)
{
  double way = 1 + log_growth * sqrt(fmax(vg_tensor_form(from, edge), 0));
  double grown[6], both[6];

  for (int k = 0; k < 6; k++) grown[k] = from[k] / (way * way);
  if (is_finer(to, grown)) return 0;
  vg_metric_intersect(to, grown, both);
  if (!(vg_tensor_det(both) > UNCHANGED * UNCHANGED * vg_tensor_det(to)))
    return 0;
  memcpy(to, both, sizeof both);
  return 1;
}

/* An edge is examined again only if the metric at one of its ends has changed
 * since the sweep before.
 *
 * changed: [n_point] out: the last sweep, from 1, in which a metric was
 * refined; 0: none */
static void limit_growth(const struct vg_estimate *e, double growth,
                         double (*metric)[6], uint8_t *changed)
{
  const double log_growth = (growth - 1) / vg_log_mean(growth, 1);
  size_t n = 1;

  memset(changed, 0, e->m->n_point);
  for (int sweep = 1; sweep <= SWEEPS && n; sweep++) {
    n = 0;
    for (size_t i = 0; i < e->n_edge; i++) {
      const uint32_t *p = e->edge[sweep % 2 ? i : e->n_edge - 1 - i];
      double edge[3];

      if (sweep > 1 && changed[p[0]] < sweep - 1 && changed[p[1]] < sweep - 1)
        continue;
      vg_sub(e->m->point[p[1]], e->m->point[p[0]], edge);
      for (int k = 0; k < 2; k++)
        if (grow(metric[p[k]], metric[p[!k]], edge, log_growth)) {
          changed[p[!k]] = (uint8_t)sweep;
          n++;
        }
    }
  }
}

/* --- scaling -------------------------------------------------------------- */

static void report(const struct vg_estimate *e,
                   const struct vg_multiscale_options *o,
                   const double (*metric)[6], const uint8_t *changed,
                   struct vg_multiscale_report *r)
{
  *r = (struct vg_multiscale_report){ .h_least = INFINITY };
  r->complexity = complexity_of(e, metric);
  for (size_t p = 0; p < e->m->n_point; p++) {
    double value[3], vector[3][3], least, most;

    if (!(e->volume[p] > 0)) continue;
    vg_tensor_eigen(metric[p], value, vector);
    least = 1 / sqrt(value[2]);
    most = 1 / sqrt(value[0]);
    r->h_least = fmin(r->h_least, least);
    r->h_most = fmax(r->h_most, most);
    r->aspect_most = fmax(r->aspect_most, most / least);
    r->n_min += least < o->h_min * (1 + 1e-6);
    r->n_aspect += most > least * o->aspect_max * (1 - 1e-6);
    r->n_grown += changed[p] > 0;
  }
}

static struct bounds bounds_of(const struct vg_mesh *m,
                               const struct vg_multiscale_options *o)
{
  double lo[3], hi[3], size[3], most;

  vg_mesh_bounds(m, lo, hi);
  vg_sub(hi, lo, size);
  most = fmin(o->h_max, vg_norm(size));
  return (struct bounds){ 1 / (most * most),
                          o->h_min > 0 ? 1 / (o->h_min * o->h_min) : INFINITY,
                          o->aspect_max * o->aspect_max };
}

vg_status vg_multiscale_scale(const struct vg_estimate *e,
                              const struct vg_multiscale_options *o,
                              double (*metric)[6],
                              struct vg_multiscale_report *r,
                              struct vg_error *err)
{
  const size_t n = e->m->n_point;
  const struct bounds b = bounds_of(e->m, o);
  double(*raw)[6] = vg_alloc(n, sizeof *raw);
  uint8_t *changed = vg_alloc(n, 1);
  double factor, reached = 0, before;
  vg_status st = VG_OK;

  assert(o->complexity > 0 && o->growth > 1 && o->aspect_max >= 1);
  if (!raw || !changed) {
    st = vg_fail_memory(err, "the metric of a solution");
    goto done;
  }
  memcpy(raw, metric, n * sizeof *raw);
  factor = factor_of(o->complexity /
                     complexity_of(e, (const double(*)[6])metric));
  for (int pass = 0; pass < PASSES; pass++) {
    for (size_t p = 0; p < n; p++) {
      memcpy(metric[p], raw[p], sizeof raw[p]);
      scale(metric[p], factor);
      bound(&b, metric[p]);
    }
    limit_growth(e, o->growth, metric, changed);
    for (size_t p = 0; p < n; p++) bound(&b, metric[p]);
    before = reached;
    reached = complexity_of(e, (const double(*)[6])metric);
    if (fabs(reached - o->complexity) <= CLOSE * o->complexity) break;
    if (fabs(reached - before) <= 1e-9 * reached) break; /* only bounds act */
    factor *= factor_of(o->complexity / reached);
  }
  report(e, o, (const double(*)[6])metric, changed, r);
done:
  free(raw);
  free(changed);
  return st;
}
