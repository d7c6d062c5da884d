/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Point placement in the isotropic region: distances that match the spacing, no
 * gaps, all points in the fluid, reproducible. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/fill/place.h"
#include "core/recover/boundary.h"
#include "fill_shapes.h"
#include "tets_support.h"

/* A surface, its coarse cells and its sizing field. */
struct scene {
  struct vg_mesh m;
  struct vg_tets t;
  struct vg_sizing *sizing;
};

static void scene_of(struct scene *s, double growth, double h_max)
{
  struct vg_boundary_report r;

  memset(&s->t, 0, sizeof s->t);
  s->sizing = shape_sizing(&s->m, growth, h_max);
  assert_int_equal(vg_boundary_tets(s->m.n_point,
                                    (const double(*)[3])s->m.point, s->m.n_tri,
                                    (const uint32_t(*)[3])s->m.tri, NULL, &s->t,
                                    &r, NULL),
                   VG_OK);
}

static void box_scene(struct scene *s, int n, double h_max)
{
  memset(&s->m, 0, sizeof s->m);
  shape_box(&s->m, n, 0.5);
  scene_of(s, 1.2, h_max);
}

static void sphere_scene(struct scene *s)
{
  const double centre[3] = { 0, 0, 0 };

  memset(&s->m, 0, sizeof s->m);
  shape_box(&s->m, 5, 4);
  shape_sphere(&s->m, 8, centre, 1, 7);
  scene_of(s, 1.3, 0);
}

static void scene_end(struct scene *s)
{
  vg_sizing_free(s->sizing);
  vg_tets_release(&s->t);
  vg_mesh_release(&s->m);
}

static double distance(const double a[3], const double b[3])
{
  return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
              (a[2] - b[2]) * (a[2] - b[2]));
}

static double nearest(size_t n, const double (*x)[3], const double at[3])
{
  double least = INFINITY;

  for (size_t i = 0; i < n; i++) {
    double d = distance(x[i], at);

    least = d < least ? d : least;
  }
  return least;
}

static int in_fluid(const struct vg_tets *t, const double x[3])
{
  uint32_t c = vg_tets_locate(t, 0, x);

  return c != VG_NONE && !(t->flag[c] & VG_OUTSIDE);
}

static struct vg_placed place(const struct scene *s,
                              const struct vg_region *region, size_t limit)
{
  struct vg_placed out = { 0 };

  assert_int_equal(vg_place(&s->t, s->sizing, region, limit, &out, NULL),
                   VG_OK);
  return out;
}

/* The least distance between points is 0.66 spacings, measured in single
 * precision; slightly less where the sizing field has a steep gradient, as it
 * is evaluated twice. */
static void keep_their_distance(const struct scene *s,
                                const struct vg_placed *p, double share)
{
  for (size_t i = 0; i < p->n; i++) {
    double h = vg_sizing_at(s->sizing, p->x[i]);

    assert_true(in_fluid(&s->t, p->x[i]));
    assert_true(nearest(i, (const double(*)[3])p->x, p->x[i]) > share * h);
    assert_true(nearest(s->m.n_point, (const double(*)[3])s->m.point, p->x[i]) >
                share * h);
  }
}

/* No point of the fluid is farther from all points than 1.1 spacings. In the
 * lattice the farthest position is at 0.61, and where fronts meet a gap that
 * could take one more point is at most 0.72 wide. */
static void leave_no_gap(const struct scene *s, const struct vg_placed *p,
                         const double lo[3], const double hi[3])
{
  uint64_t seed = 3;

  for (int i = 0; i < 1500; i++) {
    double x[3], a, b;

    for (int k = 0; k < 3; k++)
      x[k] = lo[k] + (hi[k] - lo[k]) * tets_random(&seed);
    if (!in_fluid(&s->t, x)) continue;
    a = nearest(p->n, (const double(*)[3])p->x, x);
    b = nearest(s->m.n_point, (const double(*)[3])s->m.point, x);
    assert_true((a < b ? a : b) < 1.1 * vg_sizing_at(s->sizing, x));
  }
}

static void a_uniform_field(void **state)
{
  const double lo[3] = { -0.5, -0.5, -0.5 }, hi[3] = { 0.5, 0.5, 0.5 };
  struct scene s;
  struct vg_placed p;

  (void)state;
  box_scene(&s, 8, 0.125);
  p = place(&s, NULL, 0);
  /* a body-centred lattice has sqrt(2) / h^3 points at the mean edge h */
  assert_in_range(p.n, 300, 1000);
  keep_their_distance(&s, &p, 0.65);
  leave_no_gap(&s, &p, lo, hi);
  vg_placed_release(&p);
  scene_end(&s);
}

static void a_graded_field(void **state)
{
  const double lo[3] = { -4, -4, -4 }, hi[3] = { 4, 4, 4 };
  struct scene s;
  struct vg_placed p;

  (void)state;
  sphere_scene(&s);
  p = place(&s, NULL, 0);
  assert_true(p.n > 200);
  keep_their_distance(&s, &p, 0.6);
  leave_no_gap(&s, &p, lo, hi);
  for (size_t i = 0; i < p.n; i++) {
    const double zero[3] = { 0, 0, 0 };

    assert_true(distance(p.x[i], zero) > 1); /* none in the body */
  }
  vg_placed_release(&p);
  scene_end(&s);
}

static void the_same_bytes_again(void **state)
{
  struct scene s;
  struct vg_placed p, q;

  (void)state;
  sphere_scene(&s);
  p = place(&s, NULL, 0);
  q = place(&s, NULL, 0);
  assert_int_equal(p.n, q.n);
  assert_memory_equal(p.x, q.x, p.n * sizeof *p.x);
  vg_placed_release(&p);
  vg_placed_release(&q);
  scene_end(&s);
}

static void the_limit_is_exact(void **state)
{
  struct scene s;
  struct vg_placed p, q, none = { 0 };
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  box_scene(&s, 6, 0.15);
  p = place(&s, NULL, 0);
  q = place(&s, NULL, p.n);
  assert_int_equal(p.n, q.n);
  assert_memory_equal(p.x, q.x, p.n * sizeof *p.x);
  assert_int_equal(vg_place(&s.t, s.sizing, NULL, p.n - 1, &none, &err),
                   VG_ERR_UNSUPPORTED);
  assert_true(strlen(err.text) > 10);
  assert_int_equal(none.n, 0);
  assert_null(none.x);
  assert_int_equal(vg_place(&s.t, s.sizing, NULL, 1, &none, &err),
                   VG_ERR_UNSUPPORTED);
  assert_null(none.x);
  vg_placed_release(&p);
  vg_placed_release(&q);
  scene_end(&s);
}

/* Existing points count: a second placement adds almost none. */
static void existing_points_count(void **state)
{
  struct scene s;
  struct vg_placed p, q;
  struct vg_inserter inserter;

  (void)state;
  box_scene(&s, 8, 0.125);
  p = place(&s, NULL, 0);
  assert_int_equal(vg_inserter_init(&inserter, &s.t, NULL), VG_OK);
  for (size_t i = 0; i < p.n; i++)
    assert_int_equal(tets_insert(&inserter, p.x[i], 0, 0), VG_OK);
  q = place(&s, NULL, 0);
  assert_true(q.n <= p.n / 20);
  vg_inserter_release(&inserter);
  vg_placed_release(&p);
  vg_placed_release(&q);
  scene_end(&s);
}

/* --- regions ------------------------------------------------------------- */

static void a_slab_gets_only_its_own_points(void **state)
{
  const struct vg_region zone = { .n_plane = 1,
                                  .plane = { { { 0, 0, 1 }, 0.1 } } };
  const double lo[3] = { -0.5, -0.5, 0.0 }, hi[3] = { 0.5, 0.5, 0.2 };
  struct scene s;
  struct vg_placed p, all;

  (void)state;
  box_scene(&s, 16, 0.0625);
  all = place(&s, NULL, 0);
  p = place(&s, &zone, 0);
  assert_true(p.n > all.n / 8 && p.n < all.n / 2);
  for (size_t i = 0; i < p.n; i++)
    assert_true(vg_region_near(&zone, s.sizing, p.x[i], VG_BAND_PLACE));
  keep_their_distance(&s, &p, 0.65);
  leave_no_gap(&s, &p, lo, hi);
  vg_placed_release(&p);
  vg_placed_release(&all);
  scene_end(&s);
}

/* The least distance, over the spacing, of a point from the points before it.
 * Only points that the front does not propose count, which are farther from it
 * than 1.6 spacings. */
static double least_within(const struct scene *s,
                           const struct vg_region *region)
{
  struct vg_placed p = place(s, region, 0);
  const double(*x)[3] = (const double(*)[3])p.x;
  const double(*front)[3] = (const double(*)[3])s->m.point;
  double least = INFINITY;
  size_t n = 0;

  for (size_t i = 0; i < p.n; i++) {
    double h = vg_sizing_at(s->sizing, x[i]);

    if (nearest(s->m.n_point, front, x[i]) < 1.6 * h) continue;
    least = fmin(least, nearest(i, x, x[i]) / h);
    n++;
  }
  assert_true(n > 100);
  vg_placed_release(&p);
  return least;
}

/* In a region, away from the front, points are 0.68 spacings apart, elsewhere
 * 0.66; the sizing field varies so slowly that the position of its evaluation
 * hardly matters. */
static void regions_keep_more_distance(void **state)
{
  const struct vg_region zone = { .n_plane = 1,
                                  .plane = { { { 0, 0, 1 }, 0.3 } } };
  const double centre[3] = { 0, 0, 0 };
  struct scene s;

  (void)state;
  memset(&s.m, 0, sizeof s.m);
  shape_box(&s.m, 5, 4);
  shape_sphere(&s.m, 8, centre, 1, 7);
  scene_of(&s, 1.1, 0);
  assert_true(least_within(&s, &zone) > 0.675);
  assert_true(least_within(&s, NULL) < 0.67);
  scene_end(&s);
}

/* The spacing is 0.25 everywhere: a reach of 1 is 0.25. */
static void cells_of_regions(void **state)
{
  const double a[3] = { 0, 0, 0 }, b[3] = { 1, 0, 0 }, c[3] = { 0, 1, 0 };
  const double d[3] = { 0, 0, 1 };
  struct vg_region all = VG_REGION_ALL;
  struct vg_region r = {
    .n_plane = 1, .plane = { { { 0, 0, 1 }, 0.5 }, { { 1, 0, 0 }, 0.5 } }
  };
  struct scene s;

  (void)state;
  box_scene(&s, 4, 0.25);
  assert_true(fabs(vg_sizing_at(s.sizing, a) - 0.25) < 1e-3);
  assert_true(vg_region_has_cell(&all, s.sizing, a, b, c, d));
  assert_true(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.plane[0].offset = 1; /* touches at d */
  assert_true(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.plane[0].offset = 1.25;
  assert_false(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.reach = 1.01;
  assert_true(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.reach = 0.5;
  assert_false(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.plane[0].offset = -1.25;
  assert_false(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.n_plane = 2;
  r.plane[0].offset = 0.5;
  assert_true(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.plane[1].offset = 1.5;
  assert_false(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  assert_true(vg_region_has_cell(&all, s.sizing, a, b, c, d));
  scene_end(&s);
}

/* A cell belongs to the region if all its corners are within all walls. */
static void walls_of_regions(void **state)
{
  const double a[3] = { 0, 0, 0 }, b[3] = { 0.2, 0, 0 }, c[3] = { 0, 0.2, 0 };
  const double d[3] = { 0, 0, 0.2 };
  struct vg_region r = { .n_plane = 1,
                         .plane = { { { 0, 0, 1 }, 0.1 } },
                         .n_wall = 1,
                         .wall = { { { 1, 0, 0 }, -0.1 } } };
  struct scene s;

  (void)state;
  box_scene(&s, 4, 0.25);
  assert_true(vg_region_within(&r, a));
  assert_true(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.wall[0].offset = 0; /* a, c and d are on it: not within */
  assert_false(vg_region_within(&r, a));
  assert_true(vg_region_within(&r, b));
  assert_false(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.wall[0].offset = 0.1;
  assert_false(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  r.wall[0].normal[0] = -1;
  r.wall[0].offset = -0.3;
  assert_true(vg_region_has_cell(&r, s.sizing, a, b, c, d));
  scene_end(&s);
}

/* --- seeds --------------------------------------------------------------- */

static void seeds_are_few_and_spread(void **state)
{
  const struct vg_region zone = { .n_plane = 1,
                                  .plane = { { { 0, 0, 1 }, 0 } } };
  struct scene s;
  struct vg_placed p = { 0 }, q = { 0 }, some = { 0 };
  const double(*x)[3];

  (void)state;
  box_scene(&s, 24, 1.0 / 24);
  x = (const double(*)[3])s.m.point;
  assert_int_equal(vg_place_seeds(s.m.n_point, x, s.sizing, NULL, &p, NULL),
                   VG_OK);
  assert_int_equal(vg_place_seeds(s.m.n_point, x, s.sizing, NULL, &q, NULL),
                   VG_OK);
  assert_in_range(p.n, 8, 512); /* 4^3: one for each 6^3 spacings */
  assert_int_equal(p.n, q.n);
  assert_memory_equal(p.x, q.x, p.n * sizeof *p.x);
  for (size_t i = 0; i < p.n; i++)
    for (int k = 0; k < 3; k++) assert_true(fabs(p.x[i][k]) < 0.5);
  assert_int_equal(vg_place_seeds(s.m.n_point, x, s.sizing, &zone, &some, NULL),
                   VG_OK);
  assert_true(some.n > 0 && some.n < p.n);
  for (size_t i = 0; i < some.n; i++) assert_true(fabs(some.x[i][2]) < 1e-9);
  vg_placed_release(&p);
  vg_placed_release(&q);
  vg_placed_release(&some);
  assert_int_equal(vg_place_seeds(0, x, s.sizing, NULL, &p, NULL), VG_OK);
  assert_int_equal(p.n, 0);
  assert_null(p.x);
  scene_end(&s);
}

/* Seeds of a box of spacing 1/16 with a source in it. */
static struct vg_placed seeds_of(const struct vg_source *source, double growth,
                                 const struct vg_region *region)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *sizing = NULL;
  struct vg_placed p = { 0 };
  struct vg_mesh m;

  memset(&m, 0, sizeof m);
  shape_box(&m, 16, 0.5);
  o.growth = growth;
  assert_int_equal(vg_sizing_new(&o, 1, source, &m, &sizing, NULL), VG_OK);
  assert_int_equal(vg_place_seeds(m.n_point, (const double(*)[3])m.point,
                                  sizing, region, &p, NULL),
                   VG_OK);
  for (size_t i = 0; region && i < p.n; i++)
    assert_true(vg_region_near(region, sizing, p.x[i], VG_BAND_PLACE));
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
  return p;
}

/* The least distance of a seed from x. */
static double seed_near(const struct vg_source *source, double growth,
                        const struct vg_region *region, const double x[3])
{
  struct vg_placed p = seeds_of(source, growth, region);
  double d = nearest(p.n, (const double(*)[3])p.x, x);

  vg_placed_release(&p);
  return d;
}

/* Where sizes grow fast, the front would miss a source that is small relative
 * to the surrounding spacing. Therefore such a source has its own seeds, also
 * where a plane passes within the band of placed points, but not farther
 * away. */
static void steep_places_have_seeds(void **state)
{
  const struct vg_source source = { .kind = VG_SOURCE_SPHERE,
                                    .h0 = 0.001,
                                    .r0 = 0.02,
                                    .p0 = { 0.187, -0.083, 0.289 } };
  static const struct {
    double at;
    int is_near;
  } list[] = { { 0.187, 1 }, { 0.2, 1 },  { 0.25, 1 },
               { 0.13, 1 },  { 0.35, 0 }, { 0, 0 } };

  (void)state;
  assert_true(seed_near(&source, 4, NULL, source.p0) < 0.021);
  assert_true(seed_near(&source, 2, NULL, source.p0) < 0.021);
  for (size_t i = 0; i < sizeof list / sizeof *list; i++) {
    const struct vg_region zone = { .n_plane = 1,
                                    .plane = { { { 1, 0, 0 }, list[i].at } } };

    assert_int_equal(seed_near(&source, 4, &zone, source.p0) < 0.021,
                     list[i].is_near);
  }
}

/* A thin line has seeds along its whole length; for a region, only where its
 * plane or pencil crosses the line. */
static void thin_lines_have_seeds(void **state)
{
  const struct vg_source source = { .kind = VG_SOURCE_LINE,
                                    .h0 = 5e-4,
                                    .h1 = 5e-4,
                                    .p0 = { -0.31, -0.17, -0.23 },
                                    .p1 = { 0.29, 0.15, 0.33 } };
  const struct vg_region zone = { .n_plane = 1,
                                  .plane = { { { 0, 0, 1 }, 0.05 } } };
  struct vg_region pencil = zone;
  struct vg_placed p;
  double x[3];

  (void)state;
  p = seeds_of(&source, 3, NULL);
  for (int i = 0; i < 200; i++) {
    for (int k = 0; k < 3; k++)
      x[k] = source.p0[k] + (i + 0.5) / 200 * (source.p1[k] - source.p0[k]);
    assert_true(nearest(p.n, (const double(*)[3])p.x, x) < 8 * 1.8 * source.h0);
  }
  vg_placed_release(&p);
  for (int k = 0; k < 3; k++)
    x[k] = source.p0[k] + 0.5 * (source.p1[k] - source.p0[k]);
  assert_true(seed_near(&source, 3, &zone, x) < 2 * source.h0);
  pencil.n_plane = 2;
  pencil.plane[1] = (struct vg_plane){ { 1, 0, 0 }, x[0] + source.h0 };
  assert_true(seed_near(&source, 3, &pencil, x) < 3 * source.h0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_uniform_field),
    cmocka_unit_test(a_graded_field),
    cmocka_unit_test(the_same_bytes_again),
    cmocka_unit_test(the_limit_is_exact),
    cmocka_unit_test(existing_points_count),
    cmocka_unit_test(a_slab_gets_only_its_own_points),
    cmocka_unit_test(regions_keep_more_distance),
    cmocka_unit_test(cells_of_regions),
    cmocka_unit_test(walls_of_regions),
    cmocka_unit_test(seeds_are_few_and_spread),
    cmocka_unit_test(steep_places_have_seeds),
    cmocka_unit_test(thin_lines_have_seeds)
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
