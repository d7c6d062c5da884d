/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh check of slices: the report equals that of vg_mesh_judge for any
 * cut, number of threads and damage. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "judge_support.h"
#include "mixed_cut.h"

static void judge_cut(struct cut *c, const struct vg_sizing *sizing,
                      int threads, uint64_t front, struct vg_mesh_report *r,
                      struct vg_mesh_report *field)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_slices_judge_with(NULL, &c->s, front, sizing, threads, NULL, 1, NULL,
                           NULL, r, field, &err) < 0)
    fail_msg("%s", err.text);
}

/* Any cut of m, on 1 and 3 threads, compared with the mesh in one piece. */
static void check_cuts(const struct vg_mesh *m, const struct vg_sizing *sizing,
                       struct vg_mesh_report *whole)
{
  static const size_t n_slice[] = { 1, 2, 7, 40 };
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_mesh_judge(m, sizing, whole, &err), VG_OK);
  assert_int_equal(vg_mesh_judge_dual(m, whole, &err), VG_OK);
  assert_int_equal(whole->has_dual, whole->is_valid);
  for (size_t i = 0; i < sizeof n_slice / sizeof *n_slice; i++) {
    struct cut c;

    cut_make(&c, m, n_slice[i], 0, NULL, 17 + i);
    for (int threads = 1; threads < 4; threads += 2) {
      struct vg_mesh_report r;

      judge_cut(&c, sizing, threads, 0, &r, NULL);
      assert_same_report(&r, whole);
      assert_int_equal(r.has_solver, r.is_valid);
    }
    cut_release(&c);
  }
}

static void tetrahedra_in_slices(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_sizing *sizing = shape_sizing(&m, 1.5, 0);
  struct vg_mesh_report r;

  (void)state;
  check_cuts(&m, NULL, &r);
  assert_true(r.is_valid);
  assert_int_equal(r.n_component, 1);
  assert_int_equal(r.has_sizing, 0);
  check_cuts(&m, sizing, &r);
  assert_int_equal(r.has_sizing, 1);
  assert_true(r.edge_mean > 0.1 && r.edge_mean < 10);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

static void mixed_cells_in_slices(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_MIXED);
  struct vg_sizing *sizing = shape_sizing(&m, 1.5, 0);
  struct vg_mesh_report r;

  (void)state;
  assert_true(m.n_pri > 100 && m.n_pyr > 10);
  check_cuts(&m, sizing, &r);
  assert_true(r.is_valid);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

/* Slices of kind 0 are layers, the others are the isotropic region. Compared
 * with a mesh of only the latter's cells, bounded by their faces without a
 * neighbour. */
static void check_field(const struct vg_mesh *m, const struct vg_sizing *sizing)
{
  struct vg_mesh_report whole, field, want, want_field;
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;
  struct vg_mesh part;

  cut_make(&c, m, 11, 0, NULL, 3);
  part = judge_field(&c);
  assert_int_equal(vg_mesh_judge(m, NULL, &want, &err), VG_OK);
  assert_int_equal(vg_mesh_judge_dual(m, &want, &err), VG_OK);
  assert_int_equal(vg_mesh_judge(&part, sizing, &want_field, &err), VG_OK);
  judge_cut(&c, sizing, 2, part.n_tri + part.n_quad, &whole, &field);
  assert_same_report(&whole, &want);
  /* cell numbers are those in the whole mesh, and the volume enclosed by the
   * boundary of the isotropic region is not computed */
  judge_map_worst(&c, &want_field);
  assert_true(want_field.volume_error < 1e-12);
  want_field.enclosed = want_field.volume;
  want_field.volume_error = 0;
  assert_same_report(&field, &want_field);
  assert_true(field.is_valid);
  judge_cut(&c, sizing, 2, part.n_tri + part.n_quad + 3, &whole, &field);
  assert_int_equal(field.open_face, 3);
  assert_false(field.is_valid);
  cut_release(&c);
  vg_mesh_release(&part);
}

/* Slices without tetrahedra, and faces between all kinds of cells. */
static void hexahedra_in_slices(void **state)
{
  struct vg_join_info info;
  struct vg_mesh_report r;
  struct vg_mesh m;
  uint32_t *h, t;

  (void)state;
  mixed_cut_mesh(&m, &info);
  assert_true(m.n_hex > 100 && m.n_pyr > 100);
  check_cuts(&m, NULL, &r);
  assert_true(r.is_valid);
  assert_int_equal(r.n_component, 1);
  check_field(&m, NULL);
  h = m.hex[m.n_hex / 2]; /* inverted */
  for (int k = 0; k < 8; k += 4)
    t = h[k + 1], h[k + 1] = h[k + 3], h[k + 3] = t;
  check_cuts(&m, NULL, &r);
  assert_int_equal(r.not_positive, 1);
  m.n_hex--; /* and a missing one */
  check_cuts(&m, NULL, &r);
  assert_int_equal(r.open_face + r.orphan_boundary, 6);
  m.n_tet = m.n_pyr = m.n_pri = 0;
  check_cuts(&m, NULL, &r);
  assert_int_equal(r.n_cell, m.n_hex);
  vg_mesh_release(&m);
}

/* Every face of duplicated cells has an even number of sides, except for some
 * on the boundary. */
static void cells_several_times_over(void **state)
{
  (void)state;
  for (size_t times = 2; times <= 3; times++) {
    struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
    size_t n = m.n_tet;
    struct vg_mesh_report whole, r;
    struct vg_error err = VG_ERROR_INIT;
    struct cut c;

    m.tet = vg_realloc(m.tet, times * n, sizeof *m.tet);
    for (size_t k = 1; k < times; k++)
      memcpy(m.tet + k * n, m.tet, n * sizeof *m.tet);
    m.n_tet = times * n;
    assert_int_equal(vg_mesh_judge(&m, NULL, &whole, &err), VG_OK);
    assert_false(whole.is_valid);
    for (size_t n_slice = 1; n_slice < 40; n_slice += 6) {
      cut_make(&c, &m, n_slice, 0, NULL, 5);
      judge_cut(&c, NULL, 2, 0, &r, NULL);
      assert_false(r.is_valid);
      cut_release(&c);
    }
    vg_mesh_release(&m);
  }
}

/* Quadrilaterals on the boundary, and prisms alone: no angles. */
static void prisms_in_slices(void **state)
{
  struct vg_mesh m = judge_prisms(5, 4, 3);
  struct vg_mesh_report r;

  (void)state;
  assert_true(m.n_quad > 0 && m.n_tri > 0);
  check_cuts(&m, NULL, &r);
  assert_true(r.is_valid);
  vg_mesh_release(&m);
}

static void slices_count_every_defect_equally(void **state)
{
  (void)state;
  for (int damage = 0; damage < JUDGE_DAMAGES; damage++)
    for (int cells = 0; cells < 2; cells++)
      for (uint32_t at = 0; at < 3; at += 2) {
        struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS);
        struct vg_mesh_report r;

        judge_damage(&m, damage, at);
        check_cuts(&m, NULL, &r);
        assert_false(r.is_valid);
        assert_true(judge_faults(&r) > 0);
        vg_mesh_release(&m);
      }
}

/* Two blocks and a third that touches one along an edge only. */
static void components_are_those_of_the_whole(void **state)
{
  struct vg_mesh m = judge_prisms(6, 6, 6);
  struct vg_mesh_report r;

  (void)state;
  judge_take_layer(&m, 6, 2);
  check_cuts(&m, NULL, &r);
  assert_int_equal(r.n_component, 2);
  vg_mesh_release(&m);
}

static void the_isotropic_region_is_checked_separately(void **state)
{
  (void)state;
  for (int cells = 0; cells < 2; cells++) {
    struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS);
    struct vg_sizing *sizing = shape_sizing(&m, 1.5, 0);

    check_field(&m, sizing);
    vg_sizing_free(sizing);
    vg_mesh_release(&m);
  }
}

/* 65,536 prisms in random order: nearly all of their faces are between slices,
 * of which many join cells of the same region and are matched early. */
static void many_faces_are_between_slices(void **state)
{
  struct vg_mesh m = judge_prisms(32, 32, 32);
  struct vg_mesh_report r;
  uint64_t seed = 1;

  (void)state;
  for (size_t k = m.n_pri; k-- > 1;) {
    size_t with = model_random(&seed) % (k + 1);
    uint32_t prism[6];

    memcpy(prism, m.pri[k], sizeof prism);
    memcpy(m.pri[k], m.pri[with], sizeof prism);
    memcpy(m.pri[with], prism, sizeof prism);
  }
  check_cuts(&m, NULL, &r);
  assert_true(r.is_valid);
  assert_int_equal(r.n_component, 1);
  check_field(&m, NULL);
  memcpy(m.pri[m.n_pri - 1], m.pri[m.n_pri / 2], sizeof *m.pri);
  check_cuts(&m, NULL, &r);
  assert_true(r.crowded_face > 0);
  vg_mesh_release(&m);
}

static void points_that_are_not_finite(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_mesh_report r;

  (void)state;
  m.point[7][1] = NAN;
  m.point[m.n_point - 1][2] = -INFINITY;
  check_cuts(&m, NULL, &r);
  assert_int_equal(r.not_finite, 2);
  vg_mesh_release(&m);
}

static struct cut *inner; /* slices that spoil_get damages */

static vg_status spoil_get(const struct vg_slices *s, size_t i,
                           struct vg_slice *out, struct vg_error *err)
{
  vg_status st = cut_get(&inner->s, i, out, err);

  (void)s;
  if (st < 0 || i != 1) return st;
  memcpy((void *)(uintptr_t)(out->cell[VG_SLICE_TET] + 2), &out->n_point, 4);
  memset((void *)(uintptr_t)(out->id + 3), 0xff, 4);
  return VG_OK;
}

static void spoil_put(const struct vg_slices *s, struct vg_slice *slice)
{
  (void)s;
  cut_put(&inner->s, slice);
}

static void indices_that_point_nowhere(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_mesh_report r;
  struct vg_slices s;
  struct cut c;

  (void)state;
  cut_make(&c, &m, 4, 0, NULL, 5);
  inner = &c;
  s = c.s;
  s.get = spoil_get;
  s.put = spoil_put;
  assert_int_equal(vg_slices_judge(NULL, &s, 0, NULL, 2, &r, NULL, NULL),
                   VG_OK);
  assert_false(r.is_valid);
  assert_true(r.bad_index >= 2);
  assert_int_equal(r.n_cell, m.n_tet);
  m.tri[5][1] = (uint32_t)m.n_point;
  judge_cut(&c, NULL, 1, 0, &r, NULL);
  assert_int_equal(r.bad_index, 1);
  assert_false(r.is_valid);
  cut_release(&c);
  vg_mesh_release(&m);
}

static void failures_are_reported(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;

  (void)state;
  memset(&r, 0x5a, sizeof r);
  cut_make(&c, &m, 6, 0, NULL, 5);
  c.bad = 4;
  assert_int_equal(vg_slices_judge(NULL, &c.s, 0, NULL, 2, &r, NULL, &err),
                   VG_ERR_IO);
  assert_string_equal(err.text, "slice 4 is bad");
  c.bad = SIZE_MAX;
  c.s.n_cell[VG_SLICE_PRI]++;
  assert_int_equal(vg_slices_judge(NULL, &c.s, 0, NULL, 2, &r, NULL, &err),
                   VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "prisms"));
  assert_true(((unsigned char *)&r)[9] == 0x5a);
  cut_release(&c);
  vg_mesh_release(&m);
}

static vg_status count_cells(void *context, const struct vg_slice *slice,
                             struct vg_error *err)
{
  size_t *n = (size_t *)context + slice->cell_at[VG_SLICE_TET], most = 0;

  /* Threads show slices with different cells. */
  for (size_t i = 0; i < slice->n_cell[VG_SLICE_TET]; i++)
    if (++n[i] > most) most = n[i];
  return most < 2 ? VG_OK : vg_fail(err, VG_ERR_IO, "no more room");
}

static void every_slice_is_shown(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  size_t *n = vg_calloc(m.n_tet, sizeof *n);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh_report r;
  struct cut c;

  (void)state;
  assert_non_null(n);
  cut_make(&c, &m, 6, 0, NULL, 5);
  assert_int_equal(vg_slices_judge_with(NULL, &c.s, 0, NULL, 2, NULL, 0,
                                        count_cells, n, &r, NULL, &err),
                   VG_OK);
  assert_true(r.is_valid);
  for (size_t i = 0; i < m.n_tet; i++) assert_int_equal(n[i], 1);
  assert_int_equal(vg_slices_judge_with(NULL, &c.s, 0, NULL, 2, NULL, 0,
                                        count_cells, n, &r, NULL, &err),
                   VG_ERR_IO);
  assert_string_equal(err.text, "no more room");
  cut_release(&c);
  vg_mesh_release(&m);
  free(n);
}

static void nothing_is_not_valid(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_mesh_report r;
  struct cut c;

  (void)state;
  cut_make(&c, &m, 1, 0, NULL, 5);
  judge_cut(&c, NULL, 2, 0, &r, NULL);
  assert_false(r.is_valid);
  assert_int_equal(r.n_cell, 0);
  cut_release(&c);
}

/* --- sums ---------------------------------------------------------------- */

static void sums_are_exact(void **state)
{
  static const double x[] = { 1,  1e-300,  1e300, -1e300, 5e-324, 0.1,
                              -1, -5e-324, 3,     -0.1,   1e-300 };
  struct vg_exact s = { .n_odd = 0 }, t = { .n_odd = 0 };
  size_t n = sizeof x / sizeof *x;

  (void)state;
  for (size_t i = 0; i < n; i++) vg_exact_add(&s, x[i]);
  for (size_t i = n; i-- > 0;) vg_exact_add(&t, x[i]);
  assert_memory_equal(&s, &t, sizeof s);
  assert_true(vg_exact_value(&s) == 3);
  vg_exact_add(&s, -3);
  assert_true(vg_exact_value(&s) == 2e-300);
  vg_exact_add(&s, -2e-300);
  assert_true(vg_exact_value(&s) == 0);
  vg_exact_add(&s, -5e-324);
  assert_true(vg_exact_value(&s) == -5e-324);
  vg_exact_add(&s, 1.7e308);
  vg_exact_add(&s, INFINITY);
  assert_true(isnan(vg_exact_value(&s)));
}

/* Adding many terms at once equals adding them one after the other. */
static void check_sum_of_many(size_t n, const double *x)
{
  struct vg_exact s = { .n_odd = 0 }, t = { .n_odd = 0 };

  for (size_t i = 0; i < n; i++) vg_exact_add(&s, x[i]);
  vg_exact_add_all(&t, n, x);
  assert_true(vg_exact_value(&s) == vg_exact_value(&t));
  for (size_t i = 0; i < n; i++) vg_exact_add(&t, -x[i]);
  assert_true(vg_exact_value(&t) == 0);
}

static void sums_of_many_are_those_of_each(void **state)
{
  static double x[1500];
  struct vg_exact t = { .n_odd = 0 };
  size_t n = sizeof x / sizeof *x;
  uint64_t seed = 1;

  (void)state;
  for (int wide = 0; wide < 2000; wide = 2 * wide + 1)
    for (int middle = -1100; middle < 1000; middle += 29) {
      for (size_t i = 0; i < n; i++) {
        int e = middle;

        seed = seed * UINT64_C(6364136223846793005) + 1;
        if (wide) e += (int)(seed >> 40) % wide - wide / 2;
        seed = seed * UINT64_C(6364136223846793005) + 1;
        x[i] = ldexp((double)(int64_t)seed, e < 940 ? e - 63 : 877);
        if (seed >> 20 & 1 && seed >> 21 & 1) x[i] = trunc(x[i]);
      }
      check_sum_of_many(n, x);
      check_sum_of_many(513, x);
      check_sum_of_many(3, x);
    }
  for (size_t i = 0; i < n; i++) x[i] = 0;
  check_sum_of_many(n, x);
  check_sum_of_many(0, x);
  x[7] = INFINITY;
  vg_exact_add_all(&t, 8, x);
  assert_int_equal(t.n_odd, 1);
  x[3] = NAN;
  vg_exact_add_all(&t, 8, x);
  assert_int_equal(t.n_odd, 3);
}

/* Ties round to even, unless a much smaller term decides. */
static void sums_are_rounded_once(void **state)
{
  struct vg_exact s = { .n_odd = 0 };

  (void)state;
  vg_exact_add(&s, 1);
  vg_exact_add(&s, ldexp(1, -53));
  assert_true(vg_exact_value(&s) == 1);
  vg_exact_add(&s, 1e-200);
  assert_true(vg_exact_value(&s) == 1 + ldexp(1, -52));
  vg_exact_add(&s, -2e-200);
  assert_true(vg_exact_value(&s) == 1);
  for (int i = 0; i < 1000; i++) vg_exact_add(&s, -1e16);
  assert_true(vg_exact_value(&s) == -1e19);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(tetrahedra_in_slices),
    cmocka_unit_test(mixed_cells_in_slices),
    cmocka_unit_test(prisms_in_slices),
    cmocka_unit_test(hexahedra_in_slices),
    cmocka_unit_test(cells_several_times_over),
    cmocka_unit_test(slices_count_every_defect_equally),
    cmocka_unit_test(components_are_those_of_the_whole),
    cmocka_unit_test(the_isotropic_region_is_checked_separately),
    cmocka_unit_test(many_faces_are_between_slices),
    cmocka_unit_test(points_that_are_not_finite),
    cmocka_unit_test(indices_that_point_nowhere),
    cmocka_unit_test(failures_are_reported),
    cmocka_unit_test(every_slice_is_shown),
    cmocka_unit_test(nothing_is_not_valid),
    cmocka_unit_test(sums_are_exact),
    cmocka_unit_test(sums_of_many_are_those_of_each),
    cmocka_unit_test(sums_are_rounded_once),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
