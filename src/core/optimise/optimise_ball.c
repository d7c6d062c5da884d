/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shapes of the cells around a point and their gradients, as loops without
 * branches over arrays, which compilers vectorise. */
#include "core/optimise/optimise_ball.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/wide.h"
#include "core/sizing/sizing.h"

/* Weights in vg_ball_other: of volume^2 / E^3 relative to a regular cell, and
 * of the squared deviation from the target length. Then the weights of both in
 * the gradient, relative to the logarithm of the shape. */
static const double round_share = 0.3, size_share = 0.5; /* K28 */
static const double round_slope = 1.2, size_slope = 0.5;

/* Cells are processed BLOCK at a time. The arrays are filled up to a multiple
 * of BLOCK with copies of the last cell. */
enum { BLOCK = 8 };

static size_t whole_blocks(size_t n)
{
  return (n + BLOCK - 1) / BLOCK * BLOCK;
}

/* Quantities of a block of faces that follow from the corners. */
VG_WITHIN void measure(struct vg_ball_faces *b, size_t at)
{
  for (size_t k = at; k < at + BLOCK; k++) {
    double e[3][3], area2 = 0;

    for (int i = 0; i < 3; i++) {
      b->edge2[i][k] = 0;
      for (int a = 0; a < 3; a++) {
        e[i][a] = b->x[(i + 2) % 3][a][k] - b->x[(i + 1) % 3][a][k];
        b->edge2[i][k] += e[i][a] * e[i][a];
      }
    }
    for (int a = 0; a < 3; a++) {
      int c = (a + 1) % 3, d = (a + 2) % 3;
      double s = e[0][c] * e[1][d] - e[0][d] * e[1][c];

      b->normal[a][k] = s;
      area2 += s * s;
    }
    b->area2[k] = area2;
    b->border2[k] = b->edge2[0][k] + b->edge2[1][k] + b->edge2[2][k];
  }
}

VG_WITHIN void measure_all(struct vg_ball_faces *b)
{
  for (size_t at = 0; at < b->n; at += BLOCK) measure(b, at);
}

#ifdef VG_WIDE
static VG_WIDE void measure_wide(struct vg_ball_faces *b)
{
  measure_all(b);
}
#endif

static void measure_faces(struct vg_ball_faces *b)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) {
    measure_wide(b);
    return;
  }
#endif
  measure_all(b);
}

void vg_ball_faces(const struct vg_tets *t, size_t n, const uint32_t *link,
                   struct vg_ball_faces *out)
{
  assert(n > 0 && n <= VG_BALL_MAX);
  out->n = n;
  for (size_t k = 0; k < whole_blocks(n); k++) {
    uint32_t own = link[k < n ? k : n - 1];
    const uint32_t *v = t->cell[own >> 2].v;
    const uint8_t *f = vg_face[own & 3];

    for (int i = 0; i < 3; i++)
      for (int a = 0; a < 3; a++) out->x[i][a][k] = t->x[v[f[i]]][a];
  }
  measure_faces(out);
}

void vg_ball_target(const struct vg_sizing *sizing, const double x[3],
                    struct vg_ball_faces *b)
{
  double h = sizing ? vg_sizing_at(sizing, x) : 0;

  b->per = sizing ? 1 / (6 * h * h) : 0;
}

/* Cell k with the point at x: edges to the corners of the face and their
 * squared lengths; for the faces between them, each opposite a corner, normals
 * and their squares. */
struct cone {
  double u[3][3], l[3], n[3][3], s[3], det;
};

VG_WITHIN void raise(const struct vg_ball_faces *b, size_t k, const double x[3],
                     struct cone *c)
{
  for (int i = 0; i < 3; i++) {
    for (int a = 0; a < 3; a++) c->u[i][a] = b->x[i][a][k] - x[a];
    c->l[i] = c->u[i][0] * c->u[i][0] + c->u[i][1] * c->u[i][1] +
              c->u[i][2] * c->u[i][2];
  }
  for (int i = 0; i < 3; i++) {
    const double *p = c->u[(i + 1) % 3], *q = c->u[(i + 2) % 3];

    for (int a = 0; a < 3; a++) {
      int d = (a + 1) % 3, e = (a + 2) % 3;

      c->n[i][a] = p[d] * q[e] - p[e] * q[d];
    }
    c->s[i] = c->n[i][0] * c->n[i][0] + c->n[i][1] * c->n[i][1] +
              c->n[i][2] * c->n[i][2];
  }
  c->det = -(c->u[0][0] * b->normal[0][k] + c->u[0][1] * b->normal[1][k] +
             c->u[0][2] * b->normal[2][k]);
}

VG_WITHIN double least_of(double a, double b)
{
  return a < b ? a : b;
}

VG_WITHIN int shapes(const struct vg_ball_faces *b, const double x[3],
                     double stop, double *q)
{
  for (size_t at = 0; at < b->n; at += BLOCK) {
    double of[BLOCK], worst = 2;

    for (size_t k = 0; k < BLOCK; k++) {
      struct cone c;
      double s = b->area2[at + k], least, all, square;

      raise(b, at + k, x, &c);
      least = least_of(least_of(c.l[0] * c.s[0], c.l[1] * c.s[1]),
                       c.l[2] * c.s[2]) *
              s;
      least = least_of(least, b->edge2[0][at + k] * c.s[1] * c.s[2]);
      least = least_of(least, b->edge2[1][at + k] * c.s[2] * c.s[0]);
      least = least_of(least, b->edge2[2][at + k] * c.s[0] * c.s[1]);
      all = c.s[0] * c.s[1] * c.s[2] * s;
      square = c.det * fabs(c.det);
      /* As in vg_shape: nonzero only if rounding cannot affect the sign. */
      of[k] = ((all > 0) &
               (fabs(square) >
                1e-24 * c.l[0] * b->edge2[0][at + k] * b->edge2[1][at + k]))
              ? square * least / all
              : 0;
    }
    for (size_t k = 0; k < BLOCK; k++) {
      worst = least_of(worst, of[k]);
      q[at + k] = of[k];
    }
    if (worst <= stop) return 0;
  }
  return 1;
}

#ifdef VG_WIDE
static VG_WIDE int shapes_wide(const struct vg_ball_faces *b, const double x[3],
                               double stop, double *q)
{
  return shapes(b, x, stop, q);
}
#endif

int vg_ball_shapes(const struct vg_ball_faces *b, const double x[3],
                   double stop, double *q)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) return shapes_wide(b, x, stop, q);
#endif
  return shapes(b, x, stop, q);
}

void vg_ball_cells(const struct vg_tets *t, uint32_t first, size_t n, float *q)
{
  static const double origin[3] = { 0 };
  struct vg_ball_faces b;
  double shape[VG_BALL_MAX];

  assert(n > 0 && n <= VG_BALL_MAX && first + n <= t->n_cell);
  b.n = n;
  for (size_t k = 0; k < whole_blocks(n); k++) {
    const uint32_t *v = t->cell[first + (k < n ? k : n - 1)].v;

    for (int i = 0; i < 3; i++)
      for (int a = 0; a < 3; a++)
        b.x[i][a][k] = t->x[v[vg_face[3][i]]][a] - t->x[v[3]][a];
  }
  measure_faces(&b);
  vg_ball_shapes(&b, origin, -INFINITY, shape);
  for (size_t k = 0; k < n; k++) q[k] = (float)shape[k];
}

/* Terms of a block of cells. */
VG_WITHIN void others(const struct vg_ball_faces *b, size_t at,
                      const double x[3], double of[BLOCK])
{
  for (size_t k = 0; k < BLOCK; k++) {
    struct cone c;
    double e, off;

    raise(b, at + k, x, &c);
    e = c.l[0] + c.l[1] + c.l[2] + b->border2[at + k];
    off = e * b->per - 1;
    of[k] = round_share * 432 * c.det * c.det / (e * e * e) -
            size_share * off * off;
  }
}

#ifdef VG_WIDE
static VG_WIDE void others_wide(const struct vg_ball_faces *b, size_t at,
                                const double x[3], double of[BLOCK])
{
  others(b, at, x, of);
}
#endif

double vg_ball_other(const struct vg_ball_faces *b, const double x[3])
{
  double sum = 0;

  for (size_t at = 0; at < b->n; at += BLOCK) {
    size_t n = b->n - at < BLOCK ? b->n - at : BLOCK;
    double of[BLOCK];

#ifdef VG_WIDE
    if (VG_IS_WIDE) others_wide(b, at, x, of);
    else
#endif
      others(b, at, x, of);
    for (size_t k = 0; k < n; k++) sum += of[k];
  }
  return sum;
}

void vg_ball_ideal(const struct vg_ball_faces *b, const double *q,
                   const double x[3], double to[3])
{
  static const double height =
    0.81649658092772603; /* height of a regular tetrahedron with edge 1 */
  double sum[3] = { 0 }, total = 0;

  assert(b->n > 0);
  for (size_t k = 0; k < b->n; k++) {
    double w = 1 - q[k], l2 = b->edge2[0][k] + b->edge2[1][k] + b->edge2[2][k];
    double h = b->area2[k] > 0 ? height * sqrt(l2 / (3 * b->area2[k])) : 0;

    total += w;
    for (int a = 0; a < 3; a++)
      sum[a] += w * ((b->x[0][a][k] + b->x[1][a][k] + b->x[2][a][k]) / 3 +
                     h * b->normal[a][k]);
  }
  for (int a = 0; a < 3; a++) to[a] = total > 0 ? sum[a] / total : x[a];
}

void vg_ball_centre(const struct vg_ball_faces *b, const double x[3],
                    double to[3])
{
  double sum[3] = { 0 }, total = 0;

  for (size_t k = 0; k < b->n; k++) {
    double volume = 0;

    for (int a = 0; a < 3; a++)
      volume += (x[a] - b->x[0][a][k]) * b->normal[a][k];
    total += volume;
    for (int a = 0; a < 3; a++)
      sum[a] += volume * (b->x[0][a][k] + b->x[1][a][k] + b->x[2][a][k]);
  }
  for (int a = 0; a < 3; a++)
    to[a] = total > 0 ? 0.25 * x[a] + 0.25 * sum[a] / total : x[a];
}

/* Subtract the part of edge i, if it has the least angle, and of the face
 * opposite corner i. A function instead of a loop, which compilers would not
 * unroll before they vectorise over cells. */
VG_WITHIN void add_slope(const struct cone *c, const double up[3],
                         const double border[3], int i, double g[3])
{
  int j = (i + 1) % 3, k = (i + 2) % 3;
  const double *p = c->u[j], *r = c->u[k];
  double edge = up[i] / c->l[i];
  double face = (up[j] + up[k] + border[i]) / c->s[i];

  for (int a = 0; a < 3; a++) {
    int d = (a + 1) % 3, e = (a + 2) % 3;

    g[a] -= edge * c->u[i][a] +
            face * ((p[d] - r[d]) * c->n[i][e] - (p[e] - r[e]) * c->n[i][d]);
  }
}

/* Gradient for cell k. The shape is det^2 l / (s s') at the edge where this is
 * smallest; sqrt(l) is the length of the edge, and sqrt(s) and sqrt(s') are
 * twice the areas of its faces. The edge from the point to corner i lies
 * between the faces opposite the other two corners. The base edge opposite
 * corner i lies between the base and face i, of which only face i changes. */
VG_WITHIN void slope_of(const struct vg_ball_faces *b, size_t k,
                        const double x[3], double g[3])
{
  struct cone c;
  double up[3], border[3], least, edges2, wide, high;

  raise(b, k, x, &c);
  for (int i = 0; i < 3; i++) {
    up[i] = c.l[i] * c.s[i] * b->area2[k];
    border[i] = b->edge2[i][k] * c.s[(i + 1) % 3] * c.s[(i + 2) % 3];
  }
  least = least_of(least_of(least_of(up[0], up[1]), least_of(up[2], border[0])),
                   least_of(border[1], border[2]));
  for (int i = 0; i < 3; i++) {
    up[i] = up[i] <= least ? 1.0 : 0.0;
    border[i] = border[i] <= least ? 1.0 : 0.0;
  }
  edges2 = c.l[0] + c.l[1] + c.l[2] + b->border2[k];
  wide = 3 * round_slope / edges2 +
         2 * size_slope * b->per * (edges2 * b->per - 1);
  high = (1 + round_slope) / c.det;
  for (int a = 0; a < 3; a++)
    g[a] = high * b->normal[a][k] + wide * (c.u[0][a] + c.u[1][a] + c.u[2][a]);
  add_slope(&c, up, border, 0, g);
  add_slope(&c, up, border, 1, g);
  add_slope(&c, up, border, 2, g);
}

/* Sum of the gradients of all cells. */
VG_WITHIN void slope(const struct vg_ball_faces *b, const double x[3],
                     double sum[3])
{
  for (size_t at = 0; at < b->n; at += BLOCK) {
    size_t n = b->n - at < BLOCK ? b->n - at : BLOCK;
    double of[3][BLOCK];

    for (size_t k = 0; k < BLOCK; k++) {
      double h[3];

      slope_of(b, at + k, x, h);
      of[0][k] = h[0];
      of[1][k] = h[1];
      of[2][k] = h[2];
    }
    for (size_t k = 0; k < n; k++)
      for (int a = 0; a < 3; a++) sum[a] += of[a][k];
  }
}

#ifdef VG_WIDE
static VG_WIDE void slope_wide(const struct vg_ball_faces *b, const double x[3],
                               double sum[3])
{
  slope(b, x, sum);
}
#endif

void vg_ball_slope(const struct vg_ball_faces *b, const double x[3],
                   double g[3])
{
  double sum[3] = { 0 };

#ifdef VG_WIDE
  if (VG_IS_WIDE) slope_wide(b, x, sum);
  else
#endif
    slope(b, x, sum);
  memcpy(g, sum, sizeof sum);
}

void vg_ball_slope_of(const struct vg_ball_faces *b, size_t k,
                      const double x[3], double g[3])
{
  assert(k < b->n);
  slope_of(b, k, x, g);
}
