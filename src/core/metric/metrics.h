/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/metric/metrics.h: metrics at the points of a tetrahedralisation, and
 * the quality of its cells and the lengths of its edges in them. */
#ifndef VG_CORE_METRIC_METRICS_H
#define VG_CORE_METRIC_METRICS_H

#include <stddef.h>
#include <stdint.h>

#include "core/delaunay/insert.h"
#include "core/geometry/shape.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/sizing/sizing.h"

/* Height of the apex over a face of the surface, that of a regular tetrahedron,
 * and least distance of a field point from other points. */
#define VG_METRIC_APEX 0.8165
#define VG_METRIC_EXCLUSION 0.7 /* K42 */

struct vg_metrics {
  const struct vg_sizing *sizing;
  struct vg_point_metric *at; /* [points] Metric of each point. */
  size_t cap;
};

/** The metric with stretch t. */
void vg_metric_of_stretch(const double t[6], struct vg_point_metric *out);

/** The metric at x. */
void vg_metric_at(const struct vg_sizing *sizing, const double x[3],
                  struct vg_point_metric *out);

/** Evaluate the metrics of points from..n-1 of t. Returns 0, or -1 if memory is
 * refused. */
int vg_metrics_add(struct vg_metrics *s, const struct vg_tets *t, size_t from,
                   size_t n);

/** Evaluate the metrics at the corners of all cells of t.
 *
 * @param out  owned by the caller, vg_metrics_free; NULL if sizes do not depend
 *             on the direction. Other points have no meaningful metric.
 *
 * VG_ERR_MEMORY. */
vg_status vg_metrics_of_corners(const struct vg_sizing *sizing,
                                const struct vg_tets *t,
                                struct vg_metrics **out);

/** NULL is accepted. */
void vg_metrics_free(struct vg_metrics *s);

/** Add the point x with metric m to the points of in->t, and insert it from
 * `cell`, which contains it (vg_insert). VG_BLOCKED, and nothing is added, if
 * it cannot be inserted; VG_ERR_MEMORY. */
vg_status vg_metrics_insert(struct vg_metrics *s, struct vg_inserter *in,
                            const double x[3], const struct vg_point_metric *m,
                            uint32_t cell, double clearance, double nearest,
                            struct vg_error *err);

/** Make room for the metrics of n points. Returns 0, or -1 if memory is
 * refused. */
int vg_metrics_reserve(struct vg_metrics *s, size_t n);

void vg_metrics_release(struct vg_metrics *s);

/** Cube of the mean ratio of the tetrahedron a b c d in metric m. The mean
 * ratio is 12 (3 V)^(2/3) / sum of the squared edge lengths, and 1 for the
 * regular tetrahedron; its cube needs no roots. 0 if the volume is not
 * positive, or if rounding determines its sign. */
static inline double vg_metric_shape(const struct vg_point_metric *m,
                                     const double a[3], const double b[3],
                                     const double c[3], const double d[3])
{
  double u[3], v[3], w[3], n[3], det, sum, volume, mu[3], mv[3], mw[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_sub(d, a, w);
  vg_cross(u, v, n);
  det = vg_dot(n, w);
  if (!(det > 0) ||
      det * det <= 1e-26 * vg_dot(u, u) * vg_dot(v, v) * vg_dot(w, w))
    return 0;
  vg_tensor_apply(m->m, u, mu);
  vg_tensor_apply(m->m, v, mv);
  vg_tensor_apply(m->m, w, mw);
  /* |v - u|^2 = u' M u + v' M v - 2 u' M v, and so on. */
  sum = 3 * (vg_dot(u, mu) + vg_dot(v, mv) + vg_dot(w, mw)) -
        2 * (vg_dot(u, mv) + vg_dot(v, mw) + vg_dot(w, mu));
  volume = 0.5 * det * m->root; /* 3 V */
  return 1728 * volume * volume / (sum * sum * sum);
}

/** Replace the normal n of a face, of twice its area, by the conormal
 * M^(-1) n, scaled so that its length in the metric, which is returned, is
 * twice the area of the face in the metric. */
double vg_metric_normal(const struct vg_point_metric *m, double n[3]);

/** The apex of a regular cell over the triangle x, y, z, in the metric at its
 * centre c. h out: the size tensor there; unit out: the apex is at c + h unit.
 * Returns 0 if the triangle is degenerate. */
int vg_metric_apex(const struct vg_sizing *sizing, const double x[3],
                   const double y[3], const double z[3], double c[3],
                   double h[6], double unit[3]);

/** The finest metric of four points: that of the largest determinant, and the
 * first of equal ones. Processors cannot predict these comparisons, so that
 * they select values instead of branching. */
static inline const struct vg_point_metric *vg_metrics_finest(
  const struct vg_metrics *s, const uint32_t v[4])
{
  const struct vg_point_metric *at = s->at;
  uint32_t p = at[v[1]].root > at[v[0]].root ? v[1] : v[0];
  uint32_t q = at[v[3]].root > at[v[2]].root ? v[3] : v[2];

  return &at[at[q].root > at[p].root ? q : p];
}

/** Shape of a cell in the finest metric of its corners. */
static inline double vg_metrics_shape(const struct vg_metrics *s,
                                      const struct vg_tets *t,
                                      const uint32_t v[4])
{
  return vg_metric_shape(vg_metrics_finest(s, v), t->x[v[0]], t->x[v[1]],
                         t->x[v[2]], t->x[v[3]]);
}

/** Shape of a cell: vg_metrics_shape, or vg_shape if s is NULL. */
static inline double vg_cell_shape(const struct vg_metrics *s,
                                   const struct vg_tets *t, const uint32_t v[4])
{
  return s ? vg_metrics_shape(s, t, v)
           : vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);
}

/** Length of the edge between two points. */
static inline double vg_metrics_length(const struct vg_metrics *s,
                                       const struct vg_tets *t, uint32_t a,
                                       uint32_t b)
{
  double e[3];

  vg_sub(t->x[b], t->x[a], e);
  return vg_metric_length(s->at[a].m, s->at[b].m, e);
}

#endif
