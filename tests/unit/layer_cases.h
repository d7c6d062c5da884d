/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Closed surfaces that are hard for layers, each with a chosen edge length:
 * slots, concave corners, bodies with edges and apexes, near misses, walls that
 * meet a symmetry plane at an angle. Normals point into the fluid; walls have
 * the condition 4 (viscous), symmetry planes 1, farfields 3. Header only. */
#ifndef TESTS_UNIT_LAYER_CASES_H
#define TESTS_UNIT_LAYER_CASES_H

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/domain/planar_patch.h"
#include "core/geometry/vector.h"
#include "fill_shapes.h"

enum { CASE_SYMMETRY = 1, CASE_FARFIELD = 3, CASE_WALL = 4 };

/* Edge length h in a box, growing with the distance from it. */
struct case_size {
  double h, growth, h_max, lo[3], hi[3];
};

/* A straight edge in pieces: n + 1 points from a to b. */
struct case_line {
  uint32_t a, b, *point;
  size_t n;
};

/* The components of a surface: points, lines between them that the faces on
 * both sides share, and plane faces bounded by loops of lines. */
struct case_builder {
  struct vg_mesh *m;
  struct case_size size;
  struct case_line *line;
  size_t n_line;
  uint32_t (*edge)[2]; /* loops of the current face */
  size_t n_edge;
};

static inline double case_size_at(void *user, const double x[3])
{
  const struct case_size *s = user;
  double d2 = 0, h;

  for (int k = 0; k < 3; k++) {
    double d = fmax(fmax(s->lo[k] - x[k], x[k] - s->hi[k]), 0);

    d2 += d * d;
  }
  h = s->h + (s->growth - 1) * sqrt(d2);
  return h < s->h_max ? h : s->h_max;
}

/* Uniform size h. */
static inline struct case_builder case_start(struct vg_mesh *m, double h)
{
  struct case_builder b = { .m = m,
                            .size = { h, 1, h, { 0, 0, 0 }, { 0, 0, 0 } } };

  return b;
}

/* Size h within `half` of the origin. */
static inline struct case_builder case_start_body(struct vg_mesh *m, double h,
                                                  double half)
{
  struct case_builder b = {
    .m = m, .size = { h, 1.3, 1, { -half, -half, -half }, { half, half, half } }
  };

  return b;
}

static inline void case_end(struct case_builder *b)
{
  for (size_t i = 0; i < b->n_line; i++) free(b->line[i].point);
  free(b->line);
  free(b->edge);
}

/* A patch with one of the conditions above; axis 0, 1, 2: that of a symmetry
 * plane. */
static inline uint32_t case_patch(struct vg_mesh *m, const char *name, int bc,
                                  int axis)
{
  size_t p = vg_mesh_add_patch(m, 21 + (int32_t)m->n_patch, name);

  if (p == SIZE_MAX) abort();
  m->patch[p].bc = m->patch[p].family = bc;
  m->patch[p].bc_fun3d = bc == CASE_WALL     ? 4000
                       : bc == CASE_FARFIELD ? 5000
                                             : 6661 + axis;
  return (uint32_t)p;
}

static inline uint32_t case_point(struct case_builder *b, double x, double y,
                                  double z)
{
  return shape_point(b->m, x, y, z);
}

enum { CASE_SAMPLES = 256 };

/* Divide a line so that each piece is as long as the local size. */
static inline void case_divide(struct case_builder *b, struct case_line *l)
{
  double from[3], to[3], sum[CASE_SAMPLES + 1] = { 0 }, length = 0;

  memcpy(from, b->m->point[l->a], sizeof from);
  memcpy(to, b->m->point[l->b], sizeof to);
  for (int k = 0; k < 3; k++) length += (to[k] - from[k]) * (to[k] - from[k]);
  length = sqrt(length);
  for (int i = 0; i < CASE_SAMPLES; i++) {
    double x[3], t = (i + 0.5) / CASE_SAMPLES;

    for (int k = 0; k < 3; k++) x[k] = from[k] + (to[k] - from[k]) * t;
    sum[i + 1] = sum[i] + length / CASE_SAMPLES / case_size_at(&b->size, x);
  }
  l->n = (size_t)fmax(1, floor(sum[CASE_SAMPLES] + 0.5));
  l->point = vg_alloc(l->n + 1, sizeof *l->point);
  shape_need(l->point);
  l->point[0] = l->a;
  for (size_t j = 1, i = 0; j < l->n; j++) {
    double goal = sum[CASE_SAMPLES] * (double)j / (double)l->n, t;

    while (sum[i + 1] < goal) i++;
    t = ((double)i + (goal - sum[i]) / (sum[i + 1] - sum[i])) / CASE_SAMPLES;
    l->point[j] = shape_point(b->m, from[0] + (to[0] - from[0]) * t,
                              from[1] + (to[1] - from[1]) * t,
                              from[2] + (to[2] - from[2]) * t);
  }
  l->point[l->n] = l->b;
}

static inline void case_edge(struct case_builder *b, uint32_t from, uint32_t to)
{
  b->edge = vg_realloc(b->edge, b->n_edge + 1, sizeof *b->edge);
  shape_need(b->edge);
  b->edge[b->n_edge][0] = from;
  b->edge[b->n_edge++][1] = to;
}

/* A side of the current face; the line is created on first use. */
static inline void case_side(struct case_builder *b, uint32_t from, uint32_t to)
{
  size_t i = 0;
  struct case_line *l;

  while (i < b->n_line && !(b->line[i].a == from && b->line[i].b == to) &&
         !(b->line[i].a == to && b->line[i].b == from))
    i++;
  if (i == b->n_line) {
    b->line = vg_realloc(b->line, b->n_line + 1, sizeof *b->line);
    shape_need(b->line);
    b->line[b->n_line++] = (struct case_line){ .a = from, .b = to };
    case_divide(b, &b->line[i]);
  }
  l = &b->line[i];
  for (size_t j = 0; j < l->n; j++)
    if (l->a == from) case_edge(b, l->point[j], l->point[j + 1]);
    else case_edge(b, l->point[l->n - j], l->point[l->n - j - 1]);
}

/* A loop of straight sides, region on its left; with `reverse` in the opposite
 * order. */
static inline void case_loop(struct case_builder *b, size_t n,
                             const uint32_t *v, int reverse)
{
  for (size_t i = 0; i < n; i++)
    if (reverse) case_side(b, v[(n - i) % n], v[n - i - 1]);
    else case_side(b, v[i], v[(i + 1) % n]);
}

/* Triangulate the current face. */
static inline void case_fill(struct case_builder *b, uint32_t patch)
{
  const struct vg_size_function law = { .at = case_size_at, .user = &b->size };

  if (vg_planar_patch(b->m, b->n_edge, (const uint32_t(*)[2])b->edge, &law,
                      patch, NULL) < 0)
    abort();
  b->n_edge = 0;
}

/* Corners of a box: bit k of the index selects the side along axis k. */
static inline void case_corners(struct case_builder *b, const double lo[3],
                                const double hi[3], uint32_t v[8])
{
  for (int i = 0; i < 8; i++)
    v[i] = case_point(b, i & 1 ? hi[0] : lo[0], i & 2 ? hi[1] : lo[1],
                      i & 4 ? hi[2] : lo[2]);
}

/* The loop of one side of a box, 2 * axis + (1: upper). */
static inline void case_box_loop(struct case_builder *b, const uint32_t v[8],
                                 int side, int is_body)
{
  int d = side / 2, up = side % 2 << d;
  int s = 1 << (d + 1) % 3, t = 1 << (d + 2) % 3;
  const uint32_t loop[4] = { v[up], v[up | s], v[up | s | t], v[up | t] };

  case_loop(b, 4, loop, is_body ? side % 2 == 0 : side % 2);
}

/* A box with the fluid inside, or a body with the fluid outside. */
static inline void case_box(struct case_builder *b, const double lo[3],
                            const double hi[3], const uint32_t patch[6],
                            int is_body)
{
  uint32_t v[8];

  case_corners(b, lo, hi, v);
  for (int side = 0; side < 6; side++) {
    case_box_loop(b, v, side, is_body);
    case_fill(b, patch[side]);
  }
}

/* A farfield: a cube about the origin, at z >= bottom. */
static inline void case_far_box(struct case_builder *b, double half)
{
  const double lo[3] = { -half, -half, -half }, hi[3] = { half, half, half };
  uint32_t patch[6];

  patch[0] = case_patch(b->m, "farfield", CASE_FARFIELD, 0);
  for (int i = 1; i < 6; i++) patch[i] = patch[0];
  case_box(b, lo, hi, patch, 0);
}

/* A polygon in x and z, counter-clockwise with x to the right and z up,
 * extruded from y0 to y1. side[i]: patch from corner i on. */
static inline void case_extrude(struct case_builder *b, size_t n,
                                const double (*xz)[2], const uint32_t *side,
                                double y0, double y1, const uint32_t end[2],
                                int is_body)
{
  uint32_t v[2][16];

  if (n > 16) abort();
  for (size_t i = 0; i < n; i++) {
    v[0][i] = case_point(b, xz[i][0], y0, xz[i][1]);
    v[1][i] = case_point(b, xz[i][0], y1, xz[i][1]);
  }
  for (size_t i = 0; i < n; i++) {
    size_t j = (i + 1) % n;
    const uint32_t loop[4] = { v[0][i], v[0][j], v[1][j], v[1][i] };

    case_loop(b, 4, loop, is_body);
    case_fill(b, side[i]);
  }
  for (int e = 0; e < 2; e++) {
    if (end[e] == UINT32_MAX) continue;
    case_loop(b, n, v[e], is_body ? e == 1 : e == 0);
    case_fill(b, end[e]);
  }
}

/* A disc of n rings, ring i of 6 i points, mapped into space by `place` (from
 * the relative radius and the direction). Normals up, or flipped. rim: the
 * first point of an existing last ring, else UINT32_MAX. Returns the first
 * point of the last ring. */
static inline uint32_t case_disc(struct vg_mesh *m, int n, uint32_t patch,
                                 void (*place)(double r, double c, double s,
                                               const void *user, double x[3]),
                                 const void *user, uint32_t rim, int flip)
{
  double x[3];
  uint32_t in, out;

  place(0, 1, 0, user, x);
  in = shape_point(m, x[0], x[1], x[2]);
  for (int i = 1; i <= n; i++, in = out) {
    int more = 6 * i, less = i > 1 ? 6 * (i - 1) : 1;

    out = i == n && rim != UINT32_MAX ? rim : (uint32_t)m->n_point;
    for (int j = 0; j < more && out != rim; j++) {
      double a = 2 * M_PI * j / more;

      place((double)i / n, cos(a), sin(a), user, x);
      shape_point(m, x[0], x[1], x[2]);
    }
    for (int j = 0; j < more; j++) {
      int step = j % i, at = j / i * (i - 1) + step;
      uint32_t p = in + (uint32_t)(at % less);
      uint32_t q = in + (uint32_t)((at + 1) % less);
      uint32_t r = out + (uint32_t)j, s = out + (uint32_t)((j + 1) % more);

      if (flip) shape_tri(m, p, s, r, patch);
      else shape_tri(m, p, r, s, patch);
      if (step == i - 1) continue;
      if (flip) shape_tri(m, p, q, s, patch);
      else shape_tri(m, p, s, q, patch);
    }
  }
  return in;
}

/* --- the cases ----------------------------------------------------------- */

/* Two plates that converge to a parallel slot of width `gap`: walls below and
 * above, from x = 0 (1 apart) through x = 1.5 to x = 2.5. */
static inline void case_slot(struct vg_mesh *m, double h, double gap)
{
  struct case_builder b = case_start(m, h);
  const double xz[5][2] = {
    { 0, 0 }, { 2.5, 0 }, { 2.5, gap }, { 1.5, gap }, { 0, 1 }
  };
  uint32_t below = case_patch(m, "below", CASE_WALL, 0);
  uint32_t above = case_patch(m, "above", CASE_WALL, 0);
  uint32_t in = case_patch(m, "in", CASE_FARFIELD, 0);
  uint32_t out = case_patch(m, "out", CASE_FARFIELD, 0);
  uint32_t end[2] = { case_patch(m, "left", CASE_SYMMETRY, 1),
                      case_patch(m, "right", CASE_SYMMETRY, 1) };
  const uint32_t side[5] = { below, out, above, above, in };

  case_extrude(&b, 5, xz, side, 0, 0.8, end, 0);
  case_end(&b);
}

/* Fluid in a corner between two walls of length 1: the first along x, the
 * second at the angle with the given cosine and sine. */
static inline void case_corner(struct vg_mesh *m, double h, double cosine,
                               double sine)
{
  struct case_builder b = case_start(m, h);
  int square = cosine == 0;
  const double xz[4][2] = {
    { 0, 0 }, { 1, 0 }, { square ? 1 : cosine, square ? 1 : sine }, { 0, 1 }
  };
  uint32_t first = case_patch(m, "first", CASE_WALL, 0);
  uint32_t second = case_patch(m, "second", CASE_WALL, 0);
  uint32_t far = case_patch(m, "farfield", CASE_FARFIELD, 0);
  uint32_t top = square ? case_patch(m, "top", CASE_FARFIELD, 0) : second;
  uint32_t end[2] = { case_patch(m, "left", CASE_SYMMETRY, 1),
                      case_patch(m, "right", CASE_SYMMETRY, 1) };
  const uint32_t side[4] = { first, far, top, second };

  case_extrude(&b, square ? 4 : 3, xz, side, 0, 0.8, end, 0);
  case_end(&b);
}

/* A cube of side 1 in a farfield. */
static inline void case_cube(struct vg_mesh *m, double h)
{
  struct case_builder b = case_start_body(m, h, 0.5);
  const double lo[3] = { -0.5, -0.5, -0.5 }, hi[3] = { 0.5, 0.5, 0.5 };
  uint32_t patch[6];

  for (int i = 0; i < 6; i++) patch[i] = case_patch(m, "cube", CASE_WALL, 0);
  case_box(&b, lo, hi, patch, 1);
  case_far_box(&b, 4);
  case_end(&b);
}

/* Two such cubes, face to face with a gap between. */
static inline void case_cubes(struct vg_mesh *m, double h, double gap)
{
  struct case_builder b = case_start_body(m, h, 0.5);
  const double x = 1 + gap,
               lo[2][3] = { { -x, -0.5, -0.5 }, { 0, -0.5, -0.5 } };
  const double hi[2][3] = { { -gap, 0.5, 0.5 }, { 1, 0.5, 0.5 } };
  const uint32_t wall = case_patch(m, "cubes", CASE_WALL, 0);
  const uint32_t patch[6] = { wall, wall, wall, wall, wall, wall };

  for (int i = 0; i < 2; i++) case_box(&b, lo[i], hi[i], patch, 1);
  case_far_box(&b, 4);
  case_end(&b);
}

/* A flat plate, 1 by 1 by `thick`, with right-angled edges. */
static inline void case_plate(struct vg_mesh *m, double h, double thick)
{
  struct case_builder b = case_start_body(m, h, 0.5);
  const double lo[3] = { -0.5, -0.5, -0.5 * thick };
  const double hi[3] = { 0.5, 0.5, 0.5 * thick };
  uint32_t top = case_patch(m, "plate", CASE_WALL, 0);
  uint32_t rim = case_patch(m, "rim", CASE_WALL, 0);
  const uint32_t patch[6] = { rim, rim, rim, rim, top, top };

  case_box(&b, lo, hi, patch, 1);
  case_far_box(&b, 4);
  case_end(&b);
}

/* A double wedge from one symmetry plane to another, with two edges whose angle
 * follows from its thickness, each ending in both planes. */
static inline void case_wedge(struct vg_mesh *m, double h, double thick)
{
  struct case_builder b = case_start_body(m, h, 0.6);
  const double lo[3] = { -3, -0.4, -3 }, hi[3] = { 3, 0.4, 3 };
  const double xz[4][2] = {
    { -0.5, 0 }, { 0, -0.5 * thick }, { 0.5, 0 }, { 0, 0.5 * thick }
  };
  uint32_t below = case_patch(m, "below", CASE_WALL, 0);
  uint32_t above = case_patch(m, "above", CASE_WALL, 0);
  uint32_t far = case_patch(m, "farfield", CASE_FARFIELD, 0);
  uint32_t left = case_patch(m, "left", CASE_SYMMETRY, 1);
  uint32_t right = case_patch(m, "right", CASE_SYMMETRY, 1);
  const uint32_t side[4] = { below, below, above, above };
  const uint32_t none[2] = { UINT32_MAX, UINT32_MAX };
  uint32_t v[8], w[2][4];

  case_corners(&b, lo, hi, v);
  for (uint32_t i = 0; i < 4; i++)
    for (uint32_t e = 0; e < 2; e++) w[e][i] = (uint32_t)m->n_point + 2 * i + e;
  case_extrude(&b, 4, xz, side, lo[1], hi[1], none, 1);
  for (int i = 0; i < 6; i++) {
    case_box_loop(&b, v, i, 0);
    if (i == 2) case_loop(&b, 4, w[0], 0);
    if (i == 3) case_loop(&b, 4, w[1], 1);
    case_fill(&b, i == 2 ? left : i == 3 ? right : far);
  }
  case_end(&b);
}

struct case_cone {
  double radius, height;
};

static inline void case_on_cone(double r, double c, double s, const void *user,
                                double x[3])
{
  const struct case_cone *cone = user;

  x[0] = cone->radius * r * c;
  x[1] = cone->radius * r * s;
  x[2] = cone->height * (1 - r);
}

/* A cone of radius 0.5 and this height, with a flat base. */
static inline void case_cone(struct vg_mesh *m, double h, double height)
{
  struct case_builder b = case_start_body(m, h, 0.6);
  const struct case_cone cone = { 0.5, height }, base = { 0.5, 0 };
  uint32_t wall = case_patch(m, "cone", CASE_WALL, 0);
  uint32_t flat = case_patch(m, "base", CASE_WALL, 0), rim;
  int n = (int)fmax(3, floor(sqrt(0.25 + height * height) / h + 0.5));

  rim = case_disc(m, n, wall, case_on_cone, &cone, UINT32_MAX, 0);
  case_disc(m, n, flat, case_on_cone, &base, rim, 1);
  case_far_box(&b, 4);
  case_end(&b);
}

/* A sphere of radius 0.5 over the plane z = 0, which it misses by `gap`; the
 * plane is a wall or, with axis z, a symmetry plane. */
static inline void case_sphere(struct vg_mesh *m, double h, double gap,
                               int floor_bc)
{
  struct case_builder b = case_start_body(m, h, 0.5);
  const double lo[3] = { -3, -3, 0 }, hi[3] = { 3, 3, 4 };
  const double centre[3] = { 0, 0, 0.5 + gap };
  /* an octant's arc is 0.785 long */
  int n = (int)fmax(3, floor(0.785 / h + 0.5));
  uint32_t patch[6];

  shape_sphere(m, n, centre, 0.5, 9);
  m->patch[0].bc = m->patch[0].family = CASE_WALL;
  m->patch[0].bc_fun3d = 4000;
  for (int i = 0; i < 6; i++)
    patch[i] = i == 4 ? case_patch(m, "floor", floor_bc, 2)
                      : case_patch(m, "farfield", CASE_FARFIELD, 0);
  case_box(&b, lo, hi, patch, 0);
  case_end(&b);
}

struct case_post {
  double lean, height, radius;
};

static inline void case_on_post(double r, double c, double s, const void *user,
                                double x[3])
{
  const struct case_post *post = user;

  x[0] = post->radius * r * c + post->lean * post->height;
  x[1] = post->radius * r * s;
  x[2] = post->height;
}

/* A post on the symmetry plane z = 0: a cylinder whose axis leans by `lean` (in
 * x per z), so that it meets the plane at all angles between atan(1 / lean) and
 * its supplement: 0.577350 gives 60 to 120 degrees. */
static inline void case_post(struct vg_mesh *m, double h, double lean)
{
  struct case_builder b = case_start_body(m, h, 0.8);
  const double lo[3] = { -4, -4, 0 }, hi[3] = { 4, 4, 4 };
  struct case_post post = { lean, 0, 0.4 };
  uint32_t wall = case_patch(m, "post", CASE_WALL, 0);
  uint32_t far = case_patch(m, "farfield", CASE_FARFIELD, 0);
  uint32_t flat = case_patch(m, "symmetry", CASE_SYMMETRY, 2), v[8], top = 0;
  int n = (int)fmax(2, floor(post.radius * 2 * M_PI / 6 / h + 0.5));
  int rows = (int)fmax(2, floor(0.7 * sqrt(1 + lean * lean) / h + 0.5));
  int turn = 6 * n;

  for (int row = 0; row <= rows; row++) {
    uint32_t below = top;

    post.height = 0.7 * row / rows;
    top = (uint32_t)m->n_point;
    for (int j = 0; j < turn; j++) {
      double x[3], a = 2 * M_PI * j / turn;

      case_on_post(1, cos(a), sin(a), &post, x);
      shape_point(m, x[0], x[1], x[2]);
    }
    for (int j = 0; j < turn && row; j++) {
      uint32_t k = (uint32_t)((j + 1) % turn), i = (uint32_t)j;

      shape_tri(m, below + i, below + k, top + k, wall);
      shape_tri(m, below + i, top + k, top + i, wall);
    }
  }
  case_disc(m, n, wall, case_on_post, &post, top, 0);
  case_corners(&b, lo, hi, v);
  for (int side = 0; side < 6; side++) {
    case_box_loop(&b, v, side, 0);
    for (int j = 0; side == 4 && j < turn; j++)
      case_edge(&b, (uint32_t)((j + 1) % turn), (uint32_t)j);
    case_fill(&b, side == 4 ? flat : far);
  }
  case_end(&b);
}

/* The lower part of a body of revolution about the z axis that is sunk into the
 * plane z = 0: a ball of this radius, or two cones on a common base, one with
 * its apex down. `sunk`: depth of the lowest point, below the radius. */
struct case_sunk {
  double radius, height, sunk;
  int is_ball;
};

static inline void case_on_sunk(double r, double c, double s, const void *user,
                                double x[3])
{
  const struct case_sunk *body = user;
  double rim = body->sunk / body->height * body->radius, out, z;

  if (body->is_ball) {
    double below = acos(1 - body->sunk / body->radius);
    double a = r * (M_PI - below);

    out = body->radius * sin(a);
    z = body->radius * (cos(a) - cos(M_PI - below));
  } else if (r < 0.5) {
    out = body->radius * 2 * r;
    z = body->height * (2 - 2 * r) - body->sunk;
  } else {
    out = body->radius + (rim - body->radius) * (2 * r - 1);
    z = (body->height - body->sunk) * (2 - 2 * r);
  }
  x[0] = out * c;
  x[1] = out * s;
  x[2] = r == 1 ? 0 : z;
}

/* Such a body, of n rings of triangles, on a wall. */
static inline void case_sunk_body(struct vg_mesh *m, double h, int n,
                                  const struct case_sunk *body)
{
  struct case_builder b = case_start_body(m, h, body->radius);
  const double far = 4 * body->radius;
  const double lo[3] = { -far, -far, 0 }, hi[3] = { far, far, 2 * far };
  uint32_t wall = case_patch(m, "body", CASE_WALL, 0);
  uint32_t ground = case_patch(m, "ground", CASE_WALL, 0);
  uint32_t out = case_patch(m, "farfield", CASE_FARFIELD, 0);
  uint32_t v[8], rim = case_disc(m, n, wall, case_on_sunk, body, UINT32_MAX, 0);
  int turn = 6 * n;

  case_corners(&b, lo, hi, v);
  for (int side = 0; side < 6; side++) {
    case_box_loop(&b, v, side, 0);
    for (int j = 0; side == 4 && j < turn; j++)
      case_edge(&b, rim + (uint32_t)((j + 1) % turn), rim + (uint32_t)j);
    case_fill(&b, side == 4 ? ground : out);
  }
  case_end(&b);
}

/* Rotates a surface by the unit quaternion q. */
static inline void case_rotate(struct vg_mesh *m, const double q[4])
{
  for (size_t i = 0; i < m->n_point; i++) {
    double *x = m->point[i], u[3], v[3];

    vg_cross(q + 1, x, u);
    vg_cross(q + 1, u, v);
    for (int k = 0; k < 3; k++) x[k] += 2 * (q[0] * u[k] + v[k]);
  }
}

/* A room of 3 x 2 x 1 with a wall as its floor, except for a slip patch in the
 * plane of the floor: all of it at x < 1 (upstream of a plate), or a window of
 * 1 x 0.6. The other sides are symmetry planes. */
static inline void case_flush(struct vg_mesh *m, double h, int is_window)
{
  struct case_builder b = case_start(m, h);
  const double lo[3] = { 0, 0, 0 }, hi[3] = { 3, 2, 1 };
  uint32_t wall = case_patch(m, "floor", CASE_WALL, 0);
  uint32_t slip = case_patch(m, "slip", CASE_SYMMETRY, 2);
  uint32_t v[8], w[4];

  case_corners(&b, lo, hi, v);
  for (uint32_t i = 0; i < 4; i++)
    w[i] = is_window ? case_point(&b, i % 3 ? 2 : 1, i / 2 ? 1.3 : 0.7, 0)
                     : case_point(&b, 1, i % 2 ? 2 : 0, i / 2);
  for (int side = 0; side < 6; side++) {
    const int axis = side / 2;

    if (is_window || axis == 0) {
      case_box_loop(&b, v, side, 0);
      if (side == 4) case_loop(&b, 4, w, 1);
    } else {
      const uint32_t up = axis == 1 ? 2 * (uint32_t)(side % 2) : 0;
      const uint32_t at = axis == 1 ? (uint32_t)(side % 2) : 0;
      const uint32_t top = side == 5 ? 4 : 0;
      const int reverse = side % 2 == (axis == 2);
      const uint32_t y[4] = { v[up], w[at], w[at + 2], v[up + 4] };
      const uint32_t yy[4] = { w[at], v[up + 1], v[up + 5], w[at + 2] };
      const uint32_t z[4] = { v[top], w[top / 2], w[top / 2 + 1], v[top + 2] };
      const uint32_t zz[4] = { w[top / 2], v[top + 1], v[top + 3],
                               w[top / 2 + 1] };

      case_loop(&b, 4, axis == 1 ? y : z, reverse);
      if (side == 4) case_fill(&b, slip);
      case_loop(&b, 4, axis == 1 ? yy : zz, reverse);
    }
    case_fill(&b,
              side == 4 ? wall : case_patch(m, "side", CASE_SYMMETRY, axis));
  }
  if (is_window) {
    case_loop(&b, 4, w, 0);
    case_fill(&b, slip);
  }
  case_end(&b);
}

enum { CASE_OCTANT_SIDE = 12 };

/* Of the eight octants these four are fluid, a path from one to the next. */
static inline int case_in_octants(const int at[3])
{
  int x = 2 * at[0] >= CASE_OCTANT_SIDE, y = 2 * at[1] >= CASE_OCTANT_SIDE;
  int z = 2 * at[2] >= CASE_OCTANT_SIDE;

  return (y && z) || (!x && !y);
}

/* Walls fold so sharply at the origin that no direction is visible from all of
 * them: normals +y, -y, -x and +z meet. Fluid in four octants of a cube of side
 * 2; its outside is a farfield. */
static inline void case_octants(struct vg_mesh *m)
{
  const int n[3] = { CASE_OCTANT_SIDE, CASE_OCTANT_SIDE, CASE_OCTANT_SIDE };
  const double lo[3] = { -1, -1, -1 }, hi[3] = { 1, 1, 1 };
  uint32_t wall;

  shape_block(m, n, lo, hi, case_in_octants);
  for (size_t p = 0; p < m->n_patch; p++) {
    m->patch[p].bc = m->patch[p].family = CASE_FARFIELD;
    m->patch[p].bc_fun3d = 5000;
  }
  wall = case_patch(m, "fold", CASE_WALL, 0);
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3; k++) {
      double x = 0;

      for (int i = 0; i < 3; i++) x += fabs(m->point[m->tri[t][i]][k]);
      if (m->tri_patch[t] / 2 == (uint32_t)k && x == 0) m->tri_patch[t] = wall;
    }
}

#endif
