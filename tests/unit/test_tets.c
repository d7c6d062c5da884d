/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cells with their neighbours: links, location, housekeeping; the Hilbert curve
 * and the sort along it. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tets_support.h"

static const int four_cubed[3] = { 4, 4, 4 };

/* Whether cell c contains x, faces included. */
static int holds(const struct vg_tets *t, uint32_t c, const double x[3])
{
  const uint32_t *v = t->cell[c].v;

  for (int i = 0; i < 4; i++)
    if (vg_orient3d(t->x[v[vg_face[i][0]]], t->x[v[vg_face[i][1]]],
                    t->x[v[vg_face[i][2]]], x) < 0)
      return 0;
  return 1;
}

/* --- links -------------------------------------------------------------- */

static void a_face_sees_its_vertex(void **state)
{
  struct vg_tets t = VG_TETS_INIT;

  (void)state;
  tets_box(&t, 0, 1);
  for (uint32_t c = 0; c < 5; c++) {
    const uint32_t *v = t.cell[c].v;

    for (int i = 0; i < 4; i++)
      assert_true(vg_orient3d(t.x[v[vg_face[i][0]]], t.x[v[vg_face[i][1]]],
                              t.x[v[vg_face[i][2]]], t.x[v[i]]) > 0);
  }
  vg_tets_release(&t);
}

static void adopted_cells_are_turned_and_linked(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  int n_inner[5] = { 0 };

  (void)state;
  tets_box(&t, 0, 1); /* given in either orientation */
  assert_int_equal(t.n_cell, 5);
  assert_int_equal(t.n_point, 8);
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_true(fabs(tets_volume(&t) - 1) < 1e-15);
  for (int c = 0; c < 5; c++)
    for (int i = 0; i < 4; i++) n_inner[c] += t.cell[c].link[i] != VG_NONE;
  for (int c = 0; c < 4; c++) assert_int_equal(n_inner[c], 1);
  assert_int_equal(n_inner[4], 4);
  vg_tets_release(&t);
}

static void a_grid_is_linked_face_by_face(void **state)
{
  const int n[3] = { 7, 5, 3 };
  struct vg_tets t = VG_TETS_INIT;
  size_t n_hull = 0;

  (void)state;
  tets_grid(&t, n);
  assert_int_equal(t.n_cell, 6 * 105);
  assert_int_equal(vg_tets_defects(&t), 0);
  for (size_t c = 0; c < t.n_cell; c++)
    for (int i = 0; i < 4; i++) n_hull += t.cell[c].link[i] == VG_NONE;
  assert_int_equal(n_hull, 2 * 2 * (35 + 15 + 21));
  vg_tets_release(&t);
}

static void a_flat_cell_is_refused(void **state)
{
  const uint32_t v[2][4] = { { 0, 1, 2, 4 }, { 0, 1, 2, 3 } };
  struct vg_tets t = VG_TETS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double(*x)[3] = vg_calloc(5, sizeof *x);

  (void)state;
  assert_non_null(x);
  x[1][0] = x[2][1] = x[3][0] = x[3][1] = x[4][2] = 1;
  assert_int_equal(vg_tets_from_cells(&t, 5, x, 2, v, &err), VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "flat"));
  vg_tets_release(&t); /* x still belongs to t: a leak otherwise */
}

static void three_cells_on_a_face_are_refused(void **state)
{
  const uint32_t v[3][4] = { { 0, 1, 2, 3 }, { 0, 1, 2, 4 }, { 0, 1, 2, 5 } };
  struct vg_tets t = VG_TETS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double(*x)[3] = vg_calloc(6, sizeof *x);

  (void)state;
  assert_non_null(x);
  x[1][0] = x[2][1] = x[3][2] = 1;
  x[4][2] = -1;
  x[5][2] = 2;
  assert_int_equal(vg_tets_from_cells(&t, 6, x, 3, v, &err), VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "1 2 3"));
  vg_tets_release(&t);
}

static void defects_are_detected(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  uint32_t *v, keep;

  (void)state;
  tets_box(&t, 0, 1);
  v = t.cell[2].v;
  keep = v[0];
  v[0] = v[1];
  v[1] = keep;
  assert_true(vg_tets_defects(&t) > 0);
  v[1] = v[0];
  v[0] = keep;
  assert_int_equal(vg_tets_defects(&t), 0);
  keep = t.cell[4].link[1];
  t.cell[4].link[1] = t.cell[4].link[2];
  assert_true(vg_tets_defects(&t) > 0);
  t.cell[4].link[1] = keep;
  t.flag[4] |= 4; /* constrained on one side only */
  assert_int_equal(vg_tets_defects(&t), 2);
  t.flag[4] = 0;
  t.flag[0] = VG_DEAD; /* still a neighbour of another cell */
  assert_int_equal(vg_tets_defects(&t), 1);
  vg_tets_release(&t);
}

/* --- slots -------------------------------------------------------------- */

static void dead_slots_are_used_last_in_first_out(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  size_t cap;

  (void)state;
  tets_grid(&t, four_cubed);
  cap = t.cap_cell;
  for (uint32_t c = 3; c < 9; c++)
    assert_int_equal(vg_tets_free_cell(&t, c), 0);
  assert_int_equal(t.n_free, 6);
  for (uint32_t c = 3; c < 9; c++) assert_int_equal(t.flag[c], VG_DEAD);
  assert_int_equal(vg_tets_reserve_cells(&t, 6), 0);
  assert_int_equal(t.cap_cell, cap);
  for (uint32_t c = 8; c >= 3; c--) assert_int_equal(vg_tets_alloc_cell(&t), c);
  assert_int_equal(t.n_free, 0);
  assert_int_equal(vg_tets_reserve_cells(&t, 1), 0);
  assert_int_equal(vg_tets_alloc_cell(&t), 384);
  assert_int_equal(t.n_cell, 385);
  assert_true(t.cap_cell >= 385);
  assert_int_equal(vg_tets_reserve_cells(&t, VG_CELL_MAX), -1);
  assert_int_equal(t.n_cell, 385);
  vg_tets_release(&t);
}

/* --- location ----------------------------------------------------------- */

static void points_are_found_from_anywhere(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  uint64_t seed = 1;

  (void)state;
  tets_grid(&t, four_cubed);
  for (int k = 0; k < 4000; k++) {
    uint32_t start = (uint32_t)(tets_random(&seed) * 384), c;
    double x[3];

    for (int j = 0; j < 3; j++) {
      x[j] = 4 * tets_random(&seed);
      if (k % 2) x[j] = floor(4 * x[j] + 0.5) / 4; /* corners, edges, faces */
    }
    c = vg_tets_locate(&t, start, x);
    assert_true(c < t.n_cell);
    assert_true(holds(&t, c, x));
  }
  vg_tets_release(&t);
}

static void points_outside_are_not_located(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  uint64_t seed = 2;

  (void)state;
  tets_grid(&t, four_cubed);
  for (int k = 0; k < 2000; k++) {
    uint32_t start = (uint32_t)(tets_random(&seed) * 384);
    double x[3], by = k % 2 ? 1e-12 : 3;

    for (int j = 0; j < 3; j++) x[j] = 4 * tets_random(&seed);
    x[k % 3] = k % 4 < 2 ? -by : 4 + by;
    assert_int_equal(vg_tets_locate(&t, start, x), VG_NONE);
  }
  vg_tets_release(&t);
}

static void constraints_do_not_stop_the_walk(void **state)
{
  struct vg_tets t = VG_TETS_INIT;
  uint64_t seed = 3;

  (void)state;
  tets_grid(&t, four_cubed);
  memset(t.flag, VG_FIXED_FACES, t.n_cell);
  for (int k = 0; k < 500; k++) {
    double x[3];
    uint32_t c;

    for (int j = 0; j < 3; j++) x[j] = 4 * tets_random(&seed);
    c = vg_tets_locate(&t, 0, x);
    assert_true(c != VG_NONE && holds(&t, c, x));
  }
  vg_tets_release(&t);
}

/* --- tidy --------------------------------------------------------------- */

static int in_corner(const struct vg_tets *t, size_t c)
{
  for (int i = 0; i < 4; i++) {
    const double *x = t->x[t->cell[c].v[i]];

    if (x[0] > 2 || x[1] > 2 || x[2] > 2) return 0;
  }
  return 1;
}

/* One cube of eight is outside, one slot is dead: points of the kept range
 * stay, other unused points are removed, and everything else is renumbered
 * consistently. */
static void tidy_keeps_cells_inside(void **state)
{
  enum { N_KEEP = 28 };
  struct vg_tets t = VG_TETS_INIT;
  double keep[N_KEEP][3];
  size_t n_fixed = 0;
  uint32_t high = 0;

  (void)state;
  tets_grid(&t, four_cubed);
  memcpy(keep, t.x, sizeof keep);
  assert_int_equal(vg_tets_reserve_cells(&t, 1), 0);
  assert_int_equal(vg_tets_free_cell(&t, vg_tets_alloc_cell(&t)), 0);
  for (size_t c = 0; c < 384; c++)
    if (in_corner(&t, c)) {
      t.flag[c] = VG_OUTSIDE;
      for (int i = 0; i < 4; i++) {
        uint32_t link = t.cell[c].link[i];

        if (link == VG_NONE || in_corner(&t, link >> 2)) continue;
        t.flag[c] |= (uint8_t)(1 << i);
        t.flag[link >> 2] |= (uint8_t)(1 << (link & 3));
      }
    }
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_int_equal(vg_tets_compact(&t, N_KEEP, NULL), VG_OK);
  assert_int_equal(t.n_cell, 384 - 48);
  assert_int_equal(t.n_free, 0);
  assert_memory_equal(t.x, keep, sizeof keep);
  /* eight points, x + 5 y + 25 z with x, y, z below 2, lost all their cells;
   * two of them, 30 and 31, are not in the kept range */
  assert_int_equal(t.n_point, 125 - 2);
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_true(fabs(tets_volume(&t) - 56) < 1e-12);
  for (size_t c = 0; c < t.n_cell; c++) {
    uint32_t top = 0;

    for (int i = 0; i < 4; i++) {
      top = t.cell[c].v[i] > top ? t.cell[c].v[i] : top;
      n_fixed += t.flag[c] >> i & 1;
      if (t.flag[c] >> i & 1) assert_int_equal(t.cell[c].link[i], VG_NONE);
    }
    assert_true(top >= high);
    high = top;
  }
  assert_int_equal(n_fixed, 3 * 2 * 4);
  vg_tets_release(&t);
}

/* --- the curve ---------------------------------------------------------- */

/* 8 x 8 x 8 boxes of 2^20 / 8 cells (coarse) or of one cell: the curve visits
 * all of them, each step into a box that shares a face. */
static void walk_the_curve(int shift, double box)
{
  const double lo[3] = { 0, 0, 0 };
  int where[512][3], seen[512] = { 0 };
  uint64_t first = UINT64_MAX;

  for (int i = 0; i < 512; i++) {
    double x[3] = { (i % 8 + 0.5) * box, (i / 8 % 8 + 0.5) * box,
                    (i / 64 + 0.5) * box };
    uint64_t key = vg_hilbert_key(x, lo, 1) >> shift;

    first = key < first ? key : first;
  }
  for (int i = 0; i < 512; i++) {
    int at[3] = { i % 8, i / 8 % 8, i / 64 };
    double x[3] = { (at[0] + 0.5) * box, (at[1] + 0.5) * box,
                    (at[2] + 0.5) * box };
    uint64_t key = (vg_hilbert_key(x, lo, 1) >> shift) - first;

    assert_true(key < 512);
    assert_int_equal(seen[key]++, 0);
    memcpy(where[key], at, sizeof at);
  }
  for (int k = 1; k < 512; k++)
    assert_int_equal(abs(where[k][0] - where[k - 1][0]) +
                       abs(where[k][1] - where[k - 1][1]) +
                       abs(where[k][2] - where[k - 1][2]),
                     1);
}

static void the_curve_steps_to_neighbours(void **state)
{
  (void)state;
  walk_the_curve(51, 1 << 17);
  walk_the_curve(0, 1);
}

static void keys_are_clamped(void **state)
{
  const double lo[3] = { 0, 0, 0 }, below[3] = { -5, -1e300, NAN };
  const double end = (1 << 20) - 1;
  const double top[3] = { end, end, end },
               above[3] = { 1e9, INFINITY, end + 7 };

  (void)state;
  assert_true(vg_hilbert_key(below, lo, 1) == vg_hilbert_key(lo, lo, 1));
  assert_true(vg_hilbert_key(above, lo, 1) == vg_hilbert_key(top, lo, 1));
  assert_true(vg_hilbert_key(top, lo, 1) >> 60 == 0);
}

/* --- sort and orders ---------------------------------------------------- */

static int by_key_then_index(const void *a, const void *b)
{
  const struct vg_key *p = a, *q = b;

  if (p->key != q->key) return p->key < q->key ? -1 : 1;
  return p->index < q->index ? -1 : p->index > q->index;
}

static void sort_both(size_t n, uint64_t mask, uint64_t seed)
{
  struct vg_key *key = vg_calloc(n, sizeof *key);
  struct vg_key *want = vg_calloc(n, sizeof *want);

  assert_true(key && want);
  for (size_t i = 0; i < n; i++) {
    uint64_t high = (uint64_t)(tets_random(&seed) * 0x1p32);

    key[i].key = (high << 32 | (uint64_t)(tets_random(&seed) * 0x1p32)) & mask;
    key[i].index = (uint32_t)i;
  }
  memcpy(want, key, n * sizeof *key);
  qsort(want, n, sizeof *want, by_key_then_index);
  assert_int_equal(vg_sort_keys(n, key, NULL), VG_OK);
  for (size_t i = 0; i < n; i++)
    assert_true(key[i].key == want[i].key && key[i].index == want[i].index);
  free(key);
  free(want);
}

static void the_sort_is_that_of_qsort(void **state)
{
  static const uint64_t mask[7] = { UINT64_MAX, 0,
                                    1,          0xff00000000000000u,
                                    0x7ff,      0x00fff00000001000u,
                                    0xffffffffu };
  static const size_t n[6] = { 0, 1, 2, 3, 100, 20000 };

  (void)state;
  for (int i = 0; i < 7; i++)
    for (int k = 0; k < 6; k++) sort_both(n[k], mask[i], 77);
}

static double path(size_t n, const double (*x)[3], const uint32_t *order)
{
  double sum = 0;

  for (size_t i = 1; i < n; i++) {
    const double *a = x[order[i - 1]], *b = x[order[i]];

    sum += sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
  }
  return sum;
}

static void is_permutation(size_t n, const uint32_t *order)
{
  uint8_t *seen = vg_calloc(n, 1);

  assert_non_null(seen);
  for (size_t i = 0; i < n; i++) {
    assert_true(order[i] < n);
    assert_int_equal(seen[order[i]]++, 0);
  }
  free(seen);
}

static void orders_are_permutations_of_short_path(void **state)
{
  enum { N = 8000 };
  double(*x)[3] = vg_alloc(N, sizeof *x);
  uint32_t *order = vg_alloc(N, sizeof *order);
  uint32_t *again = vg_alloc(N, sizeof *again);
  uint64_t seed = 5;

  (void)state;
  assert_true(x && order && again);
  for (int i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) x[i][k] = 7 + 20 * tets_random(&seed);
  for (size_t n = 0; n <= N; n = n ? 20 * n : 1) {
    assert_int_equal(vg_hilbert_order(n, (const double(*)[3])x, order, NULL),
                     VG_OK);
    is_permutation(n, order);
    assert_int_equal(vg_insertion_order(n, (const double(*)[3])x, again, NULL),
                     VG_OK);
    is_permutation(n, again);
  }
  /* Mean distance of neighbours is about 20 / N^(1/3) = 1, of two points at
   * random 13. */
  assert_true(path(N, (const double(*)[3])x, order) < 2 * N);
  assert_true(path(N, (const double(*)[3])x, again) < 2 * N);
  for (int i = 0; i < N; i++)
    memcpy(x[i], x[0], sizeof *x); /* all coincident */
  assert_int_equal(vg_hilbert_order(N, (const double(*)[3])x, order, NULL),
                   VG_OK);
  for (uint32_t i = 0; i < N; i++) assert_int_equal(order[i], i);
  free(x);
  free(order);
  free(again);
}

/* The first eighth of the order is spread over the whole cube: every eighth of
 * the cube has its share. */
static void insertion_order_starts_spread_out(void **state)
{
  enum { N = 32768 };
  double(*x)[3] = vg_alloc(N, sizeof *x);
  uint32_t *order = vg_alloc(N, sizeof *order);
  uint64_t seed = 6;
  int count[8] = { 0 };

  (void)state;
  assert_true(x && order);
  for (int i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) x[i][k] = tets_random(&seed);
  assert_int_equal(vg_insertion_order(N, (const double(*)[3])x, order, NULL),
                   VG_OK);
  for (int i = 0; i < N / 8 - 100; i++) {
    const double *at = x[order[i]];

    count[(at[0] > 0.5) + 2 * (at[1] > 0.5) + 4 * (at[2] > 0.5)]++;
  }
  for (int k = 0; k < 8; k++) assert_in_range(count[k], 250, 650);
  free(x);
  free(order);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_face_sees_its_vertex),
    cmocka_unit_test(adopted_cells_are_turned_and_linked),
    cmocka_unit_test(a_grid_is_linked_face_by_face),
    cmocka_unit_test(a_flat_cell_is_refused),
    cmocka_unit_test(three_cells_on_a_face_are_refused),
    cmocka_unit_test(defects_are_detected),
    cmocka_unit_test(dead_slots_are_used_last_in_first_out),
    cmocka_unit_test(points_are_found_from_anywhere),
    cmocka_unit_test(points_outside_are_not_located),
    cmocka_unit_test(constraints_do_not_stop_the_walk),
    cmocka_unit_test(tidy_keeps_cells_inside),
    cmocka_unit_test(the_curve_steps_to_neighbours),
    cmocka_unit_test(keys_are_clamped),
    cmocka_unit_test(the_sort_is_that_of_qsort),
    cmocka_unit_test(orders_are_permutations_of_short_path),
    cmocka_unit_test(insertion_order_starts_spread_out),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
