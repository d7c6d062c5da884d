/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The sizing field: laws of the sources, and the octree that caches them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/sizing/sizing_octree.h"

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static const struct vg_sizing_options plain = VG_SIZING_OPTIONS_INIT;

static double random_unit(uint64_t *state)
{
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*state >> 11) * 0x1p-53;
}

static void random_in(double x[3], double radius, uint64_t *state)
{
  for (int k = 0; k < 3; k++) x[k] = radius * (2 * random_unit(state) - 1);
}

/* Appends an octahedron whose faces are divided into n^2 equilateral triangles:
 * every edge has the length sqrt(2) radius / n. Faces do not share points. */
static void add_octahedron(struct vg_mesh *m, const double centre[3],
                           double radius, int n)
{
  size_t n_point = m->n_point + 8 * (size_t)((n + 1) * (n + 2) / 2);
  size_t n_tri = m->n_tri + 8 * (size_t)(n * n);

  m->point = realloc(m->point, n_point * sizeof *m->point);
  m->tri = realloc(m->tri, n_tri * sizeof *m->tri);
  assert_true(m->point && m->tri);
  for (int f = 0; f < 8; f++) {
    uint32_t row = (uint32_t)m->n_point;

    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n - j; i++) {
        double *p = m->point[m->n_point++];

        p[0] = centre[0] + (f & 1 ? 1 : -1) * radius * i / n;
        p[1] = centre[1] + (f & 2 ? 1 : -1) * radius * j / n;
        p[2] = centre[2] + (f & 4 ? 1 : -1) * radius * (n - i - j) / n;
      }
    for (int j = 0; j < n; j++) {
      uint32_t next = row + (uint32_t)(n - j + 1);

      for (uint32_t i = 0; i < (uint32_t)(n - j); i++) {
        uint32_t up[3] = { row + i, row + i + 1, next + i };
        uint32_t down[3] = { row + i + 1, next + i + 1, next + i };

        memcpy(m->tri[m->n_tri++], up, sizeof up);
        if (i + 1 < (uint32_t)(n - j))
          memcpy(m->tri[m->n_tri++], down, sizeof down);
      }
      row = next;
    }
  }
}

static const double origin[3] = { 0, 0, 0 };

static struct vg_sizing *field(const struct vg_sizing_options *o, size_t n,
                               const struct vg_source *source,
                               const struct vg_mesh *surface)
{
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_sizing_new(o, n, source, surface, &s, &err), VG_OK);
  assert_non_null(s);
  return s;
}

static struct vg_source node(double x, double y, double z, double h)
{
  struct vg_source s = {
    .kind = VG_SOURCE_VGRID_NODE, .p0 = { x, y, z }, .h0 = h, .an = 1
  };

  return s;
}

/* The sources of VGRID's example SIMPLE_BOX. */
static void box_sources(struct vg_source s[8])
{
  for (int i = 0; i < 8; i++)
    s[i] = node(i & 1 ? 10 : -10, i & 2 ? 10 : -10, i & 4 ? 10 : -10,
                i & 2 ? 2 : 1);
}

/* formats.md 1.7: VGRID's own steps along two edges of that box, to the four
 * digits printed. */
static void vgrid_nodes_march_as_vgrid_does(void **state)
{
  static const double low[4] = { 1.0058, 1.0229, 1.0494, 1.0824 };
  static const double high[8] = { 2,      1.9772, 1.9209, 1.8595,
                                  1.8146, 1.7949, 1.8018, 1.8343 };
  struct vg_source s[8];
  double x[3] = { -10, -10, -10 };

  (void)state;
  box_sources(s);
  x[0] += vg_sizing_sources_at(&plain, 8, s, x);
  assert_near(x[0], -9, 1e-15);
  for (int i = 0; i < 4; i++) {
    double h = vg_sizing_sources_at(&plain, 8, s, x);

    assert_near(h, low[i], 0.5e-4);
    x[0] += h;
  }
  x[0] = -10;
  x[1] = 10;
  for (int i = 0; i < 8; i++) {
    double h = vg_sizing_sources_at(&plain, 8, s, x);

    assert_near(h, high[i], 0.5e-4);
    x[0] += h;
  }
}

static void vgrid_weights_multiply(void **state)
{
  struct vg_source s[2] = { node(0, 0, 0, 1), node(3, 0, 0, 4) };
  struct vg_sizing_options twice = plain;
  const double x[3] = { 1, 0, 0 };

  (void)state;
  s[1].an = 8;
  twice.scale = 2;
  /* weights 1 / 1 and 8 / 4 */
  assert_near(vg_sizing_sources_at(&plain, 2, s, x), 3, 1e-14);
  assert_near(vg_sizing_sources_at(&twice, 2, s, x), 6, 1e-14);
  twice.h_max = 2.5; /* times scale, too */
  assert_near(vg_sizing_sources_at(&twice, 2, s, x), 5, 0);
}

/* With scale 0.5 all sizes are halved: at the sources, between them, and where
 * a source grows at its own rate; within the error of the octree, 5 %. */
static void scale_makes_a_similar_field(void **state)
{
  struct vg_source s[2] = {
    { .kind = VG_SOURCE_POINT, .h0 = 0.1, .r0 = 0.5, .an = 1 },
    { .kind = VG_SOURCE_SPHERE,
      .p0 = { 8, 0, 0 },
      .h0 = 0.3,
      .r0 = 0.5,
      .growth = 1.4,
      .an = 1 }
  };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *f[2];
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  o.h_max = 0.8;
  o.h_min = 0.12;
  for (int i = 0; i < 2; i++) {
    o.scale = i ? 0.5 : 1;
    assert_int_equal(vg_sizing_new(&o, 2, s, NULL, &f[i], &err), VG_OK);
  }
  for (int i = 0; i <= 40; i++) {
    const double x[3] = { -1 + 0.25 * i, 0.1 * (i % 7), 0.2 * (i % 3) };

    assert_float_equal(vg_sizing_at(f[1], x) / vg_sizing_at(f[0], x), 0.5,
                       0.025);
  }
  assert_float_equal(vg_sizing_growth(f[1]), 0.1, 1e-15);
  vg_sizing_free(f[0]);
  vg_sizing_free(f[1]);
}

/* The closed form compared with the midpoint rule, whose error is 1e-8 here. */
static void vgrid_lines_integrate_the_kernel(void **state)
{
  static const double at[5][3] = { { 0.3, 0.2, 0.1 },
                                   { -2, 0, 0 },
                                   { 5, 1e-9, 0 },
                                   { 1.4, 0.9, -7 },
                                   { 300, 200, 100 } };
  struct vg_source s[2] = { node(0, 0, 1, 5), node(0, 0, 0, 1) };
  const int n = 20000;

  (void)state;
  s[0].an = 0.7;
  s[1].kind = VG_SOURCE_VGRID_LINE;
  s[1].p1[0] = 2;
  s[1].p1[1] = 1;
  s[1].h1 = 3;
  s[1].an = 1.5;
  for (int k = 0; k < 5; k++) {
    const double *x = at[k];
    double w = 0.7 / (x[0] * x[0] + x[1] * x[1] + (x[2] - 1) * (x[2] - 1));
    double top = 5 * w, bottom = w;

    for (int i = 0; i < n; i++) {
      double t = (i + 0.5) / n, u = x[0] - 2 * t, v = x[1] - t;

      w = 1.5 / n / (u * u + v * v + x[2] * x[2]);
      top += w * (1 + 2 * t);
      bottom += w;
    }
    assert_near(vg_sizing_sources_at(&plain, 2, s, x), top / bottom, 2e-7);
  }
  /* on the line its own spacing, at an end that of the end */
  assert_near(vg_sizing_sources_at(&plain, 2, s, (double[3]){ 1, 0.5, 0 }), 2,
              1e-9);
  assert_near(vg_sizing_sources_at(&plain, 2, s, s[1].p1), 3, 1e-9);
}

static double one(const struct vg_source *s, double x, double y, double z)
{
  const double at[3] = { x, y, z };

  return vg_sizing_sources_at(&plain, 1, s, at);
}

static void bounded_sources_grow_from_their_shapes(void **state)
{
  struct vg_source s = {
    .kind = VG_SOURCE_POINT, .p0 = { 1, 0, 0 }, .h0 = 0.1, .r0 = 2
  };

  (void)state;
  assert_near(one(&s, 2, 1, 0), 0.1, 0);
  assert_near(one(&s, 1, 5, 0), 0.1 + 0.2 * 3, 1e-15);
  s.growth = 1.5;
  assert_near(one(&s, 1, 5, 0), 0.1 + 0.5 * 3, 1e-15);
  s.kind = VG_SOURCE_SPHERE;
  assert_near(one(&s, 1, 0, -5), 0.1 + 0.5 * 3, 1e-15);

  s = (struct vg_source){
    .kind = VG_SOURCE_LINE, .p1 = { 4, 0, 0 }, .h0 = 1, .h1 = 2, .r0 = 0.5
  };
  assert_near(one(&s, 1, 0.4, 0), 1.25, 1e-15);
  assert_near(one(&s, 2, 0, 1.5), 1.5 + 0.2, 1e-15);
  assert_near(one(&s, 7, 4, 0), 2 + 0.2 * 4.5, 1e-15);

  s = (struct vg_source){
    .kind = VG_SOURCE_TRIANGLE, .p1 = { 3, 0, 0 }, .p2 = { 0, 3, 0 }, .h0 = 1
  };
  assert_near(one(&s, 1, 1, -2), 1.4, 1e-15);
  assert_near(one(&s, -3, 1, 4), 2, 1e-15);
  assert_near(one(&s, 3, 3, 0), 1 + 0.2 * 1.5 * sqrt(2), 1e-15);
  assert_near(one(&s, 6, -4, 0), 2, 1e-15);

  s = (struct vg_source){
    .kind = VG_SOURCE_BOX, .p0 = { 1, 1, 1 }, .p1 = { -1, -1, 0 }, .h0 = 1
  };
  assert_near(one(&s, 0.9, -0.9, 0.5), 1, 0);
  assert_near(one(&s, 4, 5, 0.5), 2, 1e-15);
}

static void cones_grow_from_side_and_caps(void **state)
{
  struct vg_source s = { .kind = VG_SOURCE_CYLINDER,
                         .p1 = { 0, 0, 4 },
                         .h0 = 1,
                         .h1 = 3,
                         .r0 = 2,
                         .r1 = 5 };

  (void)state;
  assert_near(one(&s, 0, 3, 2), 2, 1e-15);            /* inside, half way up */
  assert_near(one(&s, 1, 0, -3), 1 + 0.2 * 3, 1e-15); /* below the disc */
  assert_near(one(&s, 0, 0, 9), 3 + 0.2 * 5, 1e-15);
  /* the side runs from (0, 2) to (4, 5): normal (-3, 4) / 5; one from the
   * middle (2, 3.5) outwards, where the foot on the axis is at 1.4 of 4 */
  assert_near(one(&s, 4.3, 0, 1.4), 1 + 2 * 0.35 + 0.2, 1e-14);
  s.r1 = 2;
  assert_near(one(&s, 0, -5, 1), 1.5 + 0.2 * 3, 1e-15);
}

/* A boundary of uniform size gives that size everywhere, in a tiny tree. The
 * size is stored as a float: a relative error of 1e-7. */
static void a_uniform_surface_gives_one_size(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing *s;
  uint64_t seed = 1;
  double x[3];

  (void)state;
  add_octahedron(&m, origin, 1, 100);
  s = field(&plain, 0, NULL, &m);
  for (int i = 0; i < 10000; i++) {
    random_in(x, 1, &seed);
    assert_near(vg_sizing_at(s, x), sqrt(2) / 100, 1e-7);
  }
  assert_true(vg_sizing_leaves(s) <= 8);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

/* Above the middle of a face size and distance are known. */
static void sizes_grow_away_from_the_surface(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing *s;
  const double h = sqrt(2) / 20;

  (void)state;
  add_octahedron(&m, origin, 1, 20);
  add_octahedron(&m, origin, 100, 8);
  s = field(&plain, 0, NULL, &m);
  for (double d = 0; d < 30; d = d * 1.3 + 0.01) {
    double c = 1.0 / 3 + d / sqrt(3), x[3] = { c, c, c };

    /* plateau and interpolation, each 5 % of the surface's size at most */
    assert_near(vg_sizing_at(s, x), h + 0.2 * d,
                0.05 * (h + 0.2 * d) + 0.05 * h);
  }
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

static void two_sizes(struct vg_mesh *m)
{
  const double off[3] = { 0.31, -0.17, 0.08 };

  add_octahedron(m, off, 1, 24);
  add_octahedron(m, origin, 12, 9);
}

static void gradients_are_bounded(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_source source[4] = { node(3, 0, 0, 0.02),
                                 node(-3, 1, 0, 2),
                                 { .kind = VG_SOURCE_LINE,
                                   .p0 = { -2, 4, 3 },
                                   .p1 = { 1, 4, 3 },
                                   .h0 = 0.05,
                                   .h1 = 1,
                                   .growth = 2 },
                                 { .kind = VG_SOURCE_BOX,
                                   .p0 = { 2, 2, 2 },
                                   .p1 = { 3, 3, 2.1 },
                                   .h0 = 0.1,
                                   .growth = 1.1 } };
  uint64_t seed = 1;
  int beyond = 0;
  const int n = 200000;

  (void)state;
  two_sizes(&m);
  for (int with = 0; with < 2; with++) {
    struct vg_sizing *s = field(&plain, with ? 4 : 0, source, &m);

    for (int i = 0; i < n; i++) {
      double x[3], y[3], d = 0, h, g;

      random_in(x, 6, &seed);
      h = vg_sizing_at(s, x);
      random_in(y, 2 * h, &seed);
      for (int k = 0; k < 3; k++) {
        d += y[k] * y[k];
        y[k] += x[k];
      }
      g = fabs(vg_sizing_at(s, y) - h) / (vg_sizing_slope(s) * sqrt(d));
      beyond += g > 1.1;
      /* along the edges of a leaf at most 1, within it at most sqrt(3) */
      assert_true(g < 1.75);
    }
    vg_sizing_free(s);
  }
  assert_true(beyond < 2 * n / 500);
  vg_mesh_release(&m);
}

/* Values just before and just after planes in which leaves of all sizes meet
 * differ only by the gradient and the rounding of single precision. */
static void leaves_join_continuously(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_source source = { .kind = VG_SOURCE_POINT,
                              .p0 = { 5, 1, -2 },
                              .h0 = 0.01 };
  struct vg_sizing *s;
  uint64_t seed = 1;
  double lo[3], side;

  (void)state;
  two_sizes(&m);
  s = field(&plain, 1, &source, &m);
  memcpy(lo, s->octree.lo, sizeof lo);
  side = s->octree.side;
  for (int i = 0; i < 300000; i++) {
    double x[3], a, b;
    int k = i % 3, cuts = 4 << i / 3 % 8;

    random_in(x, 6, &seed);
    x[k] = lo[k] + side * floor(cuts * (x[k] - lo[k]) / side) / cuts - 1e-9;
    a = vg_sizing_at(s, x);
    x[k] += 2e-9;
    b = vg_sizing_at(s, x);
    assert_near(a, b, 2e-9 + 1e-6 * a);
  }
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

/* The gradient is that of the interpolation: differences over a step that
 * stays within a leaf agree with it. */
static void gradients_are_those_of_the_values(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_source source = node(3, 0, 0, 0.02);
  struct vg_sizing *s;
  uint64_t seed = 3;
  int n_off = 0, n_steep = 0;

  (void)state;
  two_sizes(&m);
  s = field(&plain, 1, &source, &m);
  for (int i = 0; i < 30000; i++) {
    double x[3], g[3], step = 1e-6;

    random_in(x, 6, &seed);
    vg_sizing_gradient_at(s, x, g);
    for (int k = 0; k < 3; k++) {
      double up[3] = { x[0], x[1], x[2] }, down[3] = { x[0], x[1], x[2] }, d;

      up[k] += step;
      down[k] -= step;
      d = (vg_sizing_at(s, up) - vg_sizing_at(s, down)) / (2 * step);
      n_off += fabs(d - g[k]) > 1e-6;
      n_steep += fabs(d) > 0.05;
    }
  }
  assert_true(n_off < 30); /* steps across the border of a leaf */
  assert_true(n_steep > 10000);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

/* Without a surface the cache follows the law; the sources grow at the global
 * rate, so limiting the gradient changes nothing. */
static void the_cache_follows_the_law(void **state)
{
  const struct vg_source source[5] = {
    { .kind = VG_SOURCE_SPHERE, .p0 = { 0, 0, 0 }, .r0 = 1, .h0 = 0.1 },
    { .kind = VG_SOURCE_BOX,
      .p0 = { 3, 3, 3 },
      .p1 = { 5, 4, 3.5 },
      .h0 = 0.3 },
    { .kind = VG_SOURCE_TRIANGLE,
      .p0 = { -3, 0, 0 },
      .p1 = { -3, 4, 0 },
      .p2 = { -4, 2, 3 },
      .h0 = 0.2 },
    { .kind = VG_SOURCE_CYLINDER,
      .p0 = { 0, -5, 0 },
      .p1 = { 4, -5, 1 },
      .h0 = 0.2,
      .h1 = 0.2,
      .r0 = 0.5,
      .r1 = 1 },
    { .kind = VG_SOURCE_POINT, .p0 = { 1.7, 2.3, -4.1 }, .h0 = 0.001 }
  };
  struct vg_sizing_options o = plain;
  struct vg_sizing *s;
  uint64_t seed = 1;
  double sum = 0, x[3];
  const int n = 50000;

  (void)state;
  o.h_max = 3;
  s = field(&o, 5, source, NULL);
  for (int i = 0; i < n; i++) {
    double h, exact;

    random_in(x, 7, &seed);
    h = vg_sizing_at(s, x);
    exact = vg_sizing_sources_at(&o, 5, source, x);
    sum += fabs(h / exact - 1);
    assert_near(h, exact, 0.12 * exact); /* worst at the rim of a shape */
  }
  assert_true(sum / n < 0.02);
  /* at the tip of a cone a leaf is about as large as the size there */
  assert_near(vg_sizing_at(s, source[4].p0), 0.001, 0.00025);
  vg_sizing_free(s);
}

static void vgrid_sources_alone_define_a_field(void **state)
{
  struct vg_source source[8];
  struct vg_sizing *s;
  uint64_t seed = 1;
  double x[3];

  (void)state;
  box_sources(source);
  s = field(&plain, 8, source, NULL);
  for (int i = 0; i < 20000; i++) {
    random_in(x, 10, &seed);
    /* the gradient of this mean never exceeds the growth rate */
    assert_near(vg_sizing_at(s, x), vg_sizing_sources_at(&plain, 8, source, x),
                0.06);
  }
  vg_sizing_free(s);
}

/* A source that is finer than the boundary next to it: the boundary keeps its
 * size, and the sizes decrease from there at the growth rate. */
static void the_surface_prevails_on_itself(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_source source = {
    .kind = VG_SOURCE_SPHERE, .p0 = { 3, 3, 3 }, .r0 = 2, .h0 = 0.02
  };
  const double h = sqrt(2);
  struct vg_sizing *s;

  (void)state;
  add_octahedron(&m, origin, 10, 10);
  s = field(&plain, 1, &source, &m);
  for (double d = 0; d < 1.5 * h; d += 0.1) {
    double c = (10 - d * sqrt(3)) / 3, x[3] = { c, c, c };
    double left = h - 0.2 * d;

    assert_near(vg_sizing_at(s, x), left, 0.08 * h);
  }
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

/* Three lengths away from faces a source has its requested size; closer to the
 * faces the size first decreases at the growth rate, then by 0.5. */
static void sources_prevail_away_from_coarse_faces(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_source source = { .kind = VG_SOURCE_POINT, .h0 = 0.02 };
  const double h = sqrt(2);
  struct vg_sizing *s;

  (void)state;
  add_octahedron(&m, origin, 10, 10);
  s = field(&plain, 1, &source, &m);
  assert_near(vg_sizing_at(s, origin), 0.02, 0.005);
  for (double d = 0; d < 5.7; d += 0.1) {
    double r = 10 / sqrt(3) - d, c = r / sqrt(3), x[3] = { c, c, c };
    double left = fmin(h - 0.2 * d, 1.45 * h - 0.5 * d);

    assert_near(vg_sizing_at(s, x), fmax(left, 0.02 + 0.2 * r), 0.08 * h);
  }
  assert_near(vg_sizing_slope(s), 0.5, 1e-12);
  assert_near(vg_sizing_growth(s), 0.2, 1e-12);
  vg_sizing_free(s);
  source.h0 = 1;
  s = field(&plain, 1, &source, &m);
  assert_near(vg_sizing_slope(s), 0.2, 1e-12);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

static void sizes_may_span_five_decades(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  const double off[3] = { 1.3, 0.7, -2.1 };
  struct vg_sizing *s;
  double lo, hi, x[3];

  (void)state;
  add_octahedron(&m, off, 1e-3, 14);   /* edges 1.01e-4 */
  add_octahedron(&m, origin, 100, 14); /* edges 10.1 */
  s = field(&plain, 0, NULL, &m);
  vg_sizing_range(s, &lo, &hi);
  assert_near(lo, sqrt(2) * 1e-3 / 14, 2e-6);
  assert_near(hi, sqrt(2) * 100 / 14, 1e-5);
  for (double d = 1e-5; d < 20; d *= 2) {
    for (int k = 0; k < 3; k++) x[k] = off[k];
    for (int k = 0; k < 3; k++) x[k] += 1e-3 / 3 + d / sqrt(3);
    assert_near(vg_sizing_at(s, x) / (1.01e-4 + 0.2 * d), 1, 0.08);
  }
  assert_true(vg_sizing_leaves(s) < 8 * m.n_tri + 20000);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

/* Strips of 1 by 100: except at the strip's ends the size is about that of the
 * short edges at the corners, and grows along the long ones. */
static void stretched_faces_take_their_short_edges(void **state)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing *s;
  const uint32_t n = 60;

  (void)state;
  m.point = calloc(2 * n, sizeof *m.point);
  m.tri = calloc(2 * n, sizeof *m.tri);
  assert_true(m.point && m.tri);
  for (uint32_t i = 0; i < n; i++, m.n_point += 2) {
    m.point[2 * i][0] = m.point[2 * i + 1][0] = i;
    m.point[2 * i + 1][1] = 100;
    if (!i) continue;
    memcpy(m.tri[m.n_tri++], (uint32_t[3]){ 2 * i - 2, 2 * i, 2 * i - 1 }, 12);
    memcpy(m.tri[m.n_tri++], (uint32_t[3]){ 2 * i, 2 * i + 1, 2 * i - 1 }, 12);
  }
  o.h_max = 100;
  s = field(&o, 0, NULL, &m);
  assert_near(vg_sizing_at(s, (double[3]){ 30, 0, 0 }), 3, 0.5);
  assert_near(vg_sizing_at(s, (double[3]){ 30.5, 50, 0 }), 13, 1);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

static void options_clamp(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing_options o = plain;
  struct vg_sizing *s;
  double lo, hi, far[3] = { 100, 0, 0 };

  (void)state;
  two_sizes(&m);
  o.h_min = 0.1;
  o.h_max = 0.5;
  s = field(&o, 0, NULL, &m);
  vg_sizing_range(s, &lo, &hi);
  assert_near(lo, 0.1, 1e-7);
  assert_near(hi, 0.5, 1e-7);
  assert_near(vg_sizing_at(s, far), 0.5, 1e-7);
  vg_sizing_free(s);
  /* no limit outside the surface even if none is requested */
  s = field(&plain, 0, NULL, &m);
  vg_sizing_range(s, &lo, &hi);
  assert_near(hi, sqrt(2) * 12 / 9, 1e-6);
  assert_near(vg_sizing_at(s, far), sqrt(2) * 12 / 9 + 0.2 * 88, 0.2);
  vg_sizing_free(s);
  o = plain;
  o.h_max = INFINITY;
  s = field(&o, 0, NULL, &m);
  assert_near(vg_sizing_at(s, far), sqrt(2) * 12 / 9 + 0.2 * 88, 0.2);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

/* A source alone grows without limit, VGRID's mean stays below its largest. */
static void sources_alone_need_no_limit(void **state)
{
  struct vg_source s = { .kind = VG_SOURCE_POINT, .h0 = 0.1 }, box[8];
  const double x[3] = { 0.6, 0.8, 0 }, far[3] = { 0, 0, -500 };
  struct vg_sizing *one_point = field(&plain, 1, &s, NULL), *vgrid;

  (void)state;
  assert_near(vg_sizing_at(one_point, x), 0.3, 0.03 * 0.3);
  assert_near(vg_sizing_at(one_point, far), 100.1, 1);
  box_sources(box);
  vgrid = field(&plain, 8, box, NULL);
  assert_true(vg_sizing_at(vgrid, far) <= 2);
  vg_sizing_free(one_point);
  vg_sizing_free(vgrid);
}

static void the_same_input_gives_the_same_bytes(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_source source[9];
  struct vg_sizing *s[2];
  enum { N = 5000 };
  static double x[N][3], h[2][N];
  uint64_t seed = 1;

  (void)state;
  two_sizes(&m);
  box_sources(source);
  source[8] = (struct vg_source){
    .kind = VG_SOURCE_SPHERE, .r0 = 2, .p0 = { 4, 4, 1 }, .h0 = 0.1
  };
  for (int i = 0; i < N; i++) {
    random_in(x[i], 13, &seed);
    if (i % 3) /* near the point before */
      for (int k = 0; k < 3; k++) x[i][k] = x[i - 1][k] + 1e-3 * x[i][k];
  }
  for (int i = 0; i < 2; i++) {
    s[i] = field(&plain, 9, source, &m);
    vg_sizing_eval(s[i], N, (const double(*)[3])x, h[i]);
  }
  assert_memory_equal(h[0], h[1], sizeof h[0]);
  for (int i = 0; i < N; i++) assert_true(h[0][i] == vg_sizing_at(s[1], x[i]));
  vg_sizing_free(s[0]);
  vg_sizing_free(s[1]);
  vg_mesh_release(&m);
}

/* Some sources grow faster than the growth rate, so that all steps are
 * taken. */
static void busy_field(struct vg_mesh *m, struct vg_source source[9])
{
  const double centre[3] = { 3, -2, 1 };

  two_sizes(m);
  add_octahedron(m, centre, 0.5, 60);
  box_sources(source);
  source[7] = (struct vg_source){ .kind = VG_SOURCE_LINE,
                                  .p0 = { -5, 2, 1 },
                                  .p1 = { -4, 2, 1 },
                                  .h0 = 0.02,
                                  .h1 = 1,
                                  .growth = 1.9 };
  source[8] = (struct vg_source){
    .kind = VG_SOURCE_SPHERE, .r0 = 2, .p0 = { 4, 4, 1 }, .h0 = 0.1
  };
}

static void threads_give_the_same_bytes(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing_options o = plain;
  struct vg_source source[9];
  struct vg_sizing *s[3];

  (void)state;
  busy_field(&m, source);
  for (int i = 0; i < 3; i++) {
    o.threads = i + 1;
    s[i] = field(&o, 9, source, &m);
    assert_true(vg_sizing_leaves(s[i]) > 20000);
  }
  for (int i = 1; i < 3; i++) {
    const struct vg_octree *a = &s[0]->octree, *b = &s[i]->octree;

    assert_int_equal(a->n_split, b->n_split);
    assert_int_equal(a->n_leaf, b->n_leaf);
    assert_memory_equal(a->child, b->child, a->n_split * sizeof *a->child);
    assert_memory_equal(a->least, b->least, a->n_split * sizeof *a->least);
    assert_memory_equal(a->leaf, b->leaf, a->n_leaf * sizeof *a->leaf);
  }
  for (int i = 0; i < 3; i++) vg_sizing_free(s[i]);
  vg_mesh_release(&m);
}

/* No sample of a cube is below its minimum, which is the value of the field at
 * the reported position. Cubes outside the field have the value of its
 * border. */
static void the_least_of_a_cube_is_found(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_source source[9];
  struct vg_sizing *s;
  double most[2], all, at[3];
  uint64_t seed = 5;

  (void)state;
  busy_field(&m, source);
  s = field(&plain, 9, source, &m);
  for (int i = 0; i < 400; i++) {
    double lo[3], x[3], side = 30 * pow(0.5, i % 14), least;

    random_in(lo, i % 2 ? 4 : 12, &seed);
    least = vg_sizing_least(s, lo, side, at);
    assert_true(vg_sizing_bound(s, lo, side) <= (1 + 1e-6) * least);
    assert_true(vg_sizing_at(s, at) <= (1 + 1e-6) * least);
    if (i % 2) assert_near(vg_sizing_at(s, at), least, 1e-6 * least);
    for (int j = 0; j < 500; j++) {
      for (int k = 0; k < 3; k++) x[k] = lo[k] + side * random_unit(&seed);
      assert_true(vg_sizing_at(s, x) >= (1 - 1e-6) * least);
    }
  }
  vg_sizing_range(s, &most[0], &most[1]);
  for (int k = 0; k < 3; k++) at[k] = -1e3;
  all = vg_sizing_least(s, at, 2e3, at);
  assert_true(all <= most[0] && all >= most[0]);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

static void refused(const struct vg_sizing_options *o, size_t n,
                    const struct vg_source *source, const struct vg_mesh *m,
                    const char *word)
{
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_sizing_new(o, n, source, m, &s, &err), VG_ERR_INPUT);
  assert_null(s);
  assert_non_null(strstr(err.text, word));
}

static void bad_sources_are_named(void **state)
{
  const struct vg_source bad[] = {
    node(NAN, 0, 0, 1),
    node(0, 0, 0, 0),
    node(0, 0, 0, -1),
    node(0, 0, 0, INFINITY),
    { .kind = VG_SOURCE_VGRID_NODE, .h0 = 1, .an = 0 },
    { .kind = VG_SOURCE_VGRID_LINE, .h0 = 1, .an = 1, .h1 = 0 },
    { .kind = VG_SOURCE_LINE, .h0 = 1, .h1 = 1, .p1 = { 0, INFINITY, 0 } },
    { .kind = VG_SOURCE_TRIANGLE, .h0 = 1, .p2 = { NAN, 0, 0 } },
    { .kind = VG_SOURCE_POINT, .h0 = 1, .growth = 1 },
    { .kind = VG_SOURCE_POINT, .h0 = 1, .growth = NAN },
    { .kind = VG_SOURCE_SPHERE, .h0 = 1, .r0 = -1 },
    { .kind = VG_SOURCE_CYLINDER, .h0 = 1, .h1 = 1, .r0 = 1, .r1 = 1 },
    { .kind = (enum vg_source_kind)99, .h0 = 1, .an = 1 }
  };
  struct vg_source two[2] = { node(0, 0, 0, 1), node(0, 0, 0, 1) };

  (void)state;
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
    two[1] = bad[i];
    strcpy(two[1].group, "wake");
    refused(&plain, 2, two, NULL, "source 2 (wake)");
  }
}

static void bad_options_and_surfaces_are_refused(void **state)
{
  struct vg_source s = node(0, 0, 0, 1);
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing_options o = plain;

  (void)state;
  o.growth = 1;
  refused(&o, 1, &s, NULL, "growth");
  o = plain;
  o.scale = 0;
  refused(&o, 1, &s, NULL, "scale");
  o = plain;
  o.h_min = -1;
  refused(&o, 1, &s, NULL, "smallest");
  o.h_min = 2;
  o.h_max = 1;
  refused(&o, 1, &s, NULL, "largest");
  o.h_max = NAN;
  refused(&o, 1, &s, NULL, "largest");
  refused(&plain, 0, NULL, NULL, "nothing defines a size");
  add_octahedron(&m, origin, 1, 2);
  o = plain;
  o.from_surface = 0;
  refused(&o, 0, NULL, &m, "nothing defines a size");
  m.tri[5][1] = 1000;
  refused(&plain, 0, NULL, &m, "triangle 6");
  m.tri[5][1] = 0;
  m.point[7][2] = NAN;
  refused(&plain, 0, NULL, &m, "point 8");
  vg_mesh_release(&m);
  vg_sizing_free(NULL);
}

/* Faces without area or with a repeated point have no effect and do no harm. */
static void degenerate_faces_are_skipped(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing *s;

  (void)state;
  add_octahedron(&m, origin, 1, 4);
  m.tri[3][1] = m.tri[3][0];
  for (int k = 0; k < 3; k++) m.tri[9][k] = 20;
  s = field(&plain, 0, NULL, &m);
  assert_near(vg_sizing_at(s, origin), sqrt(2) / 4, 0.1);
  vg_sizing_free(s);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(vgrid_nodes_march_as_vgrid_does),
    cmocka_unit_test(vgrid_weights_multiply),
    cmocka_unit_test(scale_makes_a_similar_field),
    cmocka_unit_test(vgrid_lines_integrate_the_kernel),
    cmocka_unit_test(bounded_sources_grow_from_their_shapes),
    cmocka_unit_test(cones_grow_from_side_and_caps),
    cmocka_unit_test(a_uniform_surface_gives_one_size),
    cmocka_unit_test(sizes_grow_away_from_the_surface),
    cmocka_unit_test(gradients_are_bounded),
    cmocka_unit_test(leaves_join_continuously),
    cmocka_unit_test(gradients_are_those_of_the_values),
    cmocka_unit_test(the_cache_follows_the_law),
    cmocka_unit_test(vgrid_sources_alone_define_a_field),
    cmocka_unit_test(the_surface_prevails_on_itself),
    cmocka_unit_test(sources_prevail_away_from_coarse_faces),
    cmocka_unit_test(sizes_may_span_five_decades),
    cmocka_unit_test(stretched_faces_take_their_short_edges),
    cmocka_unit_test(options_clamp),
    cmocka_unit_test(sources_alone_need_no_limit),
    cmocka_unit_test(the_same_input_gives_the_same_bytes),
    cmocka_unit_test(threads_give_the_same_bytes),
    cmocka_unit_test(the_least_of_a_cube_is_found),
    cmocka_unit_test(bad_sources_are_named),
    cmocka_unit_test(bad_options_and_surfaces_are_refused),
    cmocka_unit_test(degenerate_faces_are_skipped)
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
