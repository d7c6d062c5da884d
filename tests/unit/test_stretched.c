/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The kernel in a metric: parallelepipeds that are cubes in random constant
 * metrics, of aspects up to 100, and a box in a graded metric. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/fill/fill.h"
#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/metric/metric_seeds.h"
#include "tensor_support.h"

enum { SIDE = 6 };

/* --- metrics -------------------------------------------------------------- */

/* The size along z grows from 0.02 in the plane z = 0.5. */
static void graded_metric(void *user, const double x[3], double m[6])
{
  double h = 0.02 + 0.2 * fabs(x[2] - 0.5);

  (void)user;
  vg_tensor_uniform(100, m);
  m[5] = 1 / (h * h);
}

static double graded_size(void *user, const double x[3])
{
  double m[6];

  graded_metric(user, x, m);
  return 1 / vg_cube_root(sqrt(vg_tensor_det(m)));
}

/* --- boxes ---------------------------------------------------------------- */

struct box {
  struct vg_front front;
  size_t n[3];
  const double *line[3]; /* Coordinates of the points along each axis. */
};

static uint32_t find_point(struct box *b, const size_t at[3])
{
  struct vg_front *f = &b->front;
  double x[3];

  for (int k = 0; k < 3; k++) x[k] = b->line[k][at[k]];
  for (size_t i = 0; i < f->n_point; i++)
    if (!memcmp(f->x[i], x, sizeof x)) return (uint32_t)i;
  memcpy(f->x[f->n_point], x, sizeof x);
  return (uint32_t)f->n_point++;
}

/* The two triangles of a square whose normal points into the box. */
static void add_square(struct box *b, int axis, int far, size_t i, size_t j)
{
  static const size_t step[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
  uint32_t v[4];

  for (int k = 0; k < 4; k++) {
    size_t at[3];

    at[axis] = far ? b->n[axis] : 0;
    at[(axis + 1) % 3] = i + step[k][0];
    at[(axis + 2) % 3] = j + step[k][1];
    v[far ? 3 - k : k] = find_point(b, at);
  }
  for (int k = 0; k < 2; k++) {
    uint32_t *f = b->front.face[b->front.n_face++];
    int turn = (int)((i + j) & 1);

    f[0] = v[turn];
    f[1] = v[turn + 1 + k];
    f[2] = v[(turn + 2 + k) % 4];
  }
}

static void make_box(struct box *b)
{
  size_t squares = 0;

  for (int k = 0; k < 3; k++)
    squares += 2 * b->n[(k + 1) % 3] * b->n[(k + 2) % 3];
  b->front.x = malloc(4 * squares * sizeof *b->front.x);
  b->front.face = malloc(2 * squares * sizeof *b->front.face);
  for (int axis = 0; axis < 3; axis++)
    for (int far = 0; far < 2; far++)
      for (size_t i = 0; i < b->n[(axis + 1) % 3]; i++)
        for (size_t j = 0; j < b->n[(axis + 2) % 3]; j++)
          add_square(b, axis, far, i, j);
}

/* --- measures ------------------------------------------------------------- */

struct figures {
  double fit, mean, low; /* Share of edges in [0.7, 1.42]; mean of the mean
                            ratios, and share of those below 0.25. */
  double volume;         /* Volume of the cells. */
};

static const double *point_of(const struct box *b, const struct vg_filled *f,
                              uint32_t v)
{
  return v < b->front.n_point ? b->front.x[v] : f->x[v - b->front.n_point];
}

static struct figures measure(const struct box *b, const struct vg_filled *f,
                              const struct vg_size_map *map)
{
  struct figures r = { 0 };

  for (size_t c = 0; c < f->n_cell; c++) {
    const double *x[4];
    double m[4][6], sum = 0, det = 0, volume, q;
    int finest = 0;

    for (int i = 0; i < 4; i++) {
      x[i] = point_of(b, f, f->cell[c][i]);
      map->metric(map->user, x[i], m[i]);
      if (vg_tensor_det(m[i]) > vg_tensor_det(m[finest])) finest = i;
    }
    det = sqrt(vg_tensor_det(m[finest]));
    for (int i = 0; i < 4; i++)
      for (int j = 0; j < i; j++) {
        double e[3], l;

        vg_sub(x[i], x[j], e);
        l = vg_metric_length(m[i], m[j], e);
        sum += vg_tensor_form(m[finest], e);
        r.fit += (l >= 0.7 && l <= 1.42) / (6.0 * (double)f->n_cell);
      }
    volume = vg_det(x[0], x[1], x[2], x[3]) / 6;
    q = volume > 0 ? vg_cube_root(3 * volume * det) : 0;
    q = 12 * q * q / sum;
    r.mean += q / (double)f->n_cell;
    r.low += (q < 0.25) / (double)f->n_cell;
    r.volume += volume;
  }
  return r;
}

/* The field of the map around the box. */
static struct vg_sizing *field(const struct box *b,
                               const struct vg_size_map *map)
{
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *sizing = NULL;
  struct vg_mesh mesh = VG_MESH_INIT;

  mesh.n_point = b->front.n_point;
  mesh.point = b->front.x;
  options.map = map;
  options.from_surface = 0;
  options.growth = 1.3;
  assert_int_equal(vg_sizing_new(&options, 0, NULL, &mesh, &sizing, NULL),
                   VG_OK);
  assert_true(vg_sizing_is_stretched(sizing));
  return sizing;
}

static struct figures fill(struct box *b, const struct vg_size_map *map,
                           size_t *n_cell)
{
  struct vg_fill_options fill_options = VG_FILL_OPTIONS_INIT;
  struct vg_filled made = VG_FILLED_INIT;
  struct vg_fill_report report = { 0 };
  struct vg_sizing *sizing = field(b, map);
  struct figures r;

  assert_int_equal(vg_fill_front(&b->front, NULL, sizing, &fill_options, &made,
                                 &report, NULL),
                   VG_OK);
  assert_int_equal(vg_filled_defects(&b->front, &made, 0), 0);
  assert_int_equal(report.whole_void, 0);
  r = measure(b, &made, map);
  *n_cell = made.n_cell;
  vg_filled_release(&made);
  vg_sizing_free(sizing);
  free(b->front.x);
  free(b->front.face);
  return r;
}

/* --- cases ---------------------------------------------------------------- */

/* The rounded image of a plane may be concave by its rounding; the flat cells
 * in its dents disappear.
 *
 * The unit cube, with points 1 / SIDE apart, under the size tensor of a random
 * metric, is a parallelepiped with a conforming surface. */
static void cubes_of_random_metrics(void **state)
{
  static const double aspect[] = { 1.5, 5, 20, 100 };
  double line[SIDE + 1];

  (void)state;
  for (int i = 0; i <= SIDE; i++) line[i] = i / (double)SIDE;
  for (int trial = 0; trial < 8; trial++) {
    double size[3], frame[3][3], h[6], m[6], volume;
    struct vg_size_map map = { .at = constant_size, .metric = constant_metric };
    struct box b = { .n = { SIDE, SIDE, SIDE }, .line = { line, line, line } };
    struct figures r;
    size_t n;

    random_frame(frame);
    size[0] = 1 / aspect[trial % 4];
    size[1] = trial < 4 ? 1 : random_in(size[0], 1);
    size[2] = 1;
    vg_tensor_from_eigen(size, (const double(*)[3])frame, h);
    make_box(&b);
    for (size_t i = 0; i < b.front.n_point; i++)
      vg_tensor_apply(h, b.front.x[i], b.front.x[i]);
    for (int k = 0; k < 3; k++) size[k] = SIDE * SIDE / (size[k] * size[k]);
    vg_tensor_from_eigen(size, (const double(*)[3])frame, m);
    map.user = m;
    map.most = 1;
    volume = vg_tensor_det(h);
    r = fill(&b, &map, &n);
    assert_true(fabs(r.volume / volume - 1) < 1e-9);
    assert_true(r.fit > 0.95);
    assert_true(r.mean > 0.84 && r.low == 0);
    assert_in_range(n, 6 * SIDE * SIDE * SIDE, 12 * SIDE * SIDE * SIDE);
  }
}

static void a_graded_box(void **state)
{
  double even[11], fine[200];
  struct vg_size_map map = { .at = graded_size,
                             .metric = graded_metric,
                             .most = 1 };
  struct box b = { .n = { 10, 10, 0 }, .line = { even, even, fine } };
  struct figures r;
  size_t n, half = 0;

  (void)state;
  for (int i = 0; i <= 10; i++) even[i] = i / 10.0;
  /* From the plane upwards; the other half is its mirror image. */
  for (double z = 0.5; z < 0.93; z += 0.02 + 0.22 * (z - 0.5)) fine[half++] = z;
  fine[half] = 1;
  for (size_t i = 0; i <= half; i++) fine[2 * half - i] = fine[half - i];
  for (size_t i = 0; i < half; i++) fine[i] = 1 - fine[2 * half - i];
  b.n[2] = 2 * half;
  make_box(&b);
  r = fill(&b, &map, &n);
  assert_true(fabs(r.volume - 1) < 1e-9);
  assert_true(r.fit > 0.9);
  assert_true(r.mean > 0.8 && r.low == 0);
}

/* A region gets those seeds that lie in the band in which it places points. */
static void seeds_stay_near(const double corner[2][3],
                            const struct vg_sizing *sizing)
{
  const struct vg_region plane = { .n_plane = 1,
                                   .plane = { { { 0, 0, 1 }, 0.6 } } };
  struct vg_metric_seeds all = { 0 }, some = { 0 };
  size_t n = 0;

  assert_int_equal(vg_metric_seeds(2, corner, sizing, NULL, &all, NULL), VG_OK);
  assert_int_equal(vg_metric_seeds(2, corner, sizing, &plane, &some, NULL),
                   VG_OK);
  for (size_t i = 0; i < all.n; i++)
    if (vg_region_near(&plane, sizing, all.x[i], VG_BAND_PLACE))
      assert_memory_equal(all.x[i], some.x[n++], sizeof *all.x);
  assert_int_equal(n, some.n);
  assert_true(n > 0 && n < all.n);
  free(all.x);
  free(some.x);
}

/* Seeds that are too near to a point that bounds the void are left out, and no
 * others. */
static void seeds_keep_their_distance(const double corner[2][3],
                                      const struct vg_sizing *sizing)
{
  enum { N = 60 };
  struct vg_metric_seeds all = { 0 }, some = { 0 };
  double x[N][3];
  size_t n = 0;

  memcpy(x, corner, 2 * sizeof *x);
  for (int i = 2; i < N; i++)
    for (int k = 0; k < 3; k++) x[i][k] = random_in(0, 1);
  assert_int_equal(vg_metric_seeds(2, corner, sizing, NULL, &all, NULL), VG_OK);
  assert_int_equal(vg_metric_seeds(N, (const double(*)[3])x, sizing, NULL,
                                   &some, NULL),
                   VG_OK);
  for (size_t i = 0; i < all.n; i++) {
    double least = INFINITY;

    for (int k = 0; k < N; k++) {
      double h[6], d[3];

      vg_sizing_tensor_at(sizing, all.x[i], h);
      vg_tensor_invert(h, h);
      vg_sub(x[k], all.x[i], d);
      vg_tensor_apply(h, d, d);
      least = fmin(least, vg_norm(d));
    }
    if (least >= VG_SEED_DISTANCE)
      assert_memory_equal(all.x[i], some.x[n++], sizeof *all.x);
  }
  assert_int_equal(n, some.n);
  assert_true(n > 0 && n < all.n);
  free(all.x);
  free(some.x);
}

/* The complexity of the graded metric in the unit cube is
 * 1000 log(0.12 / 0.02) = 1792, which makes 112 seeds (K49). Half of them lie
 * on each side of the plane z = 0.5, and half of them within 0.15 of it. */
static void seeds_follow_the_complexity(void **state)
{
  const double corner[2][3] = { { 0, 0, 0 }, { 1, 1, 1 } };
  struct vg_size_map map = { .at = graded_size,
                             .metric = graded_metric,
                             .most = 1 };
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_metric_seeds seeds = { 0 };
  struct vg_sizing *sizing = NULL;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh mesh = VG_MESH_INIT;
  size_t near = 0, above = 0;

  (void)state;
  mesh.n_point = 2;
  mesh.point = (double(*)[3])corner;
  options.map = &map;
  options.from_surface = 0;
  assert_int_equal(vg_sizing_new(&options, 0, NULL, &mesh, &sizing, &err),
                   VG_OK);
  assert_int_equal(vg_metric_seeds(2, corner, sizing, NULL, &seeds, &err),
                   VG_OK);
  for (size_t i = 0; i < seeds.n; i++) {
    near += fabs(seeds.x[i][2] - 0.5) < 0.15;
    above += seeds.x[i][2] > 0.5;
  }
  assert_in_range(seeds.n, 90, 135);
  assert_in_range(above, 2 * seeds.n / 5, 3 * seeds.n / 5);
  assert_in_range(near, 2 * seeds.n / 5, 3 * seeds.n / 4);
  free(seeds.x);
  seeds_stay_near(corner, sizing);
  seeds_keep_their_distance(corner, sizing);
  vg_sizing_free(sizing);
}

/* --- regions -------------------------------------------------------------- */

/* Thin across the cone of angle 45 degrees around the x axis, with the apex at
 * x = -0.1. */
static void cone_metric(void *user, const double x[3], double m[6])
{
  double y = x[1] - 0.5, z = x[2] - 0.5, r = sqrt(y * y + z * z) + 1e-9;
  const double n[3] = { -0.7071067811865476, 0.7071067811865476 * y / r,
                        0.7071067811865476 * z / r };
  double away = fabs(r - x[0] - 0.1) * 0.7071067811865476;
  double h = fmin(0.01 + 0.2 * away, 0.1), more = 1 / (h * h) - 100;
  int at = 0;

  (void)user;
  vg_tensor_uniform(100, m);
  for (int i = 0; i < 3; i++)
    for (int j = i; j < 3; j++) m[at++] += more * n[i] * n[j];
}

static double cone_size(void *user, const double x[3])
{
  double m[6];

  cone_metric(user, x, m);
  return 1 / vg_cube_root(sqrt(vg_tensor_det(m)));
}

/* Keeps the faces of the front that a region must know, and their points. */
static void keep_near(struct vg_front *f, const struct vg_region *r,
                      const struct vg_sizing *sizing)
{
  uint32_t *to = calloc(f->n_point, sizeof *to);
  size_t n_face = 0, n_point = 0;

  for (size_t i = 0; i < f->n_face; i++) {
    const uint32_t *v = f->face[i];

    if (!vg_region_may_meet(r, sizing, f->x[v[0]], f->x[v[1]], f->x[v[2]],
                            VG_BAND_FRONT))
      continue;
    for (int k = 0; k < 3; k++) to[v[k]] = 1;
    memmove(f->face[n_face++], v, sizeof *f->face);
  }
  for (size_t i = 0; i < f->n_point; i++) {
    if (!to[i]) continue;
    memmove(f->x[n_point], f->x[i], sizeof *f->x);
    to[i] = (uint32_t)n_point++;
  }
  for (size_t i = 0; i < n_face; i++)
    for (int k = 0; k < 3; k++) f->face[i][k] = to[f->face[i][k]];
  f->n_face = n_face;
  f->n_point = n_point;
  free(to);
}

/* Number of holes of a separator along z = at. */
static size_t holes_along(double at, struct vg_size_map *map)
{
  const struct vg_region plane = { .n_plane = 1,
                                   .plane = { { { 0, 0, 1 }, at } } };
  struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
  struct vg_filled made = VG_FILLED_INIT;
  struct vg_fill_report report = { 0 };
  double line[11];
  struct box b = { .n = { 10, 10, 10 }, .line = { line, line, line } };
  struct vg_sizing *sizing;
  size_t n_hole;

  for (int i = 0; i <= 10; i++) line[i] = 0.1 * i;
  make_box(&b);
  sizing = field(&b, map);
  keep_near(&b.front, &plane, sizing);
  assert_int_equal(vg_fill_front(&b.front, &plane, sizing, &options, &made,
                                 &report, NULL),
                   VG_OK);
  assert_int_equal(vg_filled_defects(&b.front, &made, 1), 0);
  assert_true(made.n_cell > 1000);
  n_hole = made.n_hole;
  vg_filled_release(&made);
  vg_sizing_free(sizing);
  free(b.front.x);
  free(b.front.face);
  return n_hole;
}

/* Planes through the thin cells of a cone get next to no holes: slivers to a
 * distant point of the front that remain between the points. Without swaps and
 * points in holes there are 38. */
static void separators_have_few_holes(void **state)
{
  size_t n_hole = 0;

  struct vg_size_map map = { .at = cone_size,
                             .metric = cone_metric,
                             .most = 1 };

  (void)state;
  for (int i = 0; i < 7; i++) n_hole += holes_along(0.31 + 0.025 * i, &map);
  assert_true(n_hole <= 3);
}

static int counts_down(void *user)
{
  size_t *left = user;

  return *left == 0 || --*left == 0;
}

/* A stop at any of the moments at which it is asked for ends the fill. */
static void stops(void **state)
{
  double line[SIDE + 1], m[6];
  struct vg_size_map map = {
    .at = constant_size, .metric = constant_metric, .user = m, .most = 1
  };
  struct box b = { .n = { SIDE, SIDE, SIDE }, .line = { line, line, line } };
  struct vg_sizing *sizing;
  size_t n = 0;
  vg_status st = VG_ERR_STOPPED;

  (void)state;
  for (int i = 0; i <= SIDE; i++) line[i] = i / (double)SIDE;
  make_box(&b);
  vg_tensor_uniform(SIDE * SIDE, m);
  m[5] *= 4;
  sizing = field(&b, &map);
  for (; st == VG_ERR_STOPPED; n++) {
    size_t left = n + 1;
    struct vg_fill_options options = VG_FILL_OPTIONS_INIT;
    struct vg_filled made = VG_FILLED_INIT;
    struct vg_fill_report report = { 0 };

    options.stop = (struct vg_stop){ counts_down, &left };
    st = vg_fill_front(&b.front, NULL, sizing, &options, &made, &report, NULL);
    vg_filled_release(&made);
  }
  assert_int_equal(st, VG_OK);
  /* At the start, among points and before the optimisation. */
  assert_int_equal(n, 4);
  vg_sizing_free(sizing);
  free(b.front.x);
  free(b.front.face);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(stops),
    cmocka_unit_test(cubes_of_random_metrics),
    cmocka_unit_test(a_graded_box),
    cmocka_unit_test(seeds_follow_the_complexity),
    cmocka_unit_test(separators_have_few_holes),
  };

  random_state = 0x9e3779b97f4a7c15u;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
