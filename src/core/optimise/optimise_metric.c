/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Smoothing in a metric: a point moves by a step of Newton's method towards the
 * minimum of
 *
 *     f = sum over its cells of 1 / Q + w (S / 6 - 1)^2,
 *
 * with the cube Q of the mean ratio and the sum S of the squared edge lengths,
 * which is 6 for a regular cell of the right size. Both are measured in the
 * finest metric of the corners. The derivatives treat the metrics as constant;
 * each position that is tried has its own metric.
 *
 * With the metric A, the vector r from the centroid of the opposite face to the
 * point, and the normal n of that face, grad S = 6 A r and grad V = n, so that
 * with u = grad S / S and v = grad V / V
 *
 *     grad 1/Q = (3 u - 2 v) / Q
 *     hess 1/Q = (6 (u - v) (u - v)^T + 18 A / S) / Q
 *
 * which is positive definite. The term of the size is made so: the part of its
 * second derivative that is negative for S < 6 is left out. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/wide.h"
#include "core/geometry/vector.h"
#include "core/optimise/optimise_parts.h"

/* K44: weight w of the size; longest step, in units of the metric; parts of the
 * step that are tried; least relative decrease of f. */
static const double size_weight = 0.5, longest = 0.5, gain = 1e-3;
static const double share[] = { 1, 0.4, 0.15 };
enum { SHARES = 3 };
/* Positions may not make a cell worse than this, or than the worst one. */
static const double least_shape = 0.125;

/* Cells are processed BLOCK at a time, in loops that compilers vectorise. */
enum { BLOCK = 8, BLOCKS = VG_BALL_MAX / BLOCK };

/* Cells of the ball. Each one is represented by the face opposite the point,
 * with the point on its positive side. Positions are relative to the point
 * before it moves. The last block is filled up with copies of the last cell. */
struct block {
  double live[BLOCK]; /* 1, or 0 for a copy */
  double m[6][BLOCK]; /* finest metric of the corners of the face */
  double root[BLOCK]; /* root of its determinant */
  double x[3][BLOCK]; /* a corner of the face */
  double e[3][BLOCK], f[3][BLOCK]; /* vectors from it to the other corners */
  double normal[3][BLOCK];         /* e x f */
  double mid[3][BLOCK];            /* centroid of the face */
  double gram[6][BLOCK];           /* 4 / 3 of the sum of the products of its
                                      edges with themselves, so that its product
                                      with a metric is 4 / 3 of the sum of their
                                      squared lengths */
  double flat[BLOCK];              /* squared volumes below this factor times a
                                      squared length are rounding */
  double far[BLOCK];               /* squared distance of the farthest corner */
};

struct stretched_ball {
  size_t n, n_block;
  struct block at[BLOCKS];
};

/* f at a position, or INFINITY. */
struct rating {
  double f;
  double worst; /* largest 1 / Q */
  double g[3];  /* gradient of f */
  double s[6];  /* second derivative of f, positive definite */
};

static void gather_cell(const struct vg_tets *t,
                        const struct vg_metrics *metrics, const double from[3],
                        uint32_t link, struct block *b, size_t k)
{
  const uint32_t *v = t->cell[link >> 2].v;
  const uint8_t *f = vg_face[link & 3];
  uint32_t p = v[f[0]], q = v[f[1]], r = v[f[2]];
  const double *x = t->x[p], *y = t->x[q], *z = t->x[r];
  const struct vg_point_metric *at = metrics->at, *m;

  /* As vg_metrics_finest. */
  p = at[q].root > at[p].root ? q : p;
  m = &at[at[r].root > at[p].root ? r : p];
  for (int i = 0; i < 6; i++) b->m[i][k] = m->m[i];
  b->root[k] = m->root;
  for (int i = 0; i < 3; i++) {
    b->x[i][k] = x[i] - from[i];
    b->e[i][k] = y[i] - x[i];
    b->f[i][k] = z[i] - x[i];
  }
}

static void gather(const struct vg_tets *t, const struct vg_metrics *metrics,
                   const double from[3], size_t n, const uint32_t *link,
                   struct stretched_ball *b)
{
  assert(n > 0 && n <= VG_BALL_MAX);
  b->n = n;
  b->n_block = (n + BLOCK - 1) / BLOCK;
  for (size_t k = 0; k < b->n_block * BLOCK; k++) {
    struct block *to = &b->at[k / BLOCK];

    to->live[k % BLOCK] = k < n;
    gather_cell(t, metrics, from, link[k < n ? k : n - 1], to, k % BLOCK);
  }
}

VG_WITHIN double larger(double a, double b)
{
  return a > b ? a : b;
}

/* Rows and columns of the components of a tensor. */
static const int row[6] = { 0, 0, 0, 1, 1, 2 }, col[6] = { 0, 1, 2, 1, 2, 2 };

/* Quantities of a block that do not depend on the position of the point. */
VG_WITHIN void measure(struct block *b)
{
  for (int k = 0; k < BLOCK; k++) {
    double e2 = 0, f2 = 0, x2 = 0, y2 = 0, z2 = 0;

    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, l = (i + 2) % 3;
      double y = b->x[i][k] + b->e[i][k], z = b->x[i][k] + b->f[i][k];

      b->normal[i][k] = b->e[j][k] * b->f[l][k] - b->e[l][k] * b->f[j][k];
      b->mid[i][k] = b->x[i][k] + (b->e[i][k] + b->f[i][k]) * (1.0 / 3);
      e2 += b->e[i][k] * b->e[i][k];
      f2 += b->f[i][k] * b->f[i][k];
      x2 += b->x[i][k] * b->x[i][k];
      y2 += y * y;
      z2 += z * z;
    }
    b->flat[k] = 1e-26 * e2 * f2;
    b->far[k] = larger(larger(x2, y2), z2);
    for (int i = 0; i < 6; i++) {
      double e = b->e[row[i]][k], f = b->f[row[i]][k];
      double ee = b->e[col[i]][k], ff = b->f[col[i]][k];
      double sum = e * ee + f * ff + (f - e) * (ff - ee);

      b->gram[i][k] = (row[i] == col[i] ? 4.0 / 3 : 8.0 / 3) * sum;
    }
  }
}

/* The terms of a block with the point at `to`, with metric m, are added to
 * those in f[BLOCK] and, unless it is NULL, in g: the first three rows are the
 * gradient, the other six the second derivative. inverse out: [BLOCK] 1 / Q,
 * INFINITY for a cell that is not positive. With the sum S of the squared edges
 * and V = 3 times the volume, 1 / Q = S^3 / (1728 V^2). */
VG_WITHIN void rate(const struct block *b, const double to[3],
                    const struct vg_point_metric *m, double *inverse, double *f,
                    double (*g)[BLOCK])
{
  /* Loops with conditional loads are not vectorised: own is a copy. */
  const struct vg_point_metric own = *m;

  for (int k = 0; k < BLOCK; k++) {
    double a[6], r[3], ar[3], root = b->root[k];
    double sum, det, sound, high, off, square;

    for (int i = 0; i < 6; i++) {
      double other = b->m[i][k];

      a[i] = own.root > root ? own.m[i] : other;
    }
    root = larger(own.root, root);
    for (int i = 0; i < 3; i++) r[i] = to[i] - b->mid[i][k];
    ar[0] = a[0] * r[0] + a[1] * r[1] + a[2] * r[2];
    ar[1] = a[1] * r[0] + a[3] * r[1] + a[4] * r[2];
    ar[2] = a[2] * r[0] + a[4] * r[1] + a[5] * r[2];
    det = b->normal[0][k] * r[0] + b->normal[1][k] * r[1] +
          b->normal[2][k] * r[2];
    sum = 3 * (r[0] * ar[0] + r[1] * ar[1] + r[2] * ar[2]);
    for (int i = 0; i < 6; i++) sum += b->gram[i][k] * a[i];
    square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + b->far[k];
    /* 0 if rounding determines the volume: 1 / Q is infinite then. */
    sound = det * det > b->flat[k] * square ? det : 0;
    high = larger(sound, 0) * root;
    inverse[k] = sum * sum * sum / (432 * high * high);
    off = sum * (1.0 / 6) - 1;
    f[k] += b->live[k] * (inverse[k] + size_weight * off * off);
    if (g) {
      double wide = 18 * inverse[k] / sum, size = 2 * size_weight;
      double steep = 1 / det, curved = wide + size * larger(off, 0), way[3];

      for (int i = 0; i < 3; i++) {
        way[i] = ar[i] * (6 / sum) - steep * b->normal[i][k];
        g[i][k] += b->live[k] * ((wide + size * off) * ar[i] -
                                 2 * inverse[k] * steep * b->normal[i][k]);
      }
      for (int i = 0; i < 6; i++)
        g[3 + i][k] += b->live[k] *
                       (curved * a[i] +
                        6 * inverse[k] * way[row[i]] * way[col[i]] +
                        size * ar[row[i]] * ar[col[i]]);
    }
  }
}

VG_WITHIN double total(const double *part)
{
  double sum = 0;

  for (int k = 0; k < BLOCK; k++) sum += part[k];
  return sum;
}

/* f at the present position of the point, where it has metric m. */
VG_WITHIN void start(struct stretched_ball *b, const struct vg_point_metric *m,
                     struct rating *out)
{
  static const double origin[3] = { 0 };
  double f[BLOCK] = { 0 }, g[9][BLOCK] = { { 0 } }, inverse[BLOCK];

  out->worst = 0;
  for (size_t i = 0; i < b->n_block; i++) {
    measure(&b->at[i]);
    rate(&b->at[i], origin, m, inverse, f, g);
    for (int k = 0; k < BLOCK; k++) out->worst = larger(out->worst, inverse[k]);
  }
  out->f = out->worst < INFINITY ? total(f) : INFINITY;
  for (int i = 0; i < 3; i++) out->g[i] = total(g[i]);
  for (int i = 0; i < 6; i++) out->s[i] = total(g[3 + i]);
}

/* f with the point at `to`, with metric m. inverse out: [BLOCK * BLOCKS] 1 / Q.
 * INFINITY as soon as one is not below `most`. */
VG_WITHIN double value(const struct stretched_ball *b, const double to[3],
                       const struct vg_point_metric *m, double most,
                       double *inverse)
{
  double f[BLOCK] = { 0 }, worst = 0;

  for (size_t i = 0; i < b->n_block; i++) {
    rate(&b->at[i], to, m, inverse + i * BLOCK, f, NULL);
    for (int k = 0; k < BLOCK; k++)
      worst = larger(worst, inverse[i * BLOCK + (size_t)k]);
    if (!(worst < most)) return INFINITY;
  }
  return total(f);
}

#ifdef VG_WIDE
static VG_WIDE void start_wide(struct stretched_ball *b,
                               const struct vg_point_metric *m,
                               struct rating *out)
{
  start(b, m, out);
}

static VG_WIDE double value_wide(const struct stretched_ball *b,
                                 const double to[3],
                                 const struct vg_point_metric *m, double most,
                                 double *inverse)
{
  return value(b, to, m, most, inverse);
}
#endif

static void rate_start(struct stretched_ball *b,
                       const struct vg_point_metric *m, struct rating *out)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) {
    start_wide(b, m, out);
    return;
  }
#endif
  start(b, m, out);
}

static double value_at(const struct stretched_ball *b, const double to[3],
                       const struct vg_point_metric *m, double most,
                       double *inverse)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) return value_wide(b, to, m, most, inverse);
#endif
  return value(b, to, m, most, inverse);
}

/* Step of Newton's method from a point with metric m, of limited length.
 * Returns 0 if the gradient vanishes. */
static int find_step(const struct rating *now, const struct vg_point_metric *m,
                     double d[3])
{
  double inverse[6], length;

  vg_tensor_invert(now->s, inverse);
  vg_tensor_apply(inverse, now->g, d);
  length = sqrt(vg_tensor_form(m->m, d));
  if (!(length > 0 && length < INFINITY)) return 0;
  for (int i = 0; i < 3 && length > longest; i++) d[i] *= longest / length;
  return 1;
}

double vg_move_in_metric(struct vg_tets *t, struct vg_metrics *metrics,
                         uint32_t p, size_t n, const uint32_t *link, double *q)
{
  struct stretched_ball b;
  struct vg_point_metric m = metrics->at[p];
  struct rating now;
  double x[3], d[3], to[3], most, f;

  gather(t, metrics, t->x[p], n, link, &b);
  rate_start(&b, &m, &now);
  if (!(now.f < INFINITY) || !find_step(&now, &m, d)) return 0;
  most = fmax(now.worst / 0.999, 1 / least_shape);
  for (int k = 0; k < SHARES; k++) {
    for (int i = 0; i < 3; i++) {
      x[i] = t->x[p][i] - share[k] * d[i];
      to[i] = x[i] - t->x[p][i];
    }
    vg_metric_at(metrics->sizing, x, &m);
    f = value_at(&b, to, &m, most, q);
    if (!(f < (1 - gain) * now.f)) continue;
    for (size_t c = 0; c < n; c++) q[c] = 1 / q[c];
    memcpy(t->x[p], x, sizeof x);
    metrics->at[p] = m;
    return 1 - f / now.f;
  }
  return 0;
}

int vg_smooth_metric(struct vg_optimiser *o, uint32_t p)
{
  double q[VG_BALL_MAX];

  if (!(vg_move_in_metric(o->t, o->metrics, p, o->n_ball, o->ball, q) > 0))
    return 0;
  for (size_t k = 0; k < o->n_ball; k++) {
    o->q[o->ball[k] >> 2] = (float)q[k];
    vg_changed(o, o->ball[k] >> 2);
  }
  o->report->n_smoothed++;
  return 1;
}
