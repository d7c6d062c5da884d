/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Insertion by cavities: the result is Delaunay for any points, constraints are
 * kept, and a refusal changes nothing. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tets_support.h"

/* Insert n points into the cube -half..half. All must be accepted, and every
 * face must be Delaunay at the end, by the exact predicate. */
static void insert_cloud(size_t n, const double (*x)[3], double half)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;
  double volume = 8 * half * half * half;

  tets_box(&t, -half, half);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  for (size_t i = 0; i < n; i++)
    assert_int_equal(tets_insert(&s, x[i], 0, 0), VG_OK);
  assert_int_equal(t.n_point, n + 8);
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_int_equal(tets_not_delaunay(&t), 0);
  assert_true(fabs(tets_volume(&t) - volume) < 1e-11 * volume);
  for (size_t c = 0; c < t.n_cell; c++)
    assert_int_equal(t.flag[c] & (VG_MARK | VG_TRIED), 0);
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

static void random_points(void **state)
{
  enum { N = 3000 };
  static double x[N][3];
  uint64_t seed = 1;

  (void)state;
  for (int i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) x[i][k] = 2 * tets_random(&seed) - 1;
  insert_cloud(N, (const double(*)[3])x, 1.5);
}

/* Each cube of the grid has eight points on one sphere. */
static void a_grid_of_points(void **state)
{
  enum { SIDE = 9, N = SIDE * SIDE * SIDE };
  static double x[N][3];

  (void)state;
  for (int i = 0; i < N; i++) {
    int p = i * 100 % N; /* 100 and 729 have no common factor */

    x[i][0] = p % SIDE - 4;
    x[i][1] = p / SIDE % SIDE - 4;
    x[i][2] = p / SIDE / SIDE - 4;
  }
  insert_cloud(N, (const double(*)[3])x, 6);
}

/* Integer points with x^2 + y^2 + z^2 = 1105: exactly on one sphere. */
static void points_on_one_sphere(void **state)
{
  static double x[4096][3];
  size_t n = 0;

  (void)state;
  for (int i = -33; i <= 33; i++)
    for (int j = -33; j <= 33; j++)
      for (int k = -33; k <= 33; k++)
        if (i * i + j * j + k * k == 1105) {
          x[n][0] = i;
          x[n][1] = j;
          x[n++][2] = k;
        }
  assert_in_range(n, 100, 4096);
  insert_cloud(n, (const double(*)[3])x, 40);
}

static void points_on_a_line_and_a_plane(void **state)
{
  static double x[400][3];

  (void)state;
  for (int i = 0; i < 400; i++) {
    x[i][0] = (i % 20 - 10) / 16.0;
    x[i][1] = i < 20 ? x[i][0] : (i / 20 - 10) / 32.0;
    x[i][2] = i < 20 ? x[i][0] : 0.125;
  }
  for (int i = 20; i < 400; i++) /* no duplicate points */
    if (x[i][0] == 0.125 && x[i][1] == 0.125) x[i][2] = -0.5;
  insert_cloud(400, (const double(*)[3])x, 1);
}

/* Thirteen orders of magnitude between the smallest and the largest step. */
static void points_that_are_too_close(void **state)
{
  static double x[1000][3];
  uint64_t seed = 4;
  double r = 1;

  (void)state;
  for (int i = 0; i < 1000; i++, r *= 0.97)
    for (int k = 0; k < 3; k++) x[i][k] = r * (2 * tets_random(&seed) - 1);
  insert_cloud(1000, (const double(*)[3])x, 1.5);
}

/* --- refusal ------------------------------------------------------------ */

/* A copy of the current cells of t. */
static void copy_of(const struct vg_tets *t, struct vg_tets *c)
{
  *c = *t;
  c->cell = vg_alloc(t->n_cell, sizeof *t->cell);
  c->flag = vg_alloc(t->n_cell, 1);
  assert_true(c->cell && c->flag);
  memcpy(c->cell, t->cell, t->n_cell * sizeof *t->cell);
  memcpy(c->flag, t->flag, t->n_cell);
}

static void is_unchanged(const struct vg_tets *t, struct vg_tets *c)
{
  assert_int_equal(t->n_cell, c->n_cell);
  assert_int_equal(t->n_free, c->n_free);
  assert_memory_equal(t->cell, c->cell, t->n_cell * sizeof *t->cell);
  assert_memory_equal(t->flag, c->flag, t->n_cell);
  free(c->cell);
  free(c->flag);
}

static void refused(struct vg_inserter *s, double x, double y, double z,
                    double clearance, double nearest)
{
  const double at[3] = { x, y, z };
  size_t n = s->t->n_point;
  struct vg_tets c;

  copy_of(s->t, &c);
  assert_int_equal(tets_insert(s, at, clearance, nearest), VG_BLOCKED);
  assert_int_equal(s->t->n_point, n);
  is_unchanged(s->t, &c);
}

static void taken(struct vg_inserter *s, double x, double y, double z,
                  double clearance, double nearest)
{
  const double at[3] = { x, y, z };

  assert_int_equal(tets_insert(s, at, clearance, nearest), VG_OK);
  assert_int_equal(vg_tets_defects(s->t), 0);
}

static void duplicates_change_nothing(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;
  uint64_t seed = 7;

  (void)state;
  tets_box(&t, 0, 1);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  for (int i = 0; i < 200; i++)
    taken(&s, tets_random(&seed), tets_random(&seed), tets_random(&seed), 0, 0);
  for (size_t p = 0; p < 208; p++)
    refused(&s, t.x[p][0], t.x[p][1], t.x[p][2], 0, 0);
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

/* A point on a face of the hull has no cavity from which it is visible. */
static void points_on_the_hull_are_refused(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;

  (void)state;
  tets_box(&t, 0, 1);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  taken(&s, 0.5, 0.25, 0.375, 0, 0);
  refused(&s, 0, 0.25, 0.625, 0, 0);
  refused(&s, 0.5, 0.5, 1, 0, 0);
  refused(&s, 0.5, 0, 0, 0, 0);
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

static void the_nearest_point_keeps_its_distance(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;

  (void)state;
  tets_box(&t, 0, 1);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  taken(&s, 0.5, 0.5, 0.5, 0, 0);
  refused(&s, 0.59, 0.5, 0.5, 0, 0.1);
  refused(&s, 0.01, 0.01, 0.01, 0, 0.1);
  taken(&s, 0.61, 0.5, 0.5, 0, 0.1);
  taken(&s, 0.5, 0.59, 0.5, 0, 0.08);
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

/* --- constraints -------------------------------------------------------- */

static int in_plane(const struct vg_tets *t, size_t c, int i)
{
  for (int k = 0; k < 3; k++)
    if (t->x[t->cell[c].v[vg_face[i][k]]][2] != 2) return 0;
  return 1;
}

/* 5 x 5 x 4 cubes with the faces at z = 2 fixed, and the cells below flagged as
 * outside. */
static void start_layers(struct vg_tets *t)
{
  const int n[3] = { 5, 5, 4 };

  tets_grid(t, n);
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      if (t->x[t->cell[c].v[i]][2] < 2) t->flag[c] |= VG_OUTSIDE;
      if (in_plane(t, c, i)) t->flag[c] |= (uint8_t)(1 << i);
    }
}

static void layers_are_kept(const struct vg_tets *t)
{
  size_t n_fixed = 0;

  assert_int_equal(vg_tets_defects(t), 0);
  for (size_t c = 0; c < t->n_cell; c++) {
    int above = 0, below = 0;

    if (t->flag[c] & VG_DEAD) continue;
    for (int i = 0; i < 4; i++) {
      above |= t->x[t->cell[c].v[i]][2] > 2;
      below |= t->x[t->cell[c].v[i]][2] < 2;
      assert_int_equal(t->flag[c] >> i & 1, in_plane(t, c, i));
      n_fixed += t->flag[c] >> i & 1;
    }
    assert_true(above + below == 1);
    assert_int_equal(!!(t->flag[c] & VG_OUTSIDE), below);
  }
  assert_int_equal(n_fixed, 2 * 2 * 25);
  assert_true(fabs(tets_volume(t) - 50) < 1e-11);
}

/* Each side of the plane is convex, so it is Delaunay up to the plane. */
static void constrained_faces_stay(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;
  uint64_t seed = 9;
  size_t n_taken = 0;

  (void)state;
  start_layers(&t);
  layers_are_kept(&t);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  for (int i = 0; i < 800; i++) {
    const double x[3] = { 5 * tets_random(&seed), 5 * tets_random(&seed),
                          4 * tets_random(&seed) };

    n_taken += tets_insert(&s, x, 0, 0) == VG_OK;
  }
  assert_int_equal(n_taken, 800);
  layers_are_kept(&t);
  assert_int_equal(tets_not_delaunay(&t), 0);
  refused(&s, 2.5, 2.25, 2, 0, 0); /* in a constrained face */
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

/* Faces in the plane have edges 1, 1, sqrt 2: root mean square 1.155. */
static void clearance_over_constrained_faces(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;

  (void)state;
  start_layers(&t);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  refused(&s, 2.3, 2.1, 2.01, 0.3, 0);
  refused(&s, 2.3, 2.1, 2.33, 0.3, 0);
  refused(&s, 2.3, 2.1, 1.67, 0.3, 0); /* the same from below */
  taken(&s, 2.3, 2.1, 2.36, 0.3, 0);
  taken(&s, 3.7, 3.2, 2.01, 0, 0);
  taken(&s, 1.3, 1.2, 3.9, 0.3, 0); /* the hull is not constrained */
  layers_are_kept(&t);
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

/* Every face between the first cells is fixed: each point stays in its first
 * cell. */
static void an_enclosed_point(void **state)
{
  const int n[3] = { 2, 2, 2 };
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;
  uint64_t seed = 11;

  (void)state;
  tets_grid(&t, n);
  memset(t.flag, VG_FIXED_FACES, t.n_cell);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  for (size_t c = 0; c < 48; c++) {
    double x[3] = { 0 };
    uint32_t v[4];

    memcpy(v, t.cell[c].v, sizeof v);
    for (int k = 0; k < 3; k++)
      for (int i = 0; i < 4; i++)
        x[k] += t.x[v[i]][k] * (0.25 + 0.01 * (i - 1.5));
    taken(&s, x[0], x[1], x[2], 0, 0);
  }
  assert_int_equal(tets_live(&t), 4 * 48);
  for (int k = 0; k < 100; k++) {
    const double x[3] = { 2 * tets_random(&seed), 2 * tets_random(&seed),
                          2 * tets_random(&seed) };

    assert_int_equal(tets_insert(&s, x, 0, 0), VG_OK);
  }
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_true(fabs(tets_volume(&t) - 8) < 1e-12);
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

static void the_same_bytes_again(void **state)
{
  struct vg_tets t[2] = { VG_TETS_INIT, VG_TETS_INIT };

  (void)state;
  for (int run = 0; run < 2; run++) {
    struct vg_inserter s;
    uint64_t seed = 13;

    start_layers(&t[run]);
    assert_int_equal(vg_inserter_init(&s, &t[run], NULL), VG_OK);
    for (int i = 0; i < 500; i++) {
      const double x[3] = { 5 * tets_random(&seed), 5 * tets_random(&seed),
                            4 * tets_random(&seed) };

      assert_true(tets_insert(&s, x, 0.2, 0.05) >= 0);
    }
    vg_inserter_release(&s);
  }
  assert_int_equal(t[0].n_cell, t[1].n_cell);
  assert_int_equal(t[0].n_point, t[1].n_point);
  assert_memory_equal(t[0].cell, t[1].cell, t[0].n_cell * sizeof *t[0].cell);
  assert_memory_equal(t[0].x, t[1].x, t[0].n_point * sizeof *t[0].x);
  vg_tets_release(&t[0]);
  vg_tets_release(&t[1]);
}

/* The cell of each point contains it, after any insertion. */
static void stars_are_kept_up_to_date(void **state)
{
  enum { N = 300 };
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;
  uint32_t star[N + 8];
  uint64_t seed = 7;

  (void)state;
  tets_box(&t, -1, 1);
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  memset(star, 0xff, sizeof star);
  for (uint32_t c = 0; c < t.n_cell; c++)
    for (int i = 0; i < 4; i++) star[t.cell[c].v[i]] = c;
  s.star = star;
  for (int n = 0; n < N; n++) {
    double x[3];

    for (int k = 0; k < 3; k++) x[k] = 1.8 * tets_random(&seed) - 0.9;
    assert_int_equal(tets_insert(&s, x, 0, 0), VG_OK);
    for (uint32_t p = 0; p < t.n_point; p++) {
      const uint32_t *v = t.cell[star[p]].v;

      assert_true(star[p] < t.n_cell && !(t.flag[star[p]] & VG_DEAD));
      assert_true(v[0] == p || v[1] == p || v[2] == p || v[3] == p);
    }
  }
  vg_inserter_release(&s);
  vg_tets_release(&t);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(random_points),
    cmocka_unit_test(a_grid_of_points),
    cmocka_unit_test(points_on_one_sphere),
    cmocka_unit_test(points_on_a_line_and_a_plane),
    cmocka_unit_test(points_that_are_too_close),
    cmocka_unit_test(duplicates_change_nothing),
    cmocka_unit_test(points_on_the_hull_are_refused),
    cmocka_unit_test(the_nearest_point_keeps_its_distance),
    cmocka_unit_test(constrained_faces_stay),
    cmocka_unit_test(clearance_over_constrained_faces),
    cmocka_unit_test(an_enclosed_point),
    cmocka_unit_test(the_same_bytes_again),
    cmocka_unit_test(stars_are_kept_up_to_date),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
