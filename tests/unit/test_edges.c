/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edges of triangulations, compared with a comparison of all half-edges. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/mesh/edges.h"

enum { POINTS = 40, TRIS = 120, OUT = 4 };

static uint32_t draw(uint64_t *seed, uint32_t n)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (uint32_t)((*seed >> 33) % n);
}

/* Both ends of half-edge h, the lower one first. */
static void ends(const uint32_t (*side)[2], uint32_t h, uint32_t end[2])
{
  const uint32_t a = side[h][0], b = side[h][1];

  end[0] = a < b ? a : b;
  end[1] = a < b ? b : a;
}

static int compare(const uint32_t a[2], const uint32_t b[2])
{
  if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
  return (a[1] > b[1]) - (a[1] < b[1]);
}

/* Edges are in ascending order; each has all half-edges with its ends, in
 * ascending order too. */
static void expect_edges(const struct vg_edges *e, size_t n,
                         const uint32_t (*side)[2], const uint8_t *is_out)
{
  size_t n_in = 0;

  for (uint32_t h = 0; h < n; h++) n_in += !is_out[h];
  assert_int_equal(e->start[e->n], n_in);
  for (size_t i = 0; i < e->n; i++) {
    const uint32_t *half = vg_edges_at(e, i);
    uint32_t end[2], before[2], k = 0;

    ends(side, half[0], end);
    if (i) ends(side, vg_edges_at(e, i - 1)[0], before);
    assert_true(!i || compare(before, end) < 0);
    for (uint32_t h = 0; h < n; h++) {
      uint32_t own[2];

      ends(side, h, own);
      if (is_out[h] || compare(own, end)) continue;
      assert_true(k < vg_edges_count(e, i));
      assert_int_equal(half[k++], h);
      assert_int_equal(e->of_half[h], i);
    }
    assert_int_equal(k, vg_edges_count(e, i));
  }
  for (uint32_t h = 0; h < n; h++)
    if (is_out[h]) assert_int_equal(e->of_half[h], UINT32_MAX);
}

/* From few points, so that edges have up to thirty half-edges and some have
 * both ends at one point, to many points, most of which have no edges; with and
 * without excluded triangles. */
static void edges_agree_with_a_brute_force_list(void **state)
{
  uint64_t seed = 1;

  (void)state;
  for (uint32_t n_point = 3; n_point <= POINTS; n_point++)
    for (int with_state = 0; with_state < 2; with_state++) {
      uint32_t tri[TRIS][3], side[3 * TRIS][2];
      uint8_t mark[TRIS], is_out[3 * TRIS];
      struct vg_edges e = VG_EDGES_INIT;
      struct vg_error err = VG_ERROR_INIT;

      for (uint32_t t = 0; t < TRIS; t++) {
        for (int k = 0; k < 3; k++) tri[t][k] = draw(&seed, n_point);
        mark[t] = (uint8_t)draw(&seed, 8);
      }
      for (uint32_t h = 0; h < 3 * TRIS; h++) {
        side[h][0] = vg_half_from((const uint32_t(*)[3])tri, h);
        side[h][1] = vg_half_to((const uint32_t(*)[3])tri, h);
        is_out[h] = with_state && mark[h / 3] & OUT;
      }
      assert_int_equal(vg_edges_build(&e, n_point, TRIS,
                                      (const uint32_t(*)[3])tri,
                                      with_state ? mark : NULL, OUT, &err),
                       VG_OK);
      expect_edges(&e, 3 * TRIS, (const uint32_t(*)[2])side, is_out);
      vg_edges_release(&e);

      memset(is_out, 0, sizeof is_out);
      assert_int_equal(vg_edges_build_sides(&e, n_point, 3 * TRIS,
                                            (const uint32_t(*)[2])side, &err),
                       VG_OK);
      expect_edges(&e, 3 * TRIS, (const uint32_t(*)[2])side, is_out);
      vg_edges_release(&e);
    }
}

static void no_triangles_have_no_edges(void **state)
{
  struct vg_edges e = VG_EDGES_INIT;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_edges_build(&e, 0, 0, NULL, NULL, 0, &err), VG_OK);
  assert_int_equal(e.n, 0);
  vg_edges_release(&e);
  assert_int_equal(vg_edges_build_sides(&e, 5, 0, NULL, &err), VG_OK);
  assert_int_equal(e.n, 0);
  assert_int_equal(e.start[0], 0);
  vg_edges_release(&e);
  vg_edges_release(&e);
}

/* A tetrahedron with its faces outward, then with one of them inward. */
static void neighbours_agree_or_not(void **state)
{
  uint32_t tri[4][3] = { { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 2, 0, 3 } };
  const uint32_t(*t)[3] = (const uint32_t(*)[3])tri;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (int turned = 0; turned < 2; turned++) {
    struct vg_edges e = VG_EDGES_INIT;
    int n = 0;

    if (turned) tri[3][0] = 0, tri[3][1] = 2;
    assert_int_equal(vg_edges_build(&e, 4, 4, t, NULL, 0, &err), VG_OK);
    assert_int_equal(e.n, 6);
    for (size_t i = 0; i < e.n; i++) {
      assert_int_equal(vg_edges_count(&e, i), 2);
      n += vg_edges_disagree(&e, t, i);
    }
    assert_int_equal(n, turned ? 3 : 0);
    vg_edges_release(&e);
  }
}

static void half_edges_go_round_a_triangle(void **state)
{
  (void)state;
  for (uint32_t h = 0; h < 9; h++) {
    assert_int_equal(vg_half_next(h) / 3, h / 3);
    assert_int_equal(vg_half_next(h) % 3, (h % 3 + 1) % 3);
    assert_int_equal(vg_half_prev(vg_half_next(h)), h);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(edges_agree_with_a_brute_force_list),
    cmocka_unit_test(no_triangles_have_no_edges),
    cmocka_unit_test(neighbours_agree_or_not),
    cmocka_unit_test(half_edges_go_round_a_triangle),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
