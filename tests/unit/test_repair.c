/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Repairs: bad cells across an interface improve, and nothing else changes. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "partition/repair/repair_parts.h"
#include "repair_support.h"

static const double aim = VG_SHAPE_TARGET;

/* --- access to pieces ---------------------------------------------------- */

static size_t count_cells(const struct scene *s)
{
  size_t n = 0;

  for (size_t k = 0; k < s->p.n_piece; k++) n += s->p.piece[k].n_cell;
  return n;
}

/* Index of a point of the box, in the original order of ids, in one array. */
static size_t index_of(const struct scene *s, uint64_t name, size_t n_hull)
{
  size_t at = n_hull;

  if (!(name >> 32)) return (uint32_t)name;
  for (size_t k = 0; k < s->p.n_piece; k++) {
    if (s->p.piece[k].serial == name >> 32) return at + (uint32_t)name;
    at += s->p.piece[k].n_point;
  }
  fail();
  return 0;
}

/* All pieces as one mesh: fails if they do not match. */
static void whole(const struct scene *s, struct vg_tets *t)
{
  size_t n_hull = s->t.n_point, n = n_hull, n_cell = count_cells(s), at = 0;
  double(*x)[3];
  uint32_t(*cell)[4] = vg_alloc(n_cell, sizeof *cell);

  for (size_t k = 0; k < s->p.n_piece; k++) n += s->p.piece[k].n_point;
  x = vg_calloc(n, sizeof *x);
  assert_true(x && cell);
  memcpy(x, s->t.x, n_hull * sizeof *x);
  for (size_t k = 0; k < s->p.n_piece; k++) {
    const struct vg_piece *q = &s->p.piece[k];

    for (size_t i = 0; i < q->n_point; i++)
      memcpy(x[index_of(s, VG_POINT_ID(q->serial, i), n_hull)],
             q->x[q->n_in + i], sizeof *x);
  }
  for (size_t k = 0; k < s->p.n_piece; k++) {
    const struct vg_piece *q = &s->p.piece[k];

    for (size_t c = 0; c < q->n_cell; c++, at++)
      for (size_t i = 0; i < 4; i++) {
        uint32_t v = vg_packed_corner(&q->cell, 4 * c + i);
        size_t p = index_of(s,
                            v < q->n_in ? q->in[v]
                                        : VG_POINT_ID(q->serial, v - q->n_in),
                            n_hull);

        cell[at][i] = (uint32_t)p;
        assert_memory_equal(x[p], q->x[v], sizeof *x);
      }
  }
  memset(t, 0, sizeof *t);
  assert_int_equal(vg_tets_from_cells(t, n, x, n_cell,
                                      (const uint32_t(*)[4])cell, NULL),
                   VG_OK);
  assert_int_equal(vg_tets_defects(t), 0);
  free(cell);
}

static double worst_of(const struct vg_tets *t)
{
  double worst = 2;

  for (size_t c = 0; c < t->n_cell; c++) {
    double q = cell_shape(t, c);

    if (q < worst) worst = q;
  }
  return worst;
}

static double mean_of(const struct vg_tets *t)
{
  double sum = 0;

  for (size_t c = 0; c < t->n_cell; c++) sum += cell_shape(t, c);
  return sum / (double)t->n_cell;
}

/* Worst and mean shape in the metric of the scene. */
static double shapes_in_metric(const struct scene *s, const struct vg_tets *t,
                               double *mean)
{
  struct vg_metrics *m;
  double worst = 2, sum = 0;

  assert_int_equal(vg_metrics_of_corners(s->sizing, t, &m), VG_OK);
  assert_non_null(m);
  for (size_t c = 0; c < t->n_cell; c++) {
    double q = vg_metrics_shape(m, t, t->cell[c].v);

    worst = fmin(worst, q);
    sum += q / (double)t->n_cell;
  }
  vg_metrics_free(m);
  *mean = sum;
  return worst;
}

/* Every face without neighbour is on the hull of the box. */
static void check_hull(const struct scene *s, const struct vg_tets *t)
{
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++)
      for (int m = 0; m < 3 && t->cell[c].link[i] == VG_NONE; m++)
        assert_true(on_hull(s, t->x[t->cell[c].v[vg_face[i][m]]]));
}

static void check_volume(const struct scene *s, const struct vg_tets *t)
{
  double v = s->n[0] * s->n[1] * s->n[2];

  assert_true(fabs(tets_volume(t) - v) < 1e-11 * v);
}

/* --- tests --------------------------------------------------------------- */

/* A point of the interface between slabs 1 and 2 moved until cells on both
 * sides of it are bad. */
static void bad_scene(struct scene *s, int n)
{
  const double by[3] = { 0.1, 0.72, -0.12 };

  scene_new(s, 16, n, n);
  assert_true(scene_move(s, scene_point(s, 8, n / 2, n / 2), by, 1e-6));
  assert_true(worst_of(&s->t) < 0.05);
  scene_cut(s, NULL, 1);
}

static void test_mends_across(void **state)
{
  struct scene s;
  struct vg_tets t;
  const struct vg_piece *q;

  (void)state;
  bad_scene(&s, 8);
  assert_int_equal(vg_partition_repair(&s.p, NULL, NULL, NULL), VG_OK);
  assert_int_equal(s.p.report.n_repair, 1);
  assert_int_equal(s.p.report.n_repaired, 1);
  assert_true(s.p.report.repair_worst == worst_of(&s.t));
  assert_true(s.p.report.n_repair_bad_left < s.p.report.n_repair_bad);
  whole(&s, &t);
  check_hull(&s, &t);
  check_volume(&s, &t);
  assert_true(worst_of(&t) >= aim);
  assert_int_equal(s.p.n_piece, SLABS + 1);
  q = &s.p.piece[SLABS];
  assert_string_equal(q->path, "R000000");
  assert_int_equal(q->kind, VG_SPAN_REPAIR);
  assert_int_equal(q->n_cell,
                   s.p.report.n_repair_cell + count_cells(&s) - s.t.n_cell);
  vg_tets_release(&t);
  scene_end(&s);
}

/* Points outside the repair region have not moved, and no piece keeps the id of
 * a point that it does not use. */
static void test_border_stays(void **state)
{
  struct scene s;
  size_t n_moved = 0, n_own = 0;

  (void)state;
  bad_scene(&s, 8);
  assert_int_equal(vg_partition_repair(&s.p, NULL, NULL, NULL), VG_OK);
  for (int g = 0; g < SLABS; g++) {
    const struct vg_piece *q = &s.p.piece[g];
    uint8_t *used = vg_calloc(q->n_in + q->n_point, 1);

    assert_non_null(used);
    for (size_t i = 0; i < q->n_point; i++) {
      const double *x = q->x[q->n_in + i];
      double d = hypot(hypot(x[0] - 8, x[1] - 4), x[2] - 4);
      int moved = 0;

      for (int k = 0; k < 3; k++) moved |= x[k] != round(x[k]);
      n_own++;
      n_moved += (size_t)moved;
      if (d > 4.5) assert_false(moved);
    }
    for (size_t k = 0; k < 4 * q->n_cell; k++)
      used[vg_packed_corner(&q->cell, k)] = 1;
    for (size_t i = 0; i < q->n_in; i++) assert_true(used[i]);
    free(used);
  }
  assert_true(n_moved > 0);
  assert_int_equal(n_own, 15 * 7 * 7);
  scene_end(&s);
}

/* Points on interfaces of zones and their neighbours are smoothed, in wide
 * slabs and in slabs so narrow that the points of two interfaces share cells;
 * other points stay. The results of swaps match across interfaces. */
static void test_smooths(void **state)
{
  static const int wide[] = { 16, 4 };

  (void)state;
  for (int k = 0; k < 2; k++) {
    struct vg_tets before, after;
    struct scene s;
    size_t moved = 0, beside = 0;

    scene_new(&s, wide[k], 6, 6);
    scene_shake(&s, 0.16, 11);
    scene_cut(&s, NULL, 1);
    scene_zones(&s);
    whole(&s, &before);
    assert_int_equal(vg_partition_repair(&s.p, NULL, NULL, NULL), VG_OK);
    assert_int_equal(s.p.report.n_repaired, 0);
    whole(&s, &after);
    check_volume(&s, &after);
    assert_true(mean_of(&after) > mean_of(&before));
    assert_true(worst_of(&after) >= fmin(aim, worst_of(&before)));
    for (size_t p = 0; p < after.n_point; p++) {
      /* distance from 1/4, 1/2, 3/4 of the length */
      double off = fabs(remainder(before.x[p][0], wide[k] / SLABS));

      if (!memcmp(after.x[p], before.x[p], sizeof *after.x)) continue;
      /* allows for the random shift, and for a grid point */
      assert_true(off <= 0.16 || fabs(off - 1) <= 0.16);
      if (off <= 0.16) moved++;
      else beside++;
    }
    /* each once or twice */
    assert_in_range(s.p.report.n_repair_moved, moved, 2 * moved);
    assert_in_range(moved, k ? 40 : 60, 75);
    assert_true(k || beside > 60);
    assert_true(!k || s.p.report.n_repair_swapped > 0);
    vg_tets_release(&before);
    vg_tets_release(&after);
    scene_end(&s);
  }
}

static void unchanged(struct scene *s)
{
  struct vg_digest before, after;

  before = scene_digest(s, NULL);
  assert_int_equal(vg_partition_repair(&s->p, NULL, NULL, NULL), VG_OK);
  after = scene_digest(s, NULL);
  assert_memory_equal(&before, &after, sizeof after);
  assert_int_equal(s->p.report.n_repaired, 0);
}

static void test_nothing_bad(void **state)
{
  struct scene s;

  (void)state;
  scene_new(&s, 8, 3, 3);
  scene_cut(&s, NULL, 1);
  unchanged(&s);
  assert_int_equal(s.p.report.n_repair, 0);
  scene_end(&s);
}

/* Bad cells inside a piece are left: repairing them was up to their own
 * task. */
static void test_inside_is_left(void **state)
{
  const double by[3] = { 0.05, 0.72, -0.12 };
  struct scene s;

  (void)state;
  scene_new(&s, 24, 6, 6);
  assert_true(scene_move(&s, scene_point(&s, 15, 3, 3), by, 1e-6));
  assert_true(worst_of(&s.t) < aim);
  scene_cut(&s, NULL, 1);
  unchanged(&s);
  assert_int_equal(s.p.report.n_repair, 0);
  scene_end(&s);
}

/* Flat slabs: all cells are bad, and the hull permits no better ones. */
static void test_slabs_that_cannot_be_improved(void **state)
{
  struct scene s;

  (void)state;
  scene_new(&s, 4, 2, 2);
  for (uint32_t p = 0; p < s.t.n_point; p++)
    for (int k = 1; k < 3; k++) s.t.x[p][k] *= 512;
  s.n[1] *= 512;
  s.n[2] *= 512;
  assert_true(worst_of(&s.t) < aim);
  scene_cut(&s, NULL, 1);
  unchanged(&s);
  assert_int_equal(s.p.report.n_repair, 2); /* tried again */
  assert_true(s.p.report.repair_worst_left == s.p.report.repair_worst);
  assert_int_equal(s.p.report.n_repair_bad_left, s.p.report.n_repair_bad);
  scene_end(&s);
}

/* Many regions, side by side and overlapping. */
static void test_many(void **state)
{
  struct vg_digest d[2];

  (void)state;
  for (int k = 0; k < 2; k++) {
    struct vg_tets t;
    struct scene s;

    scene_new(&s, 20, 8, 8);
    scene_shake(&s, 0.4, 3);
    scene_cut(&s, NULL, k ? 3 : 1);
    assert_int_equal(vg_partition_repair(&s.p, NULL, NULL, NULL), VG_OK);
    assert_true(s.p.report.n_repaired > 0);
    assert_true(s.p.report.n_repair_bad_left < s.p.report.n_repair_bad / 2);
    whole(&s, &t);
    check_hull(&s, &t);
    check_volume(&s, &t);
    d[k] = scene_digest(&s, NULL);
    vg_tets_release(&t);
    scene_end(&s);
  }
  assert_memory_equal(&d[0], &d[1], sizeof *d);
}

/* --- in a metric -----------------------------------------------------------
 */

/* All cells are bad by their angles, and good in the metric, except those
 * around one point of an interface. */
static void test_mends_in_metric(void **state)
{
  const double by[3] = { 0.1, 0.72, -0.12 };
  struct scene s;
  struct vg_tets t;
  double mean;

  (void)state;
  scene_new(&s, 16, 8, 8);
  assert_true(scene_move(&s, scene_point(&s, 8, 4, 4), by, 1e-6));
  scene_stretch(&s, 16);
  assert_true(shapes_in_metric(&s, &s.t, &mean) < 0.05);
  scene_cut(&s, NULL, 1);
  assert_int_equal(vg_partition_repair(&s.p, NULL, NULL, NULL), VG_OK);
  assert_int_equal(s.p.report.n_repair, 1);
  assert_int_equal(s.p.report.n_repaired, 1);
  assert_in_range(s.p.report.n_repair_cell, 50, s.t.n_cell / 4);
  assert_int_equal(s.p.report.n_repair_bad_left, 0);
  whole(&s, &t);
  check_hull(&s, &t);
  check_volume(&s, &t);
  assert_true(shapes_in_metric(&s, &t, &mean) >= VG_METRIC_TARGET);
  assert_true(s.p.report.repair_worst_left >= VG_METRIC_TARGET);
  vg_tets_release(&t);
  scene_end(&s);
}

static void test_good_in_metric_is_left(void **state)
{
  struct scene s;

  (void)state;
  scene_new(&s, 8, 3, 3);
  scene_stretch(&s, 32);
  assert_true(worst_of(&s.t) < aim);
  scene_cut(&s, NULL, 1);
  unchanged(&s);
  assert_int_equal(s.p.report.n_repair, 0);
  scene_end(&s);
}

/* The same cells improve by the same means as without stretching: points of the
 * interfaces and their neighbours move, and cells are swapped across. */
static void test_smooths_in_metric(void **state)
{
  struct vg_digest d[2];

  (void)state;
  for (int k = 0; k < 2; k++) {
    struct vg_tets before, after;
    struct scene s;
    double was, is, worst;

    scene_new(&s, 16, 6, 6);
    scene_shake(&s, 0.2, 11);
    scene_stretch(&s, 20);
    scene_cut(&s, NULL, k ? 3 : 1);
    scene_zones(&s);
    whole(&s, &before);
    worst = shapes_in_metric(&s, &before, &was);
    assert_int_equal(vg_partition_repair(&s.p, NULL, NULL, NULL), VG_OK);
    whole(&s, &after);
    check_hull(&s, &after);
    check_volume(&s, &after);
    assert_true(shapes_in_metric(&s, &after, &is) >=
                fmin(VG_METRIC_TARGET, worst));
    assert_true(is > 1.02 * was);
    assert_true(s.p.report.n_repair_moved >= 75);
    assert_true(s.p.report.n_repair_swapped > 0);
    d[k] = scene_digest(&s, NULL);
    vg_tets_release(&before);
    vg_tets_release(&after);
    scene_end(&s);
  }
  assert_memory_equal(&d[0], &d[1], sizeof *d);
}

/* --- balls --------------------------------------------------------------- */

enum { N_BALL = 600 };

static void scatter(struct vg_spot *spot, uint64_t seed)
{
  for (int i = 0; i < N_BALL; i++) {
    double at[3];

    for (int k = 0; k < 3; k++) at[k] = 4 * tets_random(&seed) - 2;
    spot[i] = vg_spot_of(at, 0.3 * ldexp(1, -(int)(8 * tets_random(&seed))),
                         NULL);
  }
}

static int touch(const struct vg_spot *a, const struct vg_spot *b)
{
  double d = 0, r = a->radius + b->radius;

  for (int k = 0; k < 3; k++)
    d += (a->at[k] - b->at[k]) * (a->at[k] - b->at[k]);
  return d <= r * r;
}

static void test_balls(void **state)
{
  static struct vg_spot spot[N_BALL];
  struct vg_spot_grid b;
  uint64_t seed = 5;
  size_t n_in = 0;

  (void)state;
  scatter(spot, 11);
  assert_int_equal(vg_spot_grid_new(N_BALL, spot, N_BALL, &b, NULL), VG_OK);
  assert_true(b.n_cluster > 10 && b.n_cluster < N_BALL);
  for (int i = 0; i < N_BALL; i++)
    for (int j = 0; j < i; j++)
      if (touch(&spot[i], &spot[j]))
        assert_int_equal(b.cluster[i], b.cluster[j]);
  for (int k = 0; k < 20000; k++) {
    struct vg_spot x = { .radius = 0 };
    uint32_t want = VG_NO_CLUSTER;

    for (int a = 0; a < 3; a++) x.at[a] = 4 * tets_random(&seed) - 2;
    for (int i = 0; i < N_BALL; i++)
      if (touch(&spot[i], &x)) want = b.cluster[i];
    n_in += want != VG_NO_CLUSTER;
    assert_int_equal(vg_spot_grid_at(&b, x.at), want);
  }
  assert_true(n_in > 100);
  vg_spot_grid_release(&b);
}

/* Balls of one metric are round in its space: the same balls overlap, and the
 * same points are inside. */
static void test_balls_in_metric(void **state)
{
  static const double axis[3][3] = { { 1. / 3, 2. / 3, 2. / 3 },
                                     { 2. / 3, 1. / 3, -2. / 3 },
                                     { 2. / 3, -2. / 3, 1. / 3 } };
  static const double value[3] = { 1. / 36, 6, 6 };
  static struct vg_spot spot[N_BALL], round[N_BALL];
  struct vg_spot_grid b, r;
  uint64_t seed = 5;
  double m[6], h[6];

  (void)state;
  vg_tensor_from_eigen(value, axis, m);
  vg_tensor_root(m, h);
  vg_tensor_invert(h, h);
  scatter(round, 11);
  for (int i = 0; i < N_BALL; i++) {
    double at[3];

    vg_tensor_apply(h, round[i].at, at);
    spot[i] = vg_spot_of(at, round[i].radius, m);
  }
  assert_int_equal(vg_spot_grid_new(N_BALL, round, 8, &r, NULL), VG_OK);
  assert_int_equal(vg_spot_grid_new(N_BALL, spot, 8, &b, NULL), VG_OK);
  assert_memory_equal(b.cluster, r.cluster, N_BALL * sizeof *b.cluster);
  for (int k = 0; k < 20000; k++) {
    double x[3], y[3];

    for (int a = 0; a < 3; a++) x[a] = 4 * tets_random(&seed) - 2;
    vg_tensor_apply(h, x, y);
    assert_int_equal(vg_spot_grid_at(&b, y), vg_spot_grid_at(&r, x));
  }
  vg_spot_grid_release(&b);
  vg_spot_grid_release(&r);
}

/* No cluster has more balls than requested; the remaining balls are in no
 * cluster, and clusters stay apart. */
static void test_balls_capped(void **state)
{
  static struct vg_spot spot[N_BALL];
  size_t size[N_BALL] = { 0 }, left = 0;
  struct vg_spot_grid b;

  (void)state;
  scatter(spot, 12);
  assert_int_equal(vg_spot_grid_new(N_BALL, spot, 5, &b, NULL), VG_OK);
  for (int i = 0; i < N_BALL; i++) {
    if (b.cluster[i] == VG_NO_CLUSTER) {
      left++;
      continue;
    }
    assert_true(b.cluster[i] < b.n_cluster);
    assert_true(++size[b.cluster[i]] <= 5);
    for (int j = 0; j < i; j++)
      if (b.cluster[j] != VG_NO_CLUSTER && touch(&spot[i], &spot[j]))
        assert_int_equal(b.cluster[i], b.cluster[j]);
  }
  assert_true(left > 0 && left < N_BALL / 2);
  vg_spot_grid_release(&b);
}

/* Balls that are left out are within half the radius of one that is kept. */
static void test_thin(void **state)
{
  static struct vg_spot all[N_BALL], spot[N_BALL];
  size_t n = N_BALL;

  (void)state;
  scatter(all, 13);
  for (int i = 0; i < N_BALL; i++)
    all[i] = vg_spot_of(all[i].at, 0.5 + 0.1 * (i % 2), NULL);
  memcpy(spot, all, sizeof all);
  assert_int_equal(vg_spots_thin(&n, spot, NULL), VG_OK);
  assert_true(n > 10 && n < N_BALL);
  for (int i = 0; i < N_BALL; i++) {
    struct vg_spot x = all[i];
    int found = 0;

    x.radius = 0;
    for (size_t k = 0; k < n && !found; k++) {
      struct vg_spot half = spot[k];

      half.radius *= 0.5;
      found = touch(&half, &x);
    }
    assert_true(found);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_mends_across),
    cmocka_unit_test(test_border_stays),
    cmocka_unit_test(test_smooths),
    cmocka_unit_test(test_nothing_bad),
    cmocka_unit_test(test_inside_is_left),
    cmocka_unit_test(test_slabs_that_cannot_be_improved),
    cmocka_unit_test(test_many),
    cmocka_unit_test(test_mends_in_metric),
    cmocka_unit_test(test_good_in_metric_is_left),
    cmocka_unit_test(test_smooths_in_metric),
    cmocka_unit_test(test_balls),
    cmocka_unit_test(test_balls_in_metric),
    cmocka_unit_test(test_balls_capped),
    cmocka_unit_test(test_thin),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
