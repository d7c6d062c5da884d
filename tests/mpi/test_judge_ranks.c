/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh check of slices on several ranks: every rank gets the same report as
 * for the mesh in one piece. */
#include "mpi_support.h"

#include "../unit/judge_support.h"
#include "../unit/metric_support.h"
#include "../unit/mixed_cut.h"

static void check(const struct vg_mesh *m, const struct vg_sizing *sizing,
                  size_t n_slice, int threads)
{
  struct vg_mesh_report r, want, field, want_field;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh part;
  struct cut c;

  cut_make(&c, m, n_slice, 0, NULL, 23 + n_slice);
  part = judge_field(&c);
  assert_int_equal(vg_mesh_judge(m, sizing, &want, &err), VG_OK);
  assert_int_equal(vg_mesh_judge_dual(m, &want, &err), VG_OK);
  cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
  assert_int_equal(vg_slices_judge_with(job, &c.s, 0, sizing, threads, NULL, 1,
                                        NULL, NULL, &r, NULL, &err),
                   VG_OK);
  assert_same_report(&r, &want);
  if (part.n_tet) {
    assert_int_equal(vg_mesh_judge(m, NULL, &want, &err), VG_OK);
    assert_int_equal(vg_mesh_judge(&part, sizing, &want_field, &err), VG_OK);
    judge_map_worst(&c, &want_field);
    want_field.enclosed = want_field.volume;
    want_field.volume_error = 0;
    assert_int_equal(vg_slices_judge(job, &c.s, part.n_tri + part.n_quad,
                                     sizing, threads, &r, &field, &err),
                     VG_OK);
    assert_same_report(&r, &want);
    assert_same_report(&field, &want_field);
  }
  vg_mesh_release(&part);
  cut_release(&c);
}

static void ranks_agree_with_one_piece(void **state)
{
  (void)state;
  for (int cells = 0; cells < 2; cells++) {
    struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS);
    struct vg_sizing *sizing = shape_sizing(&m, 1.5, 0);

    check(&m, sizing, 1, 1); /* ranks without slices */
    check(&m, sizing, 9, 1);
    check(&m, sizing, 30, 2);
    vg_sizing_free(sizing);
    vg_mesh_release(&m);
  }
}

static void ranks_agree_on_hexahedra(void **state)
{
  struct vg_join_info info;
  struct vg_mesh m;

  (void)state;
  mixed_cut_mesh(&m, &info);
  check(&m, NULL, 1, 1);
  check(&m, NULL, 9, 1);
  check(&m, NULL, 30, 2);
  vg_mesh_release(&m);
}

static void ranks_agree_in_a_metric(void **state)
{
  (void)state;
  for (int cells = 0; cells < 2; cells++) {
    struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS);
    double scale = 0.1;
    struct vg_sizing *sizing = metric_oblique_field(&m, &scale);

    check(&m, sizing, 1, 1);
    check(&m, sizing, 9, 1);
    check(&m, sizing, 30, 2);
    vg_sizing_free(sizing);
    vg_mesh_release(&m);
  }
}

static void ranks_count_every_damage(void **state)
{
  (void)state;
  for (int damage = 0; damage < JUDGE_DAMAGES; damage++) {
    struct vg_mesh m = judge_mesh(damage % 2 ? VG_LAYER_MIXED : VG_LAYER_TETS);
    struct vg_mesh_report r, want;
    struct vg_error err = VG_ERROR_INIT;
    struct cut c;

    judge_damage(&m, damage, 1);
    cut_make(&c, &m, 13, 0, NULL, 7);
    cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
    assert_int_equal(vg_mesh_judge(&m, NULL, &want, &err), VG_OK);
    assert_int_equal(vg_slices_judge(job, &c.s, 0, NULL, 1, &r, NULL, &err),
                     VG_OK);
    assert_false(r.is_valid);
    assert_same_report(&r, &want);
    cut_release(&c);
    vg_mesh_release(&m);
  }
}

static void invalid_points_end_the_check_on_all_ranks(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_mesh_report r;
  struct cut c;

  (void)state;
  m.point[3][0] = NAN;
  m.tri[2][2] = (uint32_t)m.n_point;
  cut_make(&c, &m, 5, 0, NULL, 7);
  cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
  assert_int_equal(vg_slices_judge(job, &c.s, 0, NULL, 1, &r, NULL, NULL),
                   VG_OK);
  assert_int_equal(r.bad_index, 1);
  assert_int_equal(r.not_finite, 1);
  assert_int_equal(r.n_cell, m.n_tet);
  assert_false(r.is_valid);
  cut_release(&c);
  vg_mesh_release(&m);
}

/* A slice that cannot be read is on one rank; all ranks return. */
static void one_failure_reaches_every_rank(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;
  struct cut c;

  (void)state;
  cut_make(&c, &m, 5, 0, NULL, 7);
  cut_deal(&c, vg_comm_rank(job), vg_comm_size(job));
  c.bad = 2;
  assert_true(vg_slices_judge(job, &c.s, 0, NULL, 1, &r, NULL, &err) < 0);
  assert_non_null(strstr(err.text, "slice 2 is bad"));
  cut_release(&c);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(ranks_agree_with_one_piece),
    cmocka_unit_test(ranks_agree_on_hexahedra),
    cmocka_unit_test(ranks_agree_in_a_metric),
    cmocka_unit_test(ranks_count_every_damage),
    cmocka_unit_test(invalid_points_end_the_check_on_all_ranks),
    cmocka_unit_test(one_failure_reaches_every_rank),
  };

  return RUN_IN_JOB(tests);
}
