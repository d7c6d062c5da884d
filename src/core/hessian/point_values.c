/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/hessian/point_values.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/mesh/cell_faces.h"

/* Share of the largest variance of the centres, in any direction, below which
 * they count as being in a plane: layers of an aspect of 30,000 do not. */
#define FLAT 1e-9

/* Weighted sums over the cells of a point: of weights, of the vectors d to
 * their centres, of the components of d d^T in the order of tensor.h, of the
 * values f less that of the first cell, and of f d. After the fit: means, and
 * the gradient. */
struct sums {
  double first, weight, d[3], dd[6], f, fd[3];
  double gradient[3];
  int rank;        /* directions in which the centres determine the gradient */
  double n_around; /* points with all three around a point that has fewer */
};

static void add_cone(const double a[3], const double b[3], const double c[3],
                     double *volume, double sum[3])
{
  const double v = vg_triple(a, b, c);

  *volume += v;
  for (int k = 0; k < 3; k++) sum[k] += v * (a[k] + b[k] + c[k]) / 4;
}

/* Centre of the volume of a cell, from the cones of its faces with the apex in
 * its first corner; a quadrilateral is four triangles around its centre. */
static void centre_of(const struct vg_mesh *m, int kind, const uint32_t *node,
                      double centre[3])
{
  const double *origin = m->point[node[0]];
  double volume = 0, sum[3] = { 0, 0, 0 };

  for (int f = 0; f < vg_cell_faces[kind].n_face; f++) {
    const unsigned char *corner = vg_cell_faces[kind].face[f];
    double x[4][3], middle[3];

    for (int i = 0; i < 4; i++) vg_sub(m->point[node[corner[i]]], origin, x[i]);
    if (corner[3] == corner[2]) {
      add_cone(x[0], x[1], x[2], &volume, sum);
      continue;
    }
    for (int k = 0; k < 3; k++)
      middle[k] = (x[0][k] + x[1][k] + x[2][k] + x[3][k]) / 4;
    for (int i = 0; i < 4; i++)
      add_cone(x[i], x[(i + 1) % 4], middle, &volume, sum);
  }
  for (int k = 0; k < 3; k++)
    centre[k] = origin[k] + (volume != 0 ? sum[k] / volume : 0);
}

static void add_value(struct sums *s, const double d[3], double value)
{
  const double square = vg_dot(d, d), w = square > 0 ? 1 / square : 1;
  int n = 0;

  if (s->weight == 0) s->first = value;
  value -= s->first;
  s->weight += w;
  s->f += w * value;
  for (int i = 0; i < 3; i++) {
    s->d[i] += w * d[i];
    s->fd[i] += w * value * d[i];
    for (int k = i; k < 3; k++) s->dd[n++] += w * d[i] * d[k];
  }
}

static void add_cells(const struct vg_mesh *m, int kind, size_t n,
                      const uint32_t *node, const double *value,
                      struct sums *at)
{
  const int width = vg_cell_faces[kind].width;

  for (size_t c = 0; c < n; c++, node += width) {
    double centre[3], d[3];

    centre_of(m, kind, node, centre);
    for (int i = 0; i < width; i++) {
      vg_sub(centre, m->point[node[i]], d);
      add_value(at + node[i], d, value[c]);
    }
  }
}

/* Means and gradient of the function that fits the values of a point. */
static void fit(struct sums *s)
{
  double value[3], axis[3][3], most;
  int n = 0;

  if (s->weight == 0) return;
  s->f /= s->weight;
  for (int k = 0; k < 3; k++) s->d[k] /= s->weight;
  for (int i = 0; i < 3; i++) {
    s->fd[i] = s->fd[i] / s->weight - s->f * s->d[i];
    for (int k = i; k < 3; k++, n++)
      s->dd[n] = s->dd[n] / s->weight - s->d[i] * s->d[k];
  }
  vg_tensor_eigen(s->dd, value, axis);
  most = fmax(fmax(value[0], value[1]), value[2]);
  for (int i = 0; i < 3; i++) {
    if (!(value[i] > FLAT * most)) continue;
    s->rank++;
    for (int k = 0; k < 3; k++)
      s->gradient[k] += vg_dot(s->fd, axis[i]) / value[i] * axis[i][k];
  }
}

/* Points whose centres do not determine the gradient, such as a corner with one
 * cell, get the mean of the other corners of their cells whose centres do. */
static void lend_gradients(int kind, size_t n, const uint32_t *node,
                           struct sums *at)
{
  const int width = vg_cell_faces[kind].width;

  for (size_t c = 0; c < n; c++, node += width)
    for (int i = 0; i < width; i++) {
      struct sums *to = at + node[i];

      for (int k = 0; k < width && to->rank < 3; k++) {
        const struct sums *from = at + node[k];

        if (from->rank < 3) continue;
        if (to->n_around == 0) memset(to->gradient, 0, sizeof to->gradient);
        to->n_around++;
        for (int j = 0; j < 3; j++) to->gradient[j] += from->gradient[j];
      }
    }
}

/* The function at the point: its value at the mean centre, less the gradient
 * times the vector to it. */
static double at_point(const struct sums *s)
{
  if (s->weight == 0) return 0;
  return s->first + s->f -
         vg_dot(s->gradient, s->d) / (s->n_around > 0 ? s->n_around : 1);
}

vg_status vg_point_values(const struct vg_mesh *m, const double *cell,
                          double *point, struct vg_error *err)
{
  const size_t n[4] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  struct sums *at = vg_calloc(m->n_point, sizeof *at);

  if (!at) return vg_fail_memory(err, "values at points");
  for (int k = 0; k < 4; k++) {
    add_cells(m, k, n[k], vg_mesh_nodes(m, k), cell, at);
    cell += n[k];
  }
  for (size_t p = 0; p < m->n_point; p++) fit(at + p);
  for (int k = 0; k < 4; k++) lend_gradients(k, n[k], vg_mesh_nodes(m, k), at);
  for (size_t p = 0; p < m->n_point; p++) point[p] = at_point(at + p);
  free(at);
  return VG_OK;
}
