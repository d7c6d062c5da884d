/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The single changes of a surface: after any sequence of them the surface is
 * consistent and encloses the same volume, and each change was made completely
 * or not at all. */
#include "remesh_scene.h"

static void any_sequence(struct scene *s, double tolerance)
{
  uint32_t state = 3;
  size_t n = 0;

  for (int i = 0; i < 6000; i++) {
    n += (size_t)scene_change(&s->w, &state);
    if (i % 500 == 0) scene_expect_whole(s);
  }
  assert_true(n > 500);
  assert_true(s->w.n_split && s->w.n_collapse && s->w.n_swap && s->w.n_move);
  scene_expect_whole(s);
  scene_expect_near(s, tolerance);
}

static void any_sequence_on_a_ball(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  struct scene s = { .m = VG_MESH_INIT };

  (void)unused;
  shape_ball(&s.m, size, 12);
  scene_set(&s, 0.02, 0.2);
  any_sequence(&s, 0.02);
  scene_release(&s);
}

static void any_sequence_on_a_box(void **unused)
{
  const double size[3] = { 1, 0.5, 0.1 };
  const uint32_t n[3] = { 6, 5, 3 };
  struct scene s = { .m = VG_MESH_INIT };

  (void)unused;
  shape_box(&s.m, size, n);
  scene_set(&s, 1e-3, 0.1);
  any_sequence(&s, 1e-9); /* its sides are planes */
  scene_release(&s);
}

/* A sharp edge: half an angle of 0.002. On one side of it is a quadrilateral
 * that is not convex: its other diagonal would fold it onto the other side,
 * which is closer than any tolerance. */
static void knife(struct vg_mesh *m)
{
  enum { P0, P1, P2, P3, Q, A, B, C, D, E, F };
  static const double at[11][2] = {
    { 0.05, 0.5 },  { 0.09, 0.5 }, { 0.02, 0.45 }, { 0.02, 0.55 },
    { 0.021, 0.5 }, { 0, 0 },      { 0, 1 },       { 1, 0 },
    { 1, 1 },       { 1, 0 },      { 1, 1 }
  };
  static const uint32_t tri[][3] = {
    { P0, P1, P2 }, { P1, P0, P3 }, { P2, Q, P0 }, { Q, P3, P0 }, { A, Q, P2 },
    { A, B, Q },    { B, P3, Q },   { A, P2, P1 }, { A, P1, C },  { C, P1, D },
    { D, P1, B },   { B, P1, P3 },  { A, E, F },   { A, F, B },   { C, D, F },
    { C, F, E },    { A, C, E },    { B, F, D }
  };

  vg_mesh_add_patch(m, 1, NULL);
  for (uint32_t i = 0; i < 11; i++)
    shape_point(m, at[i][0], (i < E ? 0.002 : -0.002) * at[i][0], at[i][1]);
  for (size_t i = 0; i < sizeof tri / sizeof *tri; i++)
    shape_tri(m, tri[i][0], tri[i][1], tri[i][2], 0);
}

static void changes_do_not_fold_the_surface(void **unused)
{
  struct scene s = { .m = VG_MESH_INIT };
  struct vg_tris *w = &s.w;
  uint32_t h = 0;

  (void)unused;
  knife(&s.m);
  scene_set(&s, 0.1, 1);
  while (vg_tris_from(w, h) != 0 || vg_tris_to(w, h) != 1) h++;
  assert_true(vg_tris_tri_shape(w, h / 3) < 0.2); /* worth a swap */
  assert_false(vg_tris_swap(w, h));
  scene_expect_whole(&s);
  scene_release(&s);
}

/* Corners stay; points on feature edges are removed only along them. */
static void corners_and_ridges_stay(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 2, 2, 2 };
  struct scene s = { .m = VG_MESH_INIT };
  struct vg_tris *w = &s.w;

  (void)unused;
  shape_box(&s.m, size, n);
  scene_set(&s, 1e-3, 1);
  for (uint32_t h = 0; h < 3 * w->n_tri; h++) {
    uint32_t p = vg_tris_from(w, h);
    int kind = w->point[p].kind, on_line = w->edge[h] != 0;

    if (vg_tris_removed(w, h / 3)) continue;
    if (kind == VG_WORK_CORNER || (kind == VG_WORK_CURVE && !on_line))
      assert_false(vg_tris_collapse(w, h, 1e9, 0));
    else if (kind != VG_WORK_FACE && on_line) continue;
    assert_false(kind != VG_WORK_FACE &&
                 vg_tris_move(w, p, (double[3]){ 0, 0, 0 }, 0));
    if (w->edge[h]) assert_false(vg_tris_swap(w, h));
  }
  scene_expect_whole(&s);
  scene_release(&s);
}

/* On a feature edge of a box each point slides along its curve to the requested
 * curve length, but not past its neighbours. A point stays if angles would get
 * worse. */
static void points_slide_along_ridges(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  const uint32_t n[3] = { 4, 4, 4 };
  struct scene s = { .m = VG_MESH_INIT };
  struct vg_tris *w = &s.w;
  size_t n_slid = 0;

  (void)unused;
  shape_box(&s.m, size, n);
  scene_set(&s, 1e-3, 1);
  for (uint32_t p = 0; p < w->n_point; p++) {
    struct vg_tris_span a, b;
    double x[3];

    if (!vg_tris_span(w, p, &a)) {
      assert_int_not_equal(w->point[p].kind, VG_WORK_CURVE);
      assert_false(vg_tris_slide(w, p, 0.1, 0));
      continue;
    }
    assert_false(vg_tris_slide(w, p, a.lo, 0));
    assert_false(vg_tris_slide(w, p, a.hi + 0.1, 0));
    assert_false(vg_tris_slide(w, p, (3 * a.lo + a.hi) / 4, 1));
    if (!vg_tris_slide(w, p, (3 * a.lo + a.hi) / 4, 0)) continue;
    n_slid++;
    assert_true(vg_tris_span(w, p, &b));
    assert_true(b.lo == a.lo && b.hi == a.hi && b.at == (3 * a.lo + a.hi) / 4);
    vg_curve_at(w->curves, w->ref, b.curve, b.at, x);
    assert_true(vg_distance(x, vg_tris_at(w, p)) == 0);
  }
  assert_true(n_slid > 12);
  scene_expect_whole(&s);
  scene_expect_near(&s, 1e-9);
  scene_release(&s);
}

/* Changes that would exceed the tolerance are refused: on a coarse ball no
 * point can be removed without moving the surface inwards. */
static void tolerance_is_kept(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  struct scene s = { .m = VG_MESH_INIT };

  (void)unused;
  shape_ball(&s.m, size, 6);
  scene_set(&s, 1e-3, 1);
  for (uint32_t h = 0; h < 3 * s.w.n_tri; h++)
    assert_false(vg_tris_collapse(&s.w, h, 1e9, 0));
  assert_int_equal(s.w.n_collapse, 0);
  scene_release(&s);
}

/* An edge over a fold 0.1 high is farthest from the surface where it crosses
 * the fold, measured along the normal of the side where it begins: 0.0334, and
 * not in its middle, 0.0249. */
static void follows_an_edge_over_a_fold(void **unused)
{
  const double a[3] = { -0.5, 0, 0.05 }, b[3] = { 0.25, 0, 0.075 };
  const double up[3] = { 0, 0, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_ref r = VG_REF_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint32_t p[4];
  double x[3];

  (void)unused;
  vg_mesh_add_patch(&m, 1, NULL);
  p[0] = shape_point(&m, 0, -1, 0.1);
  p[1] = shape_point(&m, 0, 1, 0.1);
  p[2] = shape_point(&m, -1, 0, 0);
  p[3] = shape_point(&m, 1, 0, 0);
  shape_tri(&m, p[0], p[3], p[1], 0);
  shape_tri(&m, p[1], p[2], p[0], 0);
  assert_int_equal(vg_ref_build(&r, &m, NULL, &err), VG_OK);
  for (uint32_t hint = 0; hint < 2; hint++) {
    assert_false(vg_ref_leaves(&r, a, b, up, 0.034, hint, x));
    assert_true(vg_ref_leaves(&r, a, b, up, 0.033, hint, x));
    assert_true(fabs(x[0]) < 0.004);
    assert_true(vg_ref_leaves(&r, b, a, up, 0.033, hint, x));
    assert_true(fabs(x[0]) < 0.004);
  }
  assert_false(vg_ref_leaves(&r, a, (double[3]){ 2, 0, 0.5 }, up, 1, 1, x));
  vg_ref_release(&r);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(changes_do_not_fold_the_surface),
    cmocka_unit_test(any_sequence_on_a_ball),
    cmocka_unit_test(any_sequence_on_a_box),
    cmocka_unit_test(corners_and_ridges_stay),
    cmocka_unit_test(points_slide_along_ridges),
    cmocka_unit_test(tolerance_is_kept),
    cmocka_unit_test(follows_an_edge_over_a_fold),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
