/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A surface changed in blocks: for any division the reassembled surface is
 * consistent and close to the input, and it is the same for any number of
 * threads. */
#include "remesh_scene.h"

#include "core/remesh/blocks.h"

#define TOLERANCE 0.02

/* Random changes that depend on the block, not on the thread. */
static vg_status draw_changes(void *user, struct vg_tris *w,
                              struct vg_error *err)
{
  uint32_t state = (uint32_t)(w->n_tri * 7 + w->n_point);
  size_t n = 0;

  (void)err;
  for (int i = 0; i < 400; i++) n += (size_t)scene_change(w, &state);
  __atomic_add_fetch((size_t *)user, n, __ATOMIC_RELAXED);
  return VG_OK;
}

static vg_status change_nothing(void *user, struct vg_tris *w,
                                struct vg_error *err)
{
  (void)err;
  __atomic_add_fetch((size_t *)user, w->n_tri, __ATOMIC_RELAXED);
  return VG_OK;
}

static vg_status fail_where_large(void *user, struct vg_tris *w,
                                  struct vg_error *err)
{
  (void)user;
  if (w->point[0].x[0] < 0)
    return vg_fail(err, VG_ERR_GEOMETRY, "%zu", w->n_tri);
  return VG_OK;
}

static void run(struct scene *s, size_t n, int phase, int threads,
                vg_block_body body, size_t *sum)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_blocks_run(&s->w, n, phase, threads, body, sum, &err) < 0)
    fail_msg("%s", err.text);
}

static void surface_stays_valid_without_changes(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  struct scene s = { .m = VG_MESH_INIT };
  size_t n_tri, n_point;

  (void)unused;
  shape_ball(&s.m, size, 12);
  scene_set(&s, TOLERANCE, 0.2);
  n_tri = s.w.n_tri;
  n_point = s.w.n_point;
  for (int phase = 0; phase < 3; phase++) {
    size_t sum = 0;

    run(&s, 5 + (size_t)phase, phase, 2, change_nothing, &sum);
    assert_int_equal(sum, n_tri);
    assert_int_equal(s.w.n_tri, n_tri);
    assert_int_equal(s.w.n_point, n_point);
    scene_expect_whole(&s);
  }
  scene_release(&s);
}

/* Feature edges along and across borders of blocks, and points where more than
 * two blocks meet. */
static void surface_stays_valid_after_changes(void **unused)
{
  const double size[3] = { 1, 0.5, 0.1 };
  const uint32_t n[3] = { 12, 9, 3 };

  (void)unused;
  for (int ball = 0; ball < 2; ball++) {
    struct scene s = { .m = VG_MESH_INIT };
    size_t sum = 0;

    if (ball) shape_ball(&s.m, (double[3]){ 1, 1, 1 }, 16);
    else shape_box(&s.m, size, n);
    scene_set(&s, TOLERANCE, 0.1);
    for (int phase = 0; phase < 12; phase++) {
      run(&s, 2 + (size_t)phase % 7, phase, 2, draw_changes, &sum);
      scene_expect_whole(&s);
    }
    scene_expect_near(&s, ball ? TOLERANCE : 1e-9);
    assert_true(sum > 1000);
    scene_release(&s);
  }
}

static void same_for_any_threads(void **unused)
{
  struct scene s[2] = { { .m = VG_MESH_INIT }, { .m = VG_MESH_INIT } };
  size_t sum[2] = { 0, 0 };

  (void)unused;
  for (int i = 0; i < 2; i++) {
    shape_ball(&s[i].m, (double[3]){ 1, 0.7, 0.4 }, 16);
    scene_set(&s[i], TOLERANCE, 0.1);
    for (int phase = 0; phase < 3; phase++)
      run(&s[i], 6, phase, i ? 3 : 1, draw_changes, &sum[i]);
  }
  assert_int_equal(sum[0], sum[1]);
  assert_int_equal(s[0].w.n_tri, s[1].w.n_tri);
  assert_memory_equal(s[0].w.tri, s[1].w.tri,
                      s[0].w.n_tri * sizeof *s[0].w.tri);
  for (size_t p = 0; p < s[0].w.n_point; p++)
    assert_memory_equal(s[0].w.point[p].x, s[1].w.point[p].x,
                        sizeof s[0].w.point[p].x);
  for (int i = 0; i < 2; i++) scene_release(&s[i]);
}

/* If one block inserts more points than permitted, nothing is changed. */
static void ends_when_over(void **unused)
{
  (void)unused;
  for (int threads = 1; threads < 4; threads += 2) {
    struct scene s = { .m = VG_MESH_INIT };
    size_t sum = 0, n_tri, n_point;

    shape_ball(&s.m, (double[3]){ 1, 1, 1 }, 12);
    scene_set(&s, TOLERANCE, 0.1);
    n_tri = s.w.n_tri;
    n_point = s.w.n_point;
    s.w.churn = 1e3;
    run(&s, 6, 0, threads, change_nothing, &sum);
    assert_false(s.w.is_over || s.w.ends);
    s.w.churn = 1e-9;
    run(&s, 6, 0, threads, draw_changes, &sum);
    assert_true(s.w.is_over && s.w.ends);
    assert_int_equal(vg_tris_status(&s.w, NULL), VG_OK);
    assert_int_equal(s.w.n_tri, n_tri);
    assert_int_equal(s.w.n_point, n_point);
    scene_expect_whole(&s);
    scene_release(&s);
  }
}

/* If several blocks fail, the first one is reported. */
static void fails_with_the_first(void **unused)
{
  struct scene s = { .m = VG_MESH_INIT };
  struct vg_error err[2] = { VG_ERROR_INIT, VG_ERROR_INIT };

  (void)unused;
  shape_ball(&s.m, (double[3]){ 1, 1, 1 }, 12);
  scene_set(&s, TOLERANCE, 0.2);
  for (int i = 0; i < 2; i++)
    assert_int_equal(vg_blocks_run(&s.w, 6, 0, 1 + 2 * i, fail_where_large,
                                   NULL, &err[i]),
                     VG_ERR_GEOMETRY);
  assert_string_equal(err[0].text, err[1].text);
  scene_release(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(surface_stays_valid_without_changes),
    cmocka_unit_test(surface_stays_valid_after_changes),
    cmocka_unit_test(same_for_any_threads),
    cmocka_unit_test(ends_when_over),
    cmocka_unit_test(fails_with_the_first),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
