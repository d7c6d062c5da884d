/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The sizing field of metrics: maps, stretched sources, gradation, bounds of
 * the surface. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/geometry/tensor.h"
#include "core/sizing/sizing_octree.h"
#include "core/sizing/sizing_tensor.h"
#include "metric_support.h"

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

/* The box of a domain, the unit cube, without faces. */
static double corner[2][3] = { { 0, 0, 0 }, { 1, 1, 1 } };
static const struct vg_mesh box = { .n_point = 2, .point = corner };

static const double x_axis[3] = { 1, 0, 0 }, z_axis[3] = { 0, 0, 1 };

static double random_unit(uint64_t *state)
{
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*state >> 11) * 0x1p-53;
}

static void random_in(double x[3], uint64_t *state)
{
  for (int k = 0; k < 3; k++) x[k] = random_unit(state);
}

static struct vg_sizing *field(const struct vg_sizing_options *o, size_t n,
                               const struct vg_source *source,
                               const struct vg_mesh *surface)
{
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_sizing_new(o, n, source, surface, &s, &err) < 0)
    fail_msg("%s", err.text);
  assert_non_null(s);
  return s;
}

static struct vg_sizing *map_field(const struct vg_size_map *map, int threads)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  o.map = map;
  o.threads = threads;
  return field(&o, 0, NULL, &box);
}

/* Metric with the sizes h along r, t and z, r at the angle of (c, s). */
static void polar(double c, double s, const double h[3], double m[6])
{
  double a = 1 / (h[0] * h[0]), b = 1 / (h[1] * h[1]);

  m[0] = a * c * c + b * s * s;
  m[1] = (a - b) * c * s;
  m[3] = a * s * s + b * c * c;
  m[2] = m[4] = 0;
  m[5] = 1 / (h[2] * h[2]);
}

/* UGAWG's polar-2, scaled to a complexity of about 80,000. Inside the radius
 * 0.5, the tangential size stays. */
#define POLAR_SCALE 2

static void polar2(void *user, const double x[3], double m[6])
{
  double r = sqrt(x[0] * x[0] + x[1] * x[1]), h[3] = { 0, 0.1, 0.1 };
  double d = fmin(10 * (0.6 - r), 1);

  (void)user;
  h[0] = 0.001 + 0.198 * fabs(r - 0.5);
  if (d > 0) h[1] = d / 40 + (1 - d) / 10;
  for (int k = 0; k < 3; k++) h[k] /= POLAR_SCALE;
  polar(r > 0 ? x[0] / r : 1, r > 0 ? x[1] / r : 0, h, m);
}

/* Isotropic: 0.05 + 0.1 x. */
static void ramp(void *user, const double x[3], double m[6])
{
  (void)user;
  vg_tensor_uniform(1 / ((0.05 + 0.1 * x[0]) * (0.05 + 0.1 * x[0])), m);
}

static double ramp_size(void *user, const double x[3])
{
  (void)user;
  return 0.05 + 0.1 * x[0];
}

/* A jump from size 0.2 to a sheet of thickness 0.08 with sizes 0.2, 0.2, 0.04.
 * The sampling (H7) resolves it. */
static void sheet(void *user, const double x[3], double m[6])
{
  (void)user;
  vg_tensor_uniform(25, m);
  if (fabs(x[2] - 0.5) < 0.04) m[5] = 625;
}

static void nothing_below_half(void *user, const double x[3], double m[6])
{
  (void)user;
  vg_tensor_uniform(0, m);
  if (x[2] > 0.5) polar(1, 0, (const double[3]){ 0.05, 0.1, 0.1 }, m);
}

static void bad(void *user, const double x[3], double m[6])
{
  (void)user;
  vg_tensor_uniform(100, m);
  if (x[1] > 0.9) m[1] = 101;
}

static void is_not_a_number(void *user, const double x[3], double m[6])
{
  (void)user;
  vg_tensor_uniform(100, m);
  if (x[1] > 0.9) m[4] = NAN;
}

static double error_of(const struct vg_sizing *s, const struct vg_size_map *map,
                       const double x[3])
{
  double t[6], h[6], exact[6];

  vg_sizing_stretch_at(s, x, t);
  vg_tensor_invert(t, h);
  map->metric(map->user, x, exact);
  vg_tensor_root(exact, exact);
  vg_tensor_invert(exact, exact);
  return vg_size_error(h, exact);
}

static struct vg_sizing *benchmark; /* field of polar2, for several tests */

static int make_polar(void **state)
{
  const struct vg_size_map map = { .metric = polar2 };

  (void)state;
  benchmark = map_field(&map, 2);
  return 0;
}

static int free_polar(void **state)
{
  (void)state;
  vg_sizing_free(benchmark);
  return 0;
}

static void a_smooth_metric_is_reproduced(void **state)
{
  enum { N = 20000 };
  const struct vg_sizing *s = benchmark;
  const struct vg_size_map map = { .metric = polar2 };
  uint64_t seed = 1;
  int n = 0, rough = 0;
  double complexity = 0;

  (void)state;
  assert_true(vg_sizing_is_stretched(s));
  for (int i = 0; i < N; i++) {
    double x[3], e;

    random_in(x, &seed);
    e = error_of(s, &map, x);
    n += e < 0.05; /* H14 */
    /* Cells wider than the smallest size cross the kink at r = 0.5. Around the
     * z axis, the gradation lowers the metric, since it turns there. */
    rough += e > 0.3;
    complexity += pow(vg_sizing_at(s, x), -3) / N;
  }
  assert_true(n > 0.98 * N);
  assert_true(rough < 0.005 * N);
  assert_near(complexity / 80800, 1, 0.1);
}

static void sizes_along_axes_differ(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct vg_sizing *s = map_field(&map, 1);
  const double x[3] = { 0.3, 0.3, 0.5 }, y[3] = { 0.3, 0.3, 0.9 };
  double t[6], h;

  (void)state;
  assert_near(vg_sizing_along(s, x, x_axis), 0.2, 1e-3);
  assert_near(vg_sizing_along(s, x, z_axis), 0.04, 1e-4);
  h = vg_sizing_stretch_at(s, x, t);
  assert_near(h, vg_sizing_at(s, x), 1e-12);
  assert_near(h, pow(vg_tensor_det(t), -1.0 / 3), 1e-9);
  assert_near(vg_sizing_along(s, y, z_axis), 0.04 + 0.2 * 0.36, 8e-3);
  vg_sizing_free(s);
}

/* The jump at the sheet is graded: the size across it grows at the growth rate
 * of 1.2, up to the slack (H15) and interpolation. */
static void a_jump_is_graded(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct vg_sizing *s = map_field(&map, 1);

  (void)state;
  for (int i = 0; i <= 40; i++) {
    double d = 0.01 * i, h;

    h = vg_sizing_along(s, (double[3]){ 0.41, 0.37, 0.54 + d }, z_axis);
    assert_true(h <= 1.1 * fmin(0.2, 0.04 + 0.2 * d));
    assert_true(h >= 0.8 * fmin(0.2, 0.04 + 0.2 * d));
  }
  vg_sizing_free(s);
}

/* A metric that is isotropic everywhere gives the field of the same sizes, in
 * leaves without tensors. */
static void an_isotropic_metric_takes_no_tensors(void **state)
{
  const struct vg_size_map map = { .metric = ramp }, size = { .at = ramp_size };
  struct vg_sizing *s = map_field(&map, 1), *plain;
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  uint64_t seed = 2;

  (void)state;
  o.map = &size;
  o.h_max = 1;
  plain = field(&o, 0, NULL, &box);
  assert_int_equal(s->octree.n_tensor, 0);
  assert_false(vg_sizing_is_stretched(plain));
  for (int i = 0; i < 1000; i++) {
    double x[3], t[6];

    random_in(x, &seed);
    assert_near(vg_sizing_at(s, x) / vg_sizing_at(plain, x), 1, 0.03); /* H1 */
    vg_sizing_stretch_at(s, x, t);
    assert_near(t[0] * vg_sizing_at(s, x), 1, 1e-9);
    assert_true(t[1] == 0 && t[2] == 0 && t[4] == 0);
  }
  vg_sizing_free(s);
  vg_sizing_free(plain);
}

static void zero_requires_nothing(void **state)
{
  const struct vg_size_map map = { .metric = nothing_below_half };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s;

  (void)state;
  o.map = &map;
  o.h_max = 0.2;
  s = field(&o, 0, NULL, &box);
  assert_near(vg_sizing_along(s, (double[3]){ 0.4, 0.4, 0.8 }, x_axis), 0.05,
              1e-4);
  assert_near(vg_sizing_at(s, (double[3]){ 0.4, 0.4, 0.0 }), 0.15, 0.02);
  vg_sizing_free(s);
}

static void check_refused(const struct vg_sizing_options *o, size_t n,
                          const struct vg_source *source, const char *what)
{
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_sizing_new(o, n, source, &box, &s, &err), VG_ERR_INPUT);
  if (!strstr(err.text, what)) fail_msg("%s", err.text);
  assert_null(s);
}

static void bad_metrics_are_reported(void **state)
{
  struct vg_size_map map = { .metric = bad };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  (void)state;
  o.map = &map;
  check_refused(&o, 0, NULL, "is not positive: xx 100, xy 101");
  map.metric = is_not_a_number;
  check_refused(&o, 0, NULL, "yz nan");
  map.metric = sheet;
  o.aspect_max = 0.5;
  check_refused(&o, 0, NULL, "largest aspect 0.5");
}

/* 115 points outside the sheet, and 50 in it. */
static void excessive_requests_are_refused(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  (void)state;
  o.map = &map;
  o.most_points = 50;
  check_refused(&o, 0, NULL, "points, most of them near ");
  o.most_points = 1e6;
  vg_sizing_free(field(&o, 0, NULL, &box));
}

/* Small sizes stay, large ones are reduced. */
static void the_aspect_is_limited(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s;
  const double x[3] = { 0.3, 0.3, 0.5 };

  (void)state;
  o.map = &map;
  o.aspect_max = 2;
  s = field(&o, 0, NULL, &box);
  assert_near(vg_sizing_along(s, x, z_axis), 0.04, 5e-4);
  assert_near(vg_sizing_along(s, x, x_axis), 0.08, 1e-3);
  vg_sizing_free(s);
}

/* A stretched source has its sizes in its shape, and grows outside. Corners of
 * leaves are lowered by at most 5 % (H14, H16). */
static void sources_stretch(void **state)
{
  struct vg_source s[2] = { { .kind = VG_SOURCE_TRIANGLE,
                              .p0 = { -1, -1, 0.5 },
                              .p1 = { 3, -1, 0.5 },
                              .p2 = { -1, 3, 0.5 },
                              .h0 = 0.1,
                              .stretch = 0.05,
                              .u = { 0, 0, 2 } },
                            { .kind = VG_SOURCE_LINE,
                              .p0 = { 0, 0.5, 0.25 },
                              .p1 = { 1, 0.5, 0.25 },
                              .h0 = 0.01,
                              .h1 = 0.01,
                              .stretch = 10,
                              .u = { 1, 0, 0 } } };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *f;
  double h;

  (void)state;
  f = field(&o, 2, s, &box);
  h = vg_sizing_along(f, (double[3]){ 0.4, 0.2, 0.5 }, z_axis);
  assert_true(h > 0.0049 && h < 0.0065);
  h = vg_sizing_along(f, (double[3]){ 0.4, 0.2, 0.5 }, x_axis);
  assert_true(h > 0.095 && h < 0.11);
  h = vg_sizing_along(f, (double[3]){ 0.4, 0.2, 0.6 }, z_axis);
  assert_near(h, 0.025, 0.003);
  h = vg_sizing_along(f, (double[3]){ 0.4, 0.5, 0.25 }, z_axis);
  assert_true(h > 0.00949 && h < 0.0115);
  h = vg_sizing_along(f, (double[3]){ 0.4, 0.5, 0.25 }, x_axis);
  assert_true(h > 0.085 && h < 0.11);
  vg_sizing_free(f);
}

static void sources_without_a_direction_are_refused(void **state)
{
  struct vg_source s = {
    .kind = VG_SOURCE_POINT, .h0 = 0.1, .stretch = 10, .group = "shock"
  };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;

  (void)state;
  check_refused(&o, 1, &s,
                "source 1 (shock) at (0, 0, 0): its stretching "
                "direction");
  s.u[0] = NAN;
  check_refused(&o, 1, &s, "its stretching direction");
  s.stretch = -1;
  check_refused(&o, 1, &s, "its stretching is negative");
  s.kind = VG_SOURCE_VGRID_NODE;
  s.an = s.stretch = 1;
  check_refused(&o, 1, &s, "its stretching vector P");
  s.p[0] = 1;
  check_refused(&o, 1, &s, "its secondary spacing SP");
}

/* VGRID's stretched sources: the inverse-square mean of their size tensors. */
static void vgrid_sources_stretch(void **state)
{
  struct vg_source s[2] = {
    { .kind = VG_SOURCE_VGRID_NODE,
      .p0 = { 0, 0.5, 0.5 },
      .h0 = 0.1,
      .an = 1,
      .stretch = 1,
      .sp0 = 0.2,
      .p = { 0, 0, 3 } },
    { .kind = VG_SOURCE_VGRID_NODE, .p0 = { 1, 0.5, 0.5 }, .h0 = 0.1, .an = 1 }
  };
  const double mid[3] = { 0.5, 0.5, 0.5 };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *f;

  (void)state;
  f = field(&o, 2, s, &box);
  assert_near(vg_sizing_along(f, mid, x_axis), 0.1, 2e-3);
  assert_near(vg_sizing_along(f, mid, z_axis), 0.15, 5e-3);
  assert_near(vg_sizing_along(f, s[0].p0, z_axis), 0.2, 1e-2);
  assert_near(vg_sizing_along(f, s[1].p0, z_axis), 0.1, 5e-3);
  vg_sizing_free(f);
  s[0].stretch = 0;
  f = field(&o, 2, s, &box);
  assert_false(vg_sizing_is_stretched(f));
  vg_sizing_free(f);
}

/* Between the smallest size of a box and the values in it. */
static void the_least_size_in_a_box_is_found(void **state)
{
  const struct vg_sizing *s = benchmark;
  uint64_t seed = 4;
  double range[2], at[3];

  (void)state;
  vg_sizing_range(s, &range[0], &range[1]);
  assert_near(vg_sizing_least(s, (const double[3]){ 0, 0, 0 }, 1, at), range[0],
              1e-3 * range[0]);
  for (int i = 0; i < 200; i++) {
    double lo[3], side = 0.1 * random_unit(&seed), least, x[3];

    random_in(lo, &seed);
    least = vg_sizing_least(s, lo, side, at);
    assert_true(vg_sizing_bound(s, lo, side) <= (1 + 1e-6) * least);
    for (int k = 0; k < 3; k++)
      assert_true(lo[k] + side >= 1 ||
                  (at[k] >= lo[k] - 1e-9 && at[k] <= lo[k] + side + 1e-9));
    assert_near(vg_sizing_at(s, at) / least, 1, 1e-5);
    for (int j = 0; j < 50; j++) {
      double h;

      random_in(x, &seed);
      for (int k = 0; k < 3; k++) x[k] = fmin(lo[k] + side * x[k], 1);
      h = vg_sizing_at(s, x);
      assert_true(h >= least * (1 - 1e-5));
      assert_true(h <= range[1] * (1 + 1e-6));
    }
  }
}

static void sizes_grow_outside(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct vg_sizing *s = map_field(&map, 1);
  const double edge[3] = { 1.0005, 0.5, 0.9 }, far[3] = { 2.0005, 0.5, 0.9 };
  double hx = vg_sizing_along(s, edge, x_axis), at[3];
  double hz = vg_sizing_along(s, edge, z_axis);

  (void)state;
  assert_true(hz < 0.7 * hx);
  /* The law of vg_size_grow over a distance of 1 along x. */
  assert_near(vg_sizing_along(s, far, z_axis),
              hz * (1 + 0.875 * 0.2 / hx) + 0.125 * 0.2, 1e-3);
  assert_true(vg_sizing_least(s, far, 0.1, at) <= vg_sizing_at(s, far));
  vg_sizing_free(s);
}

static void a_coarser_field_keeps_its_aspect(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct vg_sizing *s = map_field(&map, 1), *limit, *to = NULL;
  struct vg_source point = { .kind = VG_SOURCE_POINT, .h0 = 0.3, .r0 = 10 };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  const double x[3] = { 0.3, 0.3, 0.5 };

  (void)state;
  limit = field(&o, 1, &point, &box);
  assert_int_equal(vg_sizing_coarsened(s, 2, limit, &to, NULL), VG_OK);
  assert_near(vg_sizing_along(to, x, z_axis) / vg_sizing_along(s, x, z_axis), 2,
              1e-5);
  assert_near(vg_sizing_along(to, x, x_axis), 0.3, 2e-3);
  vg_sizing_free(s);
  vg_sizing_free(limit);
  vg_sizing_free(to);
}

static void bytes_do_not_depend_on_threads(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct field_digest d[3];

  (void)state;
  for (int i = 0; i < 3; i++) {
    struct vg_sizing *s = map_field(&map, 1 + 2 * i);

    d[i] = field_digest(s);
    vg_sizing_free(s);
  }
  assert_true(d[0].n > 1000000);
  assert_true(d[0].n == d[1].n && d[0].sum == d[1].sum);
  assert_true(d[0].n == d[2].n && d[0].sum == d[2].sum);
}

/* Two triangles of size 0.1 at z = 0, 100 of them along each side. */
static void make_floor(struct vg_mesh *m, uint32_t n)
{
  m->point = calloc((n + 1) * (n + 1), sizeof *m->point);
  m->tri = calloc(2 * n * n, sizeof *m->tri);
  assert_true(m->point && m->tri);
  for (uint32_t j = 0; j <= n; j++)
    for (uint32_t i = 0; i <= n; i++) {
      m->point[m->n_point][0] = (double)i / n;
      m->point[m->n_point++][1] = (double)j / n;
    }
  for (uint32_t j = 0; j < n; j++)
    for (uint32_t i = 0; i < n; i++) {
      uint32_t at = j * (n + 1) + i;
      uint32_t t[2][3] = { { at, at + 1, at + n + 2 },
                           { at, at + n + 2, at + n + 1 } };

      memcpy(m->tri[m->n_tri++], t[0], sizeof t[0]);
      memcpy(m->tri[m->n_tri++], t[1], sizeof t[1]);
    }
}

/* A surface with edges of 0.05 that knows nothing of a thin sheet through it:
 * the sizes at the surface are those of its edges. */
static void the_surface_keeps_its_sizes(void **state)
{
  struct vg_source s = { .kind = VG_SOURCE_TRIANGLE,
                         .p0 = { 0.5, -3, -3 },
                         .p1 = { 0.5, 3, -3 },
                         .p2 = { 0.5, 0, 6 },
                         .h0 = 0.1,
                         .stretch = 0.01,
                         .u = { 1, 0, 0 } };
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_sizing *f;

  (void)state;
  make_floor(&m, 20);
  f = field(&o, 1, &s, &m);
  assert_near(vg_sizing_along(f, (double[3]){ 0.5, 0.5, 0 }, x_axis), 0.055,
              0.015);
  assert_near(vg_sizing_along(f, (double[3]){ 0.5, 0.5, 0 }, z_axis), 0.055,
              0.015);
  assert_true(vg_sizing_along(f, (double[3]){ 0.5, 0.5, 0.4 }, x_axis) < 0.002);
  vg_sizing_free(f);
  o.from_surface = 0;
  f = field(&o, 1, &s, &m);
  assert_true(vg_sizing_along(f, (double[3]){ 0.5, 0.5, 0 }, x_axis) < 0.002);
  vg_sizing_free(f);
  vg_mesh_release(&m);
}

static void random_way(double n[3], uint64_t *state)
{
  double size = 0;

  while (!(size > 0.01 && size < 1)) {
    random_in(n, state);
    for (int k = 0; k < 3; k++) n[k] = 2 * n[k] - 1;
    size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  }
  for (int k = 0; k < 3; k++) n[k] /= size;
}

/* A random box in the unit cube, with sides up to `side`; flat in z if is_flat.
 */
static void random_box(double side, int is_flat, double lo[3], double hi[3],
                       uint64_t *state)
{
  random_in(lo, state);
  for (int k = 0; k < 3; k++) {
    double to = lo[k] + side * random_unit(state);

    hi[k] = k == 2 && is_flat ? lo[k] : fmin(to, 1);
  }
}

/* Bounds across random planes in a box hold at points of the box. Returns
 * the ratio of the bounds. */
static double bounds_hold(const struct vg_sizing *s, const double lo[3],
                          const double hi[3], uint64_t *state)
{
  double way[4][3], least[4], most[4], ratio = 1;

  for (int i = 0; i < 4; i++) random_way(way[i], state);
  vg_sizing_bounds_across(s, lo, hi, 4, (const double(*)[3])way, least, most);
  for (int j = 0; j < 20; j++) {
    double x[3];

    random_in(x, state);
    for (int k = 0; k < 3; k++) x[k] = lo[k] + x[k] * (hi[k] - lo[k]);
    for (int i = 0; i < 4; i++) {
      double h = vg_sizing_across(s, x, way[i]);

      assert_true(h >= least[i] && h <= most[i]);
    }
  }
  for (int i = 0; i < 4; i++) ratio = fmax(ratio, most[i] / least[i]);
  return ratio;
}

/* In the sheet, a box far from the jump has nearly constant sizes: bounds from
 * its own octants have a ratio close to 1. In the polar metric, of aspect 100,
 * axes turn by up to half an edge per edge, so that bounds are wider. */
static void bounds_in_boxes_hold(void **state)
{
  const struct vg_size_map map = { .metric = sheet };
  struct vg_sizing *s = map_field(&map, 1), *coarse;
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  const double lo[3] = { 0.3, 0.3, 0.5 }, hi[3] = { 0.31, 0.32, 0.5 };
  struct vg_source wide = { .kind = VG_SOURCE_POINT, .h0 = 0.1 };
  struct vg_sizing *most = field(&o, 1, &wide, &box);
  uint64_t seed = 7;
  int n_narrow = 0;

  (void)state;
  assert_int_equal(vg_sizing_coarsened(benchmark, 2, most, &coarse, NULL),
                   VG_OK);
  assert_true(bounds_hold(s, lo, hi, &seed) < 1.02);
  for (int i = 0; i < 4000; i++) {
    double side = pow(0.5, i % 10), a[3], b[3];

    random_box(side, i & 1, a, b, &seed);
    bounds_hold(s, a, b, &seed);
    bounds_hold(coarse, a, b, &seed);
    if (bounds_hold(benchmark, a, b, &seed) < 3 && side < 0.02) n_narrow++;
  }
  assert_true(n_narrow > 4000 * 3 / 10);
  vg_sizing_free(coarse);
  vg_sizing_free(most);
  vg_sizing_free(s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_smooth_metric_is_reproduced),
    cmocka_unit_test(sizes_along_axes_differ),
    cmocka_unit_test(a_jump_is_graded),
    cmocka_unit_test(an_isotropic_metric_takes_no_tensors),
    cmocka_unit_test(zero_requires_nothing),
    cmocka_unit_test(bad_metrics_are_reported),
    cmocka_unit_test(the_aspect_is_limited),
    cmocka_unit_test(sources_stretch),
    cmocka_unit_test(excessive_requests_are_refused),
    cmocka_unit_test(sources_without_a_direction_are_refused),
    cmocka_unit_test(vgrid_sources_stretch),
    cmocka_unit_test(the_least_size_in_a_box_is_found),
    cmocka_unit_test(sizes_grow_outside),
    cmocka_unit_test(a_coarser_field_keeps_its_aspect),
    cmocka_unit_test(bytes_do_not_depend_on_threads),
    cmocka_unit_test(the_surface_keeps_its_sizes),
    cmocka_unit_test(bounds_in_boxes_hold),
  };

  return cmocka_run_group_tests(tests, make_polar, free_polar);
}
