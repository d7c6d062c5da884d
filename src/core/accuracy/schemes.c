/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Discretisation schemes on control volumes. */
#include "core/accuracy/schemes.h"

#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"

/* Least ratio of the diagonal elements of a triangular factor. */
#define DEFICIENT 1e-12

/* Limit of over-relaxation, as in OpenFOAM. */
#define LEAST_COSINE 0.05

/* A face as seen from one of its volumes. */
struct seen {
  double to[3], difference; /* from the unknown: position and value */
  double area[3];           /* out of the volume */
  double face;              /* value on the face less that of the unknown */
  double weight;            /* of the other volume */
  size_t other;             /* other volume; SIZE_MAX: on the boundary */
  int is_row;               /* 1: an equation of least squares */
};

/* Value on the part of a boundary face that belongs to a point. With these
 * weights the gradients on tetrahedra and on boxes are exact for linear
 * functions at the boundary, too. */
static double corner_value(const struct vg_values *f, const uint32_t node[4])
{
  const double *v = f->at;

  if (node[3] != VG_NO_CELL) return v[node[0]];
  return (6 * v[node[0]] + v[node[1]] + v[node[2]]) / 8;
}

static void see_border(const struct vg_values *f, size_t i, size_t b,
                       struct seen *out)
{
  const struct vg_volumes *v = f->v;

  out->other = SIZE_MAX;
  out->weight = 1;
  memcpy(out->area, v->out[b], sizeof out->area);
  out->is_row = v->in == VG_IN_CELLS;
  if (out->is_row) {
    vg_sub(v->at[b], v->x[i], out->to);
    out->difference = out->face = f->border[b] - f->at[i];
  } else {
    out->face = corner_value(f, v->corner[b]) - f->at[i];
  }
}

static void see(const struct vg_values *f, size_t i, uint32_t entry,
                struct seen *out)
{
  const struct vg_volumes *v = f->v;
  size_t face = entry / 2;
  int k = entry % 2;

  if (entry >= 2 * v->n_face) {
    see_border(f, i, entry - 2 * v->n_face, out);
    return;
  }
  out->other = v->side[face][!k];
  out->weight = k ? 1 - v->weight[face] : v->weight[face];
  vg_sub(v->x[out->other], v->x[i], out->to);
  out->difference = f->at[out->other] - f->at[i];
  out->face = out->weight * out->difference;
  for (int c = 0; c < 3; c++)
    out->area[c] = k ? -v->area[face][c] : v->area[face][c];
  out->is_row = 1;
}

/* --- least squares -------------------------------------------------------- */

/* Triangular factor of the rows so far, and right-hand side. */
struct factor {
  double r[3][3], y[3];
};

/* Add a row by Givens rotations, which keep their accuracy on cells of a high
 * aspect ratio, unlike normal equations. */
static void add_row(struct factor *q, const double to[3], double difference,
                    double weight)
{
  double a[3], b = weight * difference;

  for (int k = 0; k < 3; k++) a[k] = weight * to[k];
  for (int k = 0; k < 3; k++) {
    double h = sqrt(q->r[k][k] * q->r[k][k] + a[k] * a[k]), c, s, t;

    if (!(fabs(a[k]) > 0) || !(h > 0)) continue;
    c = q->r[k][k] / h;
    s = a[k] / h;
    for (int j = k; j < 3; j++) {
      t = c * q->r[k][j] + s * a[j];
      a[j] = c * a[j] - s * q->r[k][j];
      q->r[k][j] = t;
    }
    t = c * q->y[k] + s * b;
    b = c * b - s * q->y[k];
    q->y[k] = t;
  }
}

/* Returns 1 if the rows do not determine all components. */
static int solve(const struct factor *q, double x[3])
{
  double most = fmax(q->r[0][0], fmax(q->r[1][1], q->r[2][2]));
  int is_deficient = 0;

  for (int k = 2; k >= 0; k--) {
    x[k] = q->y[k];
    for (int j = k + 1; j < 3; j++) x[k] -= q->r[k][j] * x[j];
    if (q->r[k][k] > DEFICIENT * most) {
      x[k] /= q->r[k][k];
    } else {
      x[k] = 0;
      is_deficient = 1;
    }
  }
  return is_deficient;
}

int vg_scheme_gradients(const struct vg_values *f, size_t i,
                        double gradient[VG_SCHEME_VISCOUS][3])
{
  const struct vg_volumes *v = f->v;
  struct factor q[2] = { { .y = { 0 } } };
  double *gauss = gradient[VG_SCHEME_GAUSS];
  int is_deficient;

  memset(gauss, 0, 3 * sizeof *gauss);
  for (size_t e = v->first[i]; e < v->first[i + 1]; e++) {
    struct seen s;
    double far;

    see(f, i, v->entry[e], &s);
    for (int k = 0; k < 3; k++) gauss[k] += s.face * s.area[k] / v->volume[i];
    if (!s.is_row) continue;
    far = vg_norm(s.to);
    add_row(&q[0], s.to, s.difference, 1);
    if (far > 0) add_row(&q[1], s.to, s.difference, 1 / far);
  }
  is_deficient = solve(&q[0], gradient[VG_SCHEME_LSQ]);
  return solve(&q[1], gradient[VG_SCHEME_WLSQ]) || is_deficient;
}

/* --- viscous operator ----------------------------------------------------- */

/* Flux of the gradient through a common face: the mean gradient, whose
 * component along the line between both unknowns is replaced by the difference
 * of their values. */
static double flux_of(const struct vg_values *f, size_t i, const struct seen *s,
                      const double (*gradient)[3])
{
  double mean[3], along = vg_dot(s->area, s->to), length2, area2;

  for (int k = 0; k < 3; k++)
    mean[k] = (1 - s->weight) * gradient[i][k] +
              s->weight * gradient[s->other][k];
  length2 = vg_dot(s->to, s->to);
  area2 = vg_dot(s->area, s->area);
  if (f->v->in == VG_IN_NODES) along /= length2;
  else along = area2 / fmax(along, LEAST_COSINE * sqrt(area2 * length2));
  return vg_dot(s->area, mean) + along * (s->difference - vg_dot(mean, s->to));
}

int vg_scheme_laplacian(const struct vg_values *f, size_t i,
                        const double (*gradient)[3], double *out)
{
  const struct vg_volumes *v = f->v;
  double sum = 0;

  for (size_t e = v->first[i]; e < v->first[i + 1]; e++) {
    struct seen s;

    see(f, i, v->entry[e], &s);
    if (s.other != SIZE_MAX) {
      sum += flux_of(f, i, &s, gradient);
    } else if (s.is_row) {
      sum += s.difference * vg_dot(s.area, s.area) / vg_dot(s.area, s.to);
    } else {
      return 0;
    }
  }
  *out = sum / v->volume[i];
  return 1;
}
