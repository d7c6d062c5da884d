/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edges and triangles recovered by flips: all that can be are, the tetrahedra
 * still fill the same box, and recovered ones are kept. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/recover/boundary.h"
#include "core/recover/recover.h"
#include "core/recover/recover_flip.h"
#include "tets_support.h"
#include "parts_support.h"

enum { N_POINT = 300 };

static void insert_all(struct vg_tets *t, size_t n, const double (*x)[3])
{
  struct vg_inserter s;

  tets_box(t, -1, 2);
  assert_int_equal(vg_inserter_init(&s, t, NULL), VG_OK);
  for (size_t k = 0; k < n; k++)
    assert_int_equal(tets_insert(&s, x[k], 0, 0), VG_OK);
  vg_inserter_release(&s);
}

/* Points at random in a box of the given height; point k is 8 + k. */
static void random_points(struct vg_tets *t, size_t n, double height,
                          uint64_t seed)
{
  double(*x)[3] = vg_alloc(n, sizeof *x);

  assert_non_null(x);
  for (size_t k = 0; k < n; k++)
    for (int i = 0; i < 3; i++)
      x[k][i] = tets_random(&seed) * (i == 2 ? height : 1);
  insert_all(t, n, (const double(*)[3])x);
  free(x);
}

/* Every face has its cells on both sides of it. */
static void nothing_is_folded(const struct vg_tets *t)
{
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && !(t->flag[c] & VG_DEAD); i++) {
      uint32_t link = t->cell[c].link[i];
      const uint32_t *v = t->cell[c].v;

      if (link == VG_NONE) continue;
      assert_true(vg_orient3d(t->x[v[vg_face[i][0]]], t->x[v[vg_face[i][1]]],
                              t->x[v[vg_face[i][2]]],
                              t->x[t->cell[link >> 2].v[link & 3]]) < 0);
    }
}

static void is_sound(const struct vg_tets *t)
{
  assert_int_equal(vg_tets_defects(t), 0);
  nothing_is_folded(t);
  assert_true(fabs(tets_volume(t) - 27) < 1e-10);
  for (size_t c = 0; c < t->n_cell; c++)
    assert_int_equal(t->flag[c] & (VG_MARK | VG_TRIED), 0);
}

/* Those of the triangles that are missing, in `missing`; returns their
 * number. */
static size_t missing_of(struct vg_tets *t, size_t n, const uint32_t (*tri)[3],
                         uint32_t *missing)
{
  uint8_t *is = vg_alloc(n, 1);
  size_t m = 0, n_missing;

  assert_non_null(is);
  for (size_t c = 0; c < t->n_cell; c++) t->flag[c] &= (uint8_t)~VG_FIXED_FACES;
  assert_int_equal(vg_boundary_fix(t, n, tri, is, &n_missing, NULL), VG_OK);
  for (size_t k = 0; k < n; k++)
    if (is[k]) missing[m++] = (uint32_t)k;
  assert_int_equal(m, n_missing);
  free(is);
  return m;
}

/* Recover by flips and return the number of missing triangles. Everything
 * reported must be true, and no existing one may be lost. */
static size_t left_of(struct vg_tets *t, size_t n, const uint32_t (*tri)[3],
                      size_t *lost)
{
  uint32_t *told = vg_alloc(n, sizeof *told), *again;
  size_t left;

  again = vg_alloc(n, sizeof *again);
  assert_true(told && again);
  *lost = left = missing_of(t, n, tri, told);
  assert_int_equal(vg_recover_flips(t, n, tri, &left, told, NULL), VG_OK);
  is_sound(t);
  assert_int_equal(missing_of(t, n, tri, again), left);
  assert_memory_equal(told, again, left * sizeof *told);
  free(told);
  free(again);
  return left;
}

/* --- one triangle among random points ------------------------------------ */

static double distance(const struct vg_tets *t, uint32_t a, uint32_t b)
{
  double d = 0;

  for (int k = 0; k < 3; k++)
    d += (t->x[a][k] - t->x[b][k]) * (t->x[a][k] - t->x[b][k]);
  return sqrt(d);
}

/* Three points closer to each other than `near`. */
static void choose(const struct vg_tets *t, double near, uint64_t *seed,
                   uint32_t v[3])
{
  do
    for (int k = 0; k < 3; k++)
      v[k] = 8 + (uint32_t)(tets_random(seed) * N_POINT);
  while (v[0] == v[1] || v[1] == v[2] || v[2] == v[0] ||
         distance(t, v[0], v[1]) > near || distance(t, v[1], v[2]) > near ||
         distance(t, v[2], v[0]) > near);
}

static void triangles_among_points(double height, double near)
{
  uint64_t seed = 11;
  size_t n_lost = 0, n_left = 0;

  for (uint64_t k = 0; k < 30; k++) {
    struct vg_tets t = VG_TETS_INIT;
    struct vg_boundary_report r = { 0 };
    uint32_t v[1][3];
    size_t lost;

    random_points(&t, N_POINT, height, 100 + k);
    choose(&t, near, &seed, v[0]);
    n_left += left_of(&t, 1, (const uint32_t(*)[3])v, &lost);
    n_lost += lost;
    assert_int_equal(vg_recover(&t, 1, (const uint32_t(*)[3])v, 1, 0, &r, NULL),
                     VG_OK);
    is_sound(&t);
    assert_int_equal(missing_of(&t, 1, (const uint32_t(*)[3])v, v[0]), 0);
    vg_tets_release(&t);
  }
  assert_true(n_lost > 10);
  assert_true(3 * n_left < n_lost);
}

static void small_triangles(void **state)
{
  (void)state;
  triangles_among_points(1, 0.25);
}

static void triangles_through_many_cells(void **state)
{
  (void)state;
  triangles_among_points(1, 0.5);
}

static void triangles_in_a_thin_sheet(void **state)
{
  (void)state;
  triangles_among_points(1e-3, 0.2);
}

/* --- surfaces ----------------------------------------------------------- */

/* A sheared sheet of nu x nv points, with quadrilaterals far longer than wide,
 * cut along one diagonal or the other: far from Delaunay. */
static size_t sheet(struct vg_tets *t, int nu, int nv, double bend,
                    uint32_t (*tri)[3])
{
  double(*x)[3] = vg_alloc((size_t)(nu * nv), sizeof *x);
  size_t n = 0;

  assert_non_null(x);
  for (int i = 0; i < nu; i++)
    for (int j = 0; j < nv; j++) {
      double u = (double)i / (nu - 1), v = (double)j / (nv - 1);

      x[i * nv + j][0] = u;
      x[i * nv + j][1] = v + 0.6 * u;
      x[i * nv + j][2] = bend * (u - 0.3) * v + bend * u * u;
    }
  insert_all(t, (size_t)(nu * nv), (const double(*)[3])x);
  for (int i = 0; i + 1 < nu; i++)
    for (int j = 0; j + 1 < nv; j++) {
      uint32_t a = 8 + (uint32_t)(i * nv + j), b = a + (uint32_t)nv;
      uint32_t v[2][3] = { { a, b, b + 1 }, { a, b + 1, a + 1 } };
      uint32_t w[2][3] = { { a, b, a + 1 }, { b, b + 1, a + 1 } };

      memcpy(tri[n], (i + j) % 2 ? v : w, sizeof v);
      n += 2;
    }
  free(x);
  return n;
}

static void a_stretched_sheet(void **state)
{
  static const double bend[3] = { 0, 0.02, 0.3 };
  static uint32_t tri[2 * 5 * 59][3];

  (void)state;
  for (int k = 0; k < 3; k++) {
    struct vg_tets t = VG_TETS_INIT;
    size_t n = sheet(&t, 6, 60, bend[k], tri), lost, left;

    left = left_of(&t, n, (const uint32_t(*)[3])tri, &lost);
    assert_true(4 * lost > n);
    assert_true(20 * left <= lost);
    vg_tets_release(&t);
  }
}

/* Schoenhardt's prisms in a row: tetrahedra on their points alone cannot
 * contain them. */
static void twisted_prisms_need_steiner_points(void **state)
{
  static uint32_t tri[5 * 8][3];
  struct vg_tets t = VG_TETS_INIT;
  struct vg_boundary_report r = { 0 };
  double x[5 * 6][3];
  size_t n = 0, n_point, lost, left;

  (void)state;
  needs_tetgen();
  for (uint32_t k = 0; k < 5; k++) {
    for (uint32_t i = 0; i < 6; i++) {
      double angle = 2 * M_PI / 3 * i + (i < 3 ? 0 : 0.2 + 0.15 * k);

      x[6 * k + i][0] = 0.3 * k + 0.1 * cos(angle);
      x[6 * k + i][1] = 0.1 * sin(angle);
      x[6 * k + i][2] = i < 3 ? 0 : 0.1 + 0.02 * k;
    }
    for (uint32_t i = 0; i < 3; i++) {
      uint32_t a = 8 + 6 * k + i, b = 8 + 6 * k + (i + 1) % 3;
      uint32_t v[2][3] = { { a, b + 3, b }, { a, a + 3, b + 3 } };

      memcpy(tri[n], v, sizeof v);
      n += 2;
    }
    for (uint32_t i = 0; i < 2; i++, n++)
      for (uint32_t m = 0; m < 3; m++)
        tri[n][m] = 8 + 6 * k + 3 * i + (i ? 2 - m : m);
  }
  insert_all(&t, 30, (const double(*)[3])x);
  n_point = t.n_point;
  left = left_of(&t, n, (const uint32_t(*)[3])tri, &lost);
  assert_in_range(left, 5, lost);
  assert_int_equal(t.n_point, n_point);
  assert_int_equal(vg_recover(&t, n, (const uint32_t(*)[3])tri, 1, 0, &r, NULL),
                   VG_OK);
  assert_true(r.n_face_left > 0 && r.n_steiner >= 5);
  is_sound(&t);
  vg_tets_release(&t);
}

static void the_same_cells_again(void **state)
{
  static uint32_t tri[2 * 7 * 39][3];
  struct vg_tets t[2] = { VG_TETS_INIT, VG_TETS_INIT };

  (void)state;
  for (int k = 0; k < 2; k++) {
    size_t n = sheet(&t[k], 8, 40, 0.1, tri), lost;

    left_of(&t[k], n, (const uint32_t(*)[3])tri, &lost);
    assert_true(lost > 100);
  }
  assert_int_equal(t[0].n_cell, t[1].n_cell);
  assert_memory_equal(t[0].flag, t[1].flag, t[0].n_cell);
  assert_memory_equal(t[0].cell, t[1].cell, t[0].n_cell * sizeof *t[0].cell);
  vg_tets_release(&t[0]);
  vg_tets_release(&t[1]);
}

/* --- obstacles ----------------------------------------------------------- */

static void signs_of_edges_near_a_triangle(void **state)
{
  static double x[9][3] = { { 0, 0, 0 },  { 4, 0, 0 },
                            { 0, 4, 0 },                 /* triangle */
                            { 1, 1, -1 }, { 1, 1, 1 },   /* through it */
                            { 5, 5, 1 },                 /* next to it */
                            { 2, 0, 0 },                 /* on its edge */
                            { 1, 1, 0 },  { 8, 8, 0 } }; /* in its plane */
  struct vg_tets t = { .n_point = 9, .x = x };
  struct vg_flipper f = { .t = &t };

  (void)state;
  f.n_target = 3;
  f.target[1] = 1;
  f.target[2] = 2;
  assert_true(vg_flip_pierces(&f, 3, 4));
  assert_true(vg_flip_pierces(&f, 4, 3));
  assert_false(vg_flip_pierces(&f, 4, 5));
  assert_false(vg_flip_pierces(&f, 0, 4));
  assert_false(vg_flip_pierces(&f, 7, 8));
  f.n_target = 2;
  f.target[0] = 3;
  f.target[1] = 4;
  assert_true(vg_flip_obstructs(&f, 0, 1, 2));
  assert_true(vg_flip_obstructs(&f, 2, 1, 0));
  assert_false(vg_flip_obstructs(&f, 3, 4, 5));
  assert_false(vg_flip_obstructs(&f, 0, 1, 6));
  f.target[0] = 0; /* from a corner, through 1 2 in their plane */
  f.target[1] = 8;
  assert_true(vg_flip_obstructs(&f, 0, 1, 2));
  assert_true(vg_flip_obstructs(&f, 2, 0, 1));
  f.target[1] = 7; /* ends before it */
  assert_false(vg_flip_obstructs(&f, 0, 1, 2));
  f.target[1] = 4; /* leaves the plane */
  assert_false(vg_flip_obstructs(&f, 0, 1, 2));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(small_triangles),
    cmocka_unit_test(triangles_through_many_cells),
    cmocka_unit_test(triangles_in_a_thin_sheet),
    cmocka_unit_test(a_stretched_sheet),
    cmocka_unit_test(twisted_prisms_need_steiner_points),
    cmocka_unit_test(the_same_cells_again),
    cmocka_unit_test(signs_of_edges_near_a_triangle),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
