/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smoothing in a metric: a point moves against the gradient of
 *
 *     f = sum over its cells of 1 / Q + w (S / 6 - 1)^2,
 *
 * with the cube Q of the mean ratio and the sum S of the squared edge lengths,
 * which is 6 for a regular cell of the right size. Both are measured in the
 * finest metric of the corners. The gradient treats the metrics as constant;
 * each position that is tried has its own metric. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "core/optimise/optimise_parts.h"

/* K44: weight w of the size; steps in units of the metric; least relative
 * decrease of f. */
static const double size_weight = 0.5, gain = 1e-3;
static const double step[] = { 0.25, 0.1, 0.04 };
enum { STEPS = 3 };
/* Positions may not make a cell worse than this, or than the worst one. */
static const double least_shape = 0.125;

struct stretched_ball {
  size_t n;
  const double *x[VG_BALL_MAX][3]; /* Corners of the face opposite the point,
                                      with the point on the positive side. */
  const struct vg_point_metric *finest[VG_BALL_MAX]; /* Of these corners. */
};

static void gather(const struct vg_tets *t, const struct vg_metrics *metrics,
                   size_t n, const uint32_t *link, struct stretched_ball *b)
{
  assert(n > 0 && n <= VG_BALL_MAX);
  b->n = n;
  for (size_t k = 0; k < n; k++) {
    const uint32_t *v = t->cell[link[k] >> 2].v;
    const uint8_t *f = vg_face[link[k] & 3];

    b->finest[k] = &metrics->at[v[f[0]]];
    for (int i = 0; i < 3; i++) {
      const struct vg_point_metric *m = &metrics->at[v[f[i]]];

      b->x[k][i] = t->x[v[f[i]]];
      if (m->root > b->finest[k]->root) b->finest[k] = m;
    }
  }
}

/* f with the point at x and its metric m. q out: shapes. INFINITY as soon as a
 * shape is not above `stop`. */
static double value(const struct stretched_ball *b, const double x[3],
                    const struct vg_point_metric *m, double stop, double *q)
{
  double f = 0;

  for (size_t k = 0; k < b->n; k++) {
    const struct vg_point_metric *of = m->root > b->finest[k]->root
                                       ? m
                                       : b->finest[k];
    double sum, off;

    q[k] = vg_metric_shape_sum(of, b->x[k][0], b->x[k][1], b->x[k][2], x, &sum);
    if (!(q[k] > stop)) return INFINITY;
    off = sum / 6 - 1;
    f += 1 / q[k] + size_weight * off * off;
  }
  return f;
}

/* Gradient of f. S = sum of the squared edges, V = 3 times the volume:
 * 1 / Q = S^3 / (1728 V^2). */
static void slope(const struct stretched_ball *b, const double x[3],
                  const struct vg_point_metric *m, double g[3])
{
  memset(g, 0, 3 * sizeof *g);
  for (size_t k = 0; k < b->n; k++) {
    const struct vg_point_metric *of = m->root > b->finest[k]->root
                                       ? m
                                       : b->finest[k];
    double sum, inverse, e[3], f[3], n[3], s[3], ms[3], det, high, wide;

    inverse = 1 / vg_metric_shape_sum(of, b->x[k][0], b->x[k][1], b->x[k][2], x,
                                      &sum);
    vg_sub(b->x[k][1], b->x[k][0], e);
    vg_sub(b->x[k][2], b->x[k][0], f);
    vg_cross(e, f, n);
    vg_sub(x, b->x[k][0], s);
    det = vg_dot(n, s);
    for (int i = 0; i < 3; i++)
      s[i] = 3 * x[i] - b->x[k][0][i] - b->x[k][1][i] - b->x[k][2][i];
    vg_tensor_apply(of->m, s, ms); /* half the gradient of S */
    wide = 6 * inverse / sum + size_weight * (sum / 6 - 1) * (2.0 / 3);
    high = 2 * inverse / det;
    for (int i = 0; i < 3; i++) g[i] += wide * ms[i] - high * n[i];
  }
}

int vg_move_in_metric(struct vg_tets *t, struct vg_metrics *metrics, uint32_t p,
                      size_t n, const uint32_t *link, double *q)
{
  struct stretched_ball b;
  struct vg_point_metric m = metrics->at[p];
  double x[3], g[3], d[3], inverse[6], f, length, least = 1;

  gather(t, metrics, n, link, &b);
  f = value(&b, t->x[p], &m, 0, q);
  if (!(f < INFINITY)) return 0;
  for (size_t k = 0; k < n; k++) least = fmin(least, q[k]);
  least = fmin(0.999 * least, least_shape);
  slope(&b, t->x[p], &m, g);
  vg_tensor_invert(m.m, inverse);
  vg_tensor_apply(inverse, g, d);
  length = sqrt(fmax(vg_dot(g, d), 0));
  if (!(length > 0)) return 0;
  for (int k = 0; k < STEPS; k++) {
    for (int i = 0; i < 3; i++) x[i] = t->x[p][i] - step[k] / length * d[i];
    vg_metric_at(metrics->sizing, x, &m);
    if (!(value(&b, x, &m, least, q) < (1 - gain) * f)) continue;
    memcpy(t->x[p], x, sizeof x);
    metrics->at[p] = m;
    return 1;
  }
  return 0;
}

int vg_smooth_metric(struct vg_optimiser *o, uint32_t p)
{
  double q[VG_BALL_MAX];

  if (!vg_move_in_metric(o->t, o->metrics, p, o->n_ball, o->ball, q)) return 0;
  for (size_t k = 0; k < o->n_ball; k++) {
    o->q[o->ball[k] >> 2] = (float)q[k];
    vg_changed(o, o->ball[k] >> 2);
  }
  o->report->n_smoothed++;
  return 1;
}
