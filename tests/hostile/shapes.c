/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Surfaces that are well-formed files but bound no volume. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hostile.h"

struct shape {
  size_t n_point, n_tri;
  double point[200][3];
  int tri[300][3]; /* 0-based */
};

static int add_point(struct shape *s, double x, double y, double z)
{
  double *p = s->point[s->n_point];

  p[0] = x;
  p[1] = y;
  p[2] = z;
  return (int)s->n_point++;
}

static void add_tri(struct shape *s, int a, int b, int c)
{
  int *t = s->tri[s->n_tri++];

  t[0] = a;
  t[1] = b;
  t[2] = c;
}

/* A box of twelve triangles; normals outward, or inward with `inward`. */
static void add_box(struct shape *s, double lo, double hi, double dx,
                    int inward)
{
  static const int quad[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 },
                                  { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
                                  { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
  int first = (int)s->n_point;

  for (int i = 0; i < 8; i++)
    add_point(s, (i & 1 ? hi : lo) + dx, i & 2 ? hi : lo, i & 4 ? hi : lo);
  for (int i = 0; i < 6; i++) {
    const int *q = quad[i];

    for (int k = 1; k < 3; k++)
      add_tri(s, first + q[0], first + q[inward ? k + 1 : k],
              first + q[inward ? k : k + 1]);
  }
}

/* As Cart3D text; points with equal coordinates stay distinct. */
static void save_shape(const char *file, const struct shape *s)
{
  static char text[32768];
  size_t n = (size_t)sprintf(text, "%zu %zu\n", s->n_point, s->n_tri);

  for (size_t i = 0; i < s->n_point; i++)
    n += (size_t)sprintf(text + n, "%.17g %.17g %.17g\n", s->point[i][0],
                         s->point[i][1], s->point[i][2]);
  for (size_t i = 0; i < s->n_tri; i++)
    n += (size_t)sprintf(text + n, "%d %d %d\n", s->tri[i][0] + 1,
                         s->tri[i][1] + 1, s->tri[i][2] + 1);
  if (n >= sizeof text) abort();
  save(file, text, n);
}

/* As text STL, where equal coordinates are one point. */
static void save_stl(const char *file, const struct shape *s)
{
  static char text[131072];
  size_t n = (size_t)sprintf(text, "solid shape\n");

  for (size_t i = 0; i < s->n_tri; i++) {
    n += (size_t)sprintf(text + n, "facet normal 0 0 0\nouter loop\n");
    for (int k = 0; k < 3; k++) {
      const double *p = s->point[s->tri[i][k]];

      n += (size_t)sprintf(text + n, "vertex %.17g %.17g %.17g\n", p[0], p[1],
                           p[2]);
    }
    n += (size_t)sprintf(text + n, "endloop\nendfacet\n");
  }
  n += (size_t)sprintf(text + n, "endsolid shape\n");
  if (n >= sizeof text) abort();
  save(file, text, n);
}

static void make_open(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  s.n_tri--;
  save_stl(file, &s);
}

static void make_single(const char *file)
{
  struct shape s = { 0 };

  add_tri(&s, add_point(&s, 0, 0, 0), add_point(&s, 1, 0, 0),
          add_point(&s, 0, 1, 0));
  save_stl(file, &s);
}

/* Corners that differ in the last digit: the rims are welded. */
static void make_not_quite_closed(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  s.tri[0][0] = add_point(&s, 1e-9, 0, 0);
  save_stl(file, &s);
}

/* Two boxes that share an edge, or a face. */
static void make_common_edge(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  add_box(&s, 0, 1, 1, 0);
  for (int i = 8; i < 16; i++) s.point[i][1] += 1;
  save_stl(file, &s);
}

static void make_common_face(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  add_box(&s, 0, 1, 1, 0);
  save_stl(file, &s);
}

static void make_inner_wall(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  add_tri(&s, 0, 1, 7);
  add_tri(&s, 0, 7, 6);
  save_stl(file, &s);
}

static void make_crossing(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  add_box(&s, 0.25, 0.75, 0.5, 0);
  save_shape(file, &s);
}

/* One corner pulled through the opposite face. */
static void make_through_itself(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  s.point[7][0] = s.point[7][1] = 0.5;
  s.point[7][2] = -0.5;
  save_shape(file, &s);
}

static void make_touching_point(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  add_box(&s, 0, 1, 1, 0);
  for (int i = 8; i < 16; i++) {
    s.point[i][1] += 0.25;
    s.point[i][2] += 0.25;
  }
  save_shape(file, &s);
}

static void make_flat(const char *file)
{
  struct shape s = { 0 };
  int p[4];

  for (int i = 0; i < 4; i++) p[i] = add_point(&s, i & 1, i >> 1, 0);
  add_tri(&s, p[0], p[1], p[3]);
  add_tri(&s, p[0], p[3], p[2]);
  add_tri(&s, p[0], p[3], p[1]);
  add_tri(&s, p[0], p[2], p[3]);
  save_shape(file, &s);
}

static void make_line(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  for (int i = 0; i < 8; i++) s.point[i][1] = s.point[i][2] = s.point[i][0];
  save_shape(file, &s);
}

static void make_one_place(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 1, 1, 0, 0);
  save_shape(file, &s);
}

/* A corner in the middle of an edge of its own triangle. */
static void make_zero_area(const char *file)
{
  struct shape s = { 0 };
  int middle;

  add_box(&s, 0, 1, 0, 0);
  middle = add_point(&s, 0.5, 0.5, 0); /* on the diagonal 0 3 */
  s.tri[0][0] = middle;                /* 0 2 3 becomes middle 2 3 */
  add_tri(&s, 0, 2, middle);
  add_tri(&s, 0, middle, 3);
  save_shape(file, &s);
}

static void make_repeated_node(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  s.tri[3][1] = s.tri[3][0];
  save_shape(file, &s);
}

/* The projective plane on six points: every edge has two triangles, but the
 * surface cannot be oriented. */
static void make_one_sided(const char *file)
{
  static const int tri[10][3] = { { 1, 2, 3 }, { 1, 3, 4 }, { 1, 4, 5 },
                                  { 1, 5, 6 }, { 1, 2, 6 }, { 2, 3, 5 },
                                  { 3, 4, 6 }, { 4, 5, 2 }, { 5, 6, 3 },
                                  { 6, 2, 4 } };
  static const double at[6][3] = { { 0, 0, 2 },       { 2, 0, 0.1 },
                                   { 0.5, 2, 0.2 },   { -1.5, 1, 0.3 },
                                   { -1, -1.5, 0.4 }, { 1, -2, 0.5 } };
  struct shape s = { 0 };

  for (int i = 0; i < 6; i++) add_point(&s, at[i][0], at[i][1], at[i][2]);
  for (int i = 0; i < 10; i++)
    add_tri(&s, tri[i][0] - 1, tri[i][1] - 1, tri[i][2] - 1);
  save_shape(file, &s);
}

static void make_far_away(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, -1e300, 1e300, 0, 0);
  save_shape(file, &s);
}

static void make_tiny(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 5e-324, 0, 0);
  save_shape(file, &s);
}

static void make_small(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1e-30, 0, 0);
  save_shape(file, &s);
}

static void make_far(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, -1e30, 1e30, 0, 0);
  save_shape(file, &s);
}

/* --- surfaces that the check repairs ------------------------------------- */

/* The outer boundary points inward, as it should; the body in it wrongly points
 * inward, too. */
static void make_inside_out(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, -5, 5, 0, 1);
  add_box(&s, -1, 1, 0, 1);
  save_shape(file, &s);
}

/* Boundary, body, cavity in the body: every second one must be reversed. */
static void make_all_inward(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, -5, 5, 0, 1);
  add_box(&s, -3, 3, 0, 1);
  add_box(&s, -1, 1, 0, 1);
  save_shape(file, &s);
}

static void make_turned(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  for (int i = 0; i < 12; i += 5) {
    int t = s.tri[i][1];

    s.tri[i][1] = s.tri[i][2];
    s.tri[i][2] = t;
  }
  save_shape(file, &s);
}

static void make_doubled(const char *file)
{
  struct shape s = { 0 };

  add_box(&s, 0, 1, 0, 0);
  add_tri(&s, s.tri[4][0], s.tri[4][1], s.tri[4][2]);
  add_tri(&s, s.tri[4][1], s.tri[4][2], s.tri[4][0]);
  save_shape(file, &s);
}

static void make_unused(const char *file)
{
  struct shape s = { 0 };

  add_point(&s, 77, 77, 77);
  add_box(&s, 0, 1, 0, 0);
  save_shape(file, &s);
}

const struct hostile hostile_shapes[] = {
  { .file = "open.stl", .phrase = "open edge", .make = make_open },
  { .file = "single.stl", .phrase = "open edge", .make = make_single },
  { .file = "not_quite_closed.stl",
    .phrase = "except for rounding",
    .verdict = MENDED,
    .make = make_not_quite_closed },
  { .file = "common_edge.stl",
    .phrase = "non-manifold",
    .make = make_common_edge },
  { .file = "common_face.stl",
    .verdict = MENDED,
    .phrase = "4 triangles of walls shared by touching bodies removed",
    .make = make_common_face },
  { .file = "inner_wall.stl",
    .phrase = "non-manifold",
    .make = make_inner_wall },
  { .file = "crossing.tri",
    .verdict = MENDED,
    .phrase = "were united",
    .make = make_crossing },
  { .file = "through_itself.tri",
    .phrase = "intersection",
    .make = make_through_itself },
  { .file = "touching.tri",
    .verdict = MENDED,
    .phrase = "were united",
    .make = make_touching_point },
  { .file = "flat.tri", .phrase = "duplicate triangle", .make = make_flat },
  { .file = "line.tri", .phrase = "no surface is left", .make = make_line },
  { .file = "one_place.tri", .phrase = "degenerate", .make = make_one_place },
  { .file = "zero_area.tri", .phrase = "degenerate", .make = make_zero_area },
  { .file = "repeated_node.tri",
    .phrase = "open edge",
    .make = make_repeated_node },
  { .file = "one_sided.tri", .phrase = "orientation", .make = make_one_sided },
  { .file = "far_away.tri", .phrase = "beyond 1e+15", .make = make_far_away },
  { .file = "far.tri", .phrase = "beyond 1e+15", .make = make_far },
  { .file = "tiny.tri", .phrase = "smaller than 1e-45", .make = make_tiny },
  { .file = "small.tri", .phrase = "box of side 1e-30", .make = make_small },
  { .file = "inside_out.tri",
    .phrase = "reversed",
    .verdict = MENDED,
    .make = make_inside_out },
  { .file = "all_inward.tri",
    .phrase = "--flow internal",
    .verdict = REFUSED,
    .make = make_all_inward },
  { .file = "turned.tri",
    .phrase = "reversed",
    .verdict = MENDED,
    .make = make_turned },
  { .file = "doubled.tri",
    .phrase = "removed",
    .verdict = MENDED,
    .make = make_doubled },
  { .file = "unused.tri",
    .phrase = "accepts",
    .verdict = MENDED,
    .make = make_unused },
  { 0 }
};
