/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Rims that coincide except for rounding are distinguished from holes, and
 * welded. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "remesh_shapes.h"

#include "core/surface/surface_check.h"

/* A ball of length 2 in parts by patch that do not share points, each moved
 * along x by `step` times its number. */
static void make_parts(struct vg_mesh *m, size_t n_patch, double step)
{
  static const double radius[3] = { 1, 1, 1 };
  struct vg_mesh ball = VG_MESH_INIT;
  uint32_t *at;

  shape_ball(&ball, radius, 8);
  at = calloc(n_patch * ball.n_point, sizeof *at);
  for (size_t p = 0; p < n_patch; p++)
    vg_mesh_add_patch(m, (int32_t)p + 1, "part");
  for (size_t t = 0; t < ball.n_tri; t++) {
    uint32_t node[3], part = ball.tri_patch[t];
    double y = 0;

    for (int k = 0; k < 3; k++) y += ball.point[ball.tri[t][k]][1];
    if (n_patch == 4) part = 2 * part + (y > 0);
    for (int k = 0; k < 3; k++) {
      uint32_t from = ball.tri[t][k], *to = &at[part * ball.n_point + from];
      const double *x = ball.point[from];

      if (!*to) *to = shape_point(m, x[0] + step * part, x[1], x[2]) + 1;
      node[k] = *to - 1;
    }
    shape_tri(m, node[0], node[1], node[2], part);
  }
  free(at);
  vg_mesh_release(&ball);
}

/* Open edges, by the check. */
static size_t count_open(const struct vg_mesh *m, struct vg_surface_report *r)
{
  struct vg_surface_check_options o = { .external = 1, .threads = 1 };
  struct vg_error err = VG_ERROR_INIT;

  if (vg_surface_check((struct vg_mesh *)m, &o, r, &err) < 0)
    fail_msg("%s", err.text);
  return r->count[VG_DEFECT_OPEN_EDGE];
}

static void find_gap(const struct vg_mesh *m, double *gap, size_t *n_edge)
{
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;

  count_open(m, &r);
  if (vg_surface_rim_gap(m, &r, gap, n_edge, &err) < 0)
    fail_msg("%s", err.text);
  vg_surface_report_release(&r);
}

static size_t weld(struct vg_mesh *m, double tolerance)
{
  struct vg_error err = VG_ERROR_INIT;
  size_t n_merged = 77, n_edge;

  if (vg_surface_weld_rims(m, tolerance, &n_merged, &n_edge, &err) < 0)
    fail_msg("%s", err.text);
  return n_merged;
}

static void halves_become_a_ball(void **state)
{
  static const double share[] = { 1e-10, 1e-7, 1e-3 }; /* of the length */

  (void)state;
  for (size_t i = 0; i < sizeof share / sizeof *share; i++) {
    const double d = 2 * share[i];
    struct vg_mesh m = VG_MESH_INIT;
    double gap = -1;
    size_t n_edge = 0;

    make_parts(&m, 2, d);
    find_gap(&m, &gap, &n_edge);
    /* 16 edges of each meridian circle of 8 rings; coordinates of 1 have 16
     * digits, gaps are rounded up by 1e-9 */
    assert_int_equal(n_edge, 2 * 16);
    assert_true(fabs(gap - d) <= 2e-9 * d + 4e-16);
    assert_int_equal(weld(&m, gap / 2), 0);
    assert_int_equal(weld(&m, gap), 16);
    shape_expect_sound(&m, 0);
    find_gap(&m, &gap, &n_edge);
    assert_true(gap == 0 && n_edge == 0);
    vg_mesh_release(&m);
  }
}

/* Four parts, three gaps: at the poles four points become one. */
static void parts_that_meet_in_a_point(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  size_t n_edge, n_point;
  double gap;

  (void)state;
  make_parts(&m, 4, 1e-8);
  n_point = m.n_point;
  find_gap(&m, &gap, &n_edge);
  assert_int_equal(n_edge, 4 * 16);
  assert_true(gap >= 1.99e-8 && gap <= 3.01e-8);
  assert_int_equal(weld(&m, gap), n_point - (8 - 1) * 16 - 2);
  shape_expect_sound(&m, 0);
  vg_mesh_release(&m);
}

static void drop_tri(struct vg_mesh *m, size_t t)
{
  m->n_tri--;
  memmove(m->tri + t, m->tri + t + 1, (m->n_tri - t) * sizeof *m->tri);
  memmove(m->tri_patch + t, m->tri_patch + t + 1,
          (m->n_tri - t) * sizeof *m->tri_patch);
}

/* For any tolerance, and next to a gap. */
static void a_hole_stays_open(void **state)
{
  static const double tolerance[] = { 1e-12, 1e-3, 0.05, 1, 100 };
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  size_t n_edge, most = 0;
  double gap;

  (void)state;
  make_parts(&m, 2, 0);
  assert_int_equal(vg_surface_weld(&m, 0, NULL, NULL, NULL), VG_OK);
  drop_tri(&m, 40);
  find_gap(&m, &gap, &n_edge);
  assert_true(gap == 0 && n_edge == 0);
  for (size_t i = 0; i < sizeof tolerance / sizeof *tolerance; i++)
    assert_int_equal(weld(&m, tolerance[i]), 0);
  assert_int_equal(count_open(&m, &r), 3);
  vg_mesh_release(&m);

  make_parts(&m, 2, 2e-6);
  for (size_t t = 0; t < m.n_tri; t++) /* the last that has a seam's point */
    for (int k = 0; k < 3; k++)
      if (m.tri_patch[t] == 0 && fabs(m.point[m.tri[t][k]][0]) < 1e-9) most = t;
  drop_tri(&m, most);
  find_gap(&m, &gap, &n_edge);
  assert_true(gap > 1.9e-6 && gap < 2.1e-6);
  assert_true(weld(&m, gap) > 0);
  assert_int_equal(count_open(&m, &r), 3);
  assert_int_equal(weld(&m, 1), 0);
  assert_int_equal(count_open(&m, &r), 3);
  vg_surface_report_release(&r);
  vg_mesh_release(&m);
}

/* Six sides of a plate that is 1e-3 thick with edges of 0.1 on it: its rims are
 * close to each other, and closer to their partners. */
static void a_thin_plate_keeps_its_sides(void **state)
{
  static const double size[3] = { 1, 1, 1e-3 };
  static const uint32_t n[3] = { 10, 10, 1 };
  struct vg_mesh plate = VG_MESH_INIT, m = VG_MESH_INIT;
  size_t n_edge;
  double gap;

  (void)state;
  shape_box(&plate, size, n);
  for (size_t p = 0; p < plate.n_patch; p++)
    vg_mesh_add_patch(&m, (int32_t)p + 1, "side");
  for (size_t t = 0; t < plate.n_tri; t++) {
    uint32_t side = plate.tri_patch[t], node[3];

    for (int k = 0; k < 3; k++) {
      const double *x = plate.point[plate.tri[t][k]];

      node[k] = shape_point(&m, x[0], x[1], x[2] + 1e-9 * side);
    }
    shape_tri(&m, node[0], node[1], node[2], side);
  }
  assert_int_equal(vg_surface_weld(&m, 0, NULL, NULL, NULL), VG_OK);
  find_gap(&m, &gap, &n_edge);
  assert_int_equal(n_edge, 2 * (8 * 10 + 4));
  assert_true(gap < 5.1e-9);
  assert_true(weld(&m, 1e-8) > 0);
  assert_int_equal(m.n_point, plate.n_point);
  shape_expect_sound(&m, 0);
  vg_mesh_release(&plate);
  vg_mesh_release(&m);
}

static void refuses_invalid_tolerances(void **state)
{
  static const double bad[] = { 0, -1, INFINITY, NAN };
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  double gap = 5;
  size_t n_edge = 7;

  (void)state;
  make_parts(&m, 2, 1e-9);
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    assert_int_equal(vg_surface_weld_rims(&m, bad[i], NULL, NULL, &err),
                     VG_ERR_INPUT);
  m.point[0][0] = NAN;
  assert_int_equal(vg_surface_rim_gap(&m, NULL, &gap, &n_edge, &err), VG_OK);
  m.point[0][0] = INFINITY;
  assert_int_equal(vg_surface_rim_gap(&m, NULL, &gap, &n_edge, &err), VG_OK);
  gap = 5;
  n_edge = 7;
  m.tri[3][1] = (uint32_t)m.n_point;
  assert_int_equal(vg_surface_rim_gap(&m, NULL, &gap, &n_edge, &err),
                   VG_ERR_INPUT);
  assert_true(gap == 5 && n_edge == 7);
  vg_mesh_release(&m);
  assert_int_equal(vg_surface_rim_gap(&m, NULL, &gap, &n_edge, &err), VG_OK);
  assert_true(gap == 0 && n_edge == 0);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(halves_become_a_ball),
    cmocka_unit_test(parts_that_meet_in_a_point),
    cmocka_unit_test(a_hole_stays_open),
    cmocka_unit_test(a_thin_plate_keeps_its_sides),
    cmocka_unit_test(refuses_invalid_tolerances),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
