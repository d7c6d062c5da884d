/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/rim_planes.h"

#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"

#define CORNER 0.9       /* S126: cosine of the turn where a part may begin */
#define MOST_CORNERS 512 /* S126 */
#define STRAIGHT 1e-6    /* S126: area of a straight run, of its extent^2 */
#define ON_WALL 0.99     /* S126: cosine of the angle of a cap to the wall */
#define LEAST_ANGLE 0.05 /* S126: triple product of the normals of 3 planes */

static const double *at(const struct vg_rim_loop *l, size_t i)
{
  return l->x[l->point[i % l->n]];
}

/* Area vector of the points from i to j and, if not NULL, the foot; and their
 * largest distance from point i. */
static void measure(const struct vg_rim_loop *l, size_t i, size_t j,
                    const double *foot, double area[3], double *extent)
{
  const double *o = at(l, i);
  double u[3], v[3], c[3];

  area[0] = area[1] = area[2] = *extent = 0;
  for (size_t k = i + 1; k <= j; k++) {
    const double *next = k < j ? at(l, k + 1) : foot;

    vg_sub(at(l, k), o, u);
    *extent = fmax(*extent, vg_norm(u));
    if (!next) break;
    vg_sub(next, o, v);
    vg_cross(u, v, c);
    for (int d = 0; d < 3; d++) area[d] += c[d];
  }
}

/* Whether the points from i to j lie in a plane; *normal is 0 if they lie on a
 * straight line. */
static int is_flat(const struct vg_rim_loop *l, size_t i, size_t j,
                   const double *foot, double flatness, double normal[3])
{
  double extent, u[3];

  measure(l, i, j, foot, normal, &extent);
  if (!(vg_norm(normal) > STRAIGHT * extent * extent)) {
    normal[0] = normal[1] = normal[2] = 0;
    return 1;
  }
  vg_unit(normal);
  for (size_t k = i + 1; k <= j; k++) {
    vg_sub(at(l, k), at(l, i), u);
    if (fabs(vg_dot(u, normal)) > flatness * extent) return 0;
  }
  if (!foot) return 1;
  vg_sub(foot, at(l, i), u);
  return fabs(vg_dot(u, normal)) <= flatness * extent;
}

/* Last point of the longest flat run that starts at i and ends at `end` at the
 * latest. Runs of flat runs are flat, so that bisection finds it. */
static size_t flat_until(const struct vg_rim_loop *l, size_t i, size_t end,
                         double flatness)
{
  size_t flat = i + 1, not_flat = end + 1;
  double normal[3];

  assert(i < end);
  for (size_t step = 2; flat < end; step *= 2) {
    const size_t j = i + step < end ? i + step : end;

    if (!is_flat(l, i, j, NULL, flatness, normal)) {
      not_flat = j;
      break;
    }
    flat = j;
  }
  while (flat + 1 < not_flat) {
    const size_t j = flat + (not_flat - flat) / 2;

    if (is_flat(l, i, j, NULL, flatness, normal)) flat = j;
    else not_flat = j;
  }
  return flat;
}

/* Length of the loop from point i to point j; with a normal, only that of edges
 * where the cap with this normal lies on the surface. */
static double length(const struct vg_rim_loop *l, size_t i, size_t j,
                     const double *normal)
{
  double sum = 0;

  for (; i < j; i++) {
    const uint32_t apex = l->apex[l->point[i % l->n]];
    double e[3], in[3], w[3], long_e, along;

    vg_sub(at(l, i + 1), at(l, i), e);
    long_e = vg_unit(e);
    if (normal) {
      if (apex == UINT32_MAX || !(long_e > 0)) continue;
      vg_cross(normal, e, in);
      vg_sub(l->x[apex], at(l, i), w);
      along = vg_dot(w, e);
      for (int d = 0; d < 3; d++) w[d] -= along * e[d];
      if (!(vg_unit(w) > 0) || vg_dot(w, in) < ON_WALL) continue;
    }
    sum += long_e;
  }
  return sum;
}

int vg_rim_parts_are_flat(const struct vg_rim_loop *l,
                          const struct vg_rim_parts *p, double flatness)
{
  assert(p->n_part == 2 || p->n_part == 3);
  for (int k = 0; k < p->n_part; k++) {
    const size_t i = p->at[k], j = p->at[k + 1];
    double normal[3];

    if (!is_flat(l, i, j, p->n_part == 3 ? p->foot : NULL, flatness, normal) ||
        !(vg_norm(normal) > 0) ||
        length(l, i, j, normal) > 0.5 * length(l, i, j, NULL))
      return 0;
  }
  return 1;
}

/* Turn of the loop at point i. */
static int is_corner(const struct vg_rim_loop *l, size_t i)
{
  double in[3], out[3];

  vg_sub(at(l, i), at(l, i + l->n - 1), in);
  vg_sub(at(l, i + 1), at(l, i), out);
  return vg_unit(in) > 0 && vg_unit(out) > 0 && vg_dot(in, out) < CORNER;
}

/* Point in which the planes of three parts meet. */
static int find_foot(const struct vg_rim_loop *l, struct vg_rim_parts *p,
                     double flatness)
{
  double n[3][3], c[3], d[3], det;
  const double *o = at(l, p->at[0]);

  for (int k = 0; k < 3; k++) {
    double u[3];

    if (!is_flat(l, p->at[k], p->at[k + 1], NULL, flatness, n[k]) ||
        !(vg_norm(n[k]) > 0))
      return 0;
    vg_sub(at(l, p->at[k]), o, u);
    d[k] = vg_dot(n[k], u);
  }
  vg_cross(n[1], n[2], c);
  det = vg_dot(n[0], c);
  if (fabs(det) < LEAST_ANGLE) return 0;
  for (int i = 0; i < 3; i++) p->foot[i] = o[i];
  for (int k = 0; k < 3; k++) {
    vg_cross(n[(k + 1) % 3], n[(k + 2) % 3], c);
    for (int i = 0; i < 3; i++) p->foot[i] += d[k] / det * c[i];
  }
  return 1;
}

/* Divide the loop into flat runs, the first of which begins at point i. */
static int divide_at(const struct vg_rim_loop *l, size_t i, double flatness,
                     struct vg_rim_parts *p)
{
  const size_t end = i + l->n;

  p->at[0] = i;
  p->at[1] = flat_until(l, i, end - 1, flatness);
  p->at[2] = flat_until(l, p->at[1], end, flatness);
  p->n_part = 2;
  if (p->at[2] == end) return 1;
  p->at[3] = flat_until(l, p->at[2], end, flatness);
  p->n_part = 3;
  return p->at[3] == end && find_foot(l, p, flatness);
}

int vg_rim_parts_find(const struct vg_rim_loop *l, double flatness,
                      struct vg_rim_parts *parts)
{
  struct vg_rim_parts p;
  double longest = 0;
  size_t n_corner = 0;
  int least = 4;

  assert(l->n > 2);
  for (size_t i = 0; i < l->n; i++) n_corner += (size_t)is_corner(l, i);
  if (n_corner > MOST_CORNERS) return 0;
  for (size_t i = 0; i < l->n; i++) {
    double shortest = INFINITY;

    if (!is_corner(l, i) || !divide_at(l, i, flatness, &p) ||
        p.n_part > least || !vg_rim_parts_are_flat(l, &p, flatness))
      continue;
    for (int k = 0; k < p.n_part; k++)
      shortest = fmin(shortest, length(l, p.at[k], p.at[k + 1], NULL));
    if (p.n_part == least && shortest <= longest * (1 + flatness)) continue;
    least = p.n_part;
    longest = shortest;
    *parts = p;
  }
  return least < 4;
}
