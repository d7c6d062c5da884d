/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include <math.h>

#include "core/judge/plane_quality.h"
#include "core/judge/quality.h"
#include "core/mesh/plane_mesh.h"

/* A square of quadrilateral and triangle, which is outside the layers:
 *
 *   3---2
 *   | /   \
 *   0---1---4    quadrilateral 0 1 2 3, triangle 1 4 2 */
static double x[5][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 }, { 2, 0 } };
static uint32_t tri[1][3] = { { 1, 4, 2 } }, quad[1][4] = { { 0, 1, 2, 3 } };
static uint32_t edge[5][2] = {
  { 0, 1 }, { 1, 4 }, { 4, 2 }, { 2, 3 }, { 3, 0 }
};
static uint32_t edge_patch[5] = { 0, 0, 0, 1, 1 };
static struct vg_patch patch[2] = { { .id = 1, .name = "low" },
                                    { .id = 2, .name = "high" } };
static const struct vg_plane_mesh mesh = { .n_point = 5,
                                           .n_tri = 1,
                                           .n_quad = 1,
                                           .n_edge = 5,
                                           .n_patch = 2,
                                           .x = x,
                                           .tri = tri,
                                           .quad = quad,
                                           .edge = edge,
                                           .edge_patch = edge_patch,
                                           .patch = patch };

/* The mesh one cell thick is valid in both positions, and has the volume. */
static void extrudes(void **state)
{
  const struct vg_patch plane[2] = { { .id = 3, .name = "back" },
                                     { .id = 4, .name = "front" } };

  (void)state;
  for (int axis = 1; axis <= 2; axis++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_mesh_report r;
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(vg_plane_mesh_extrude(&mesh, axis, 0.5, plane, &m, &err),
                     VG_OK);
    assert_int_equal(m.n_point, 10);
    assert_int_equal(m.n_pri, 1);
    assert_int_equal(m.n_hex, 1);
    assert_int_equal(m.n_patch, 4);
    assert_int_equal(vg_mesh_judge(&m, NULL, &r, &err), VG_OK);
    assert_true(r.is_valid);
    assert_true(fabs(r.volume - 0.75) < 1e-12);
    for (size_t i = 0; i < m.n_point; i++)
      assert_true(m.point[i][axis] == 0 || m.point[i][axis] == 0.5);
    vg_mesh_release(&m);
  }
}

static void measures_angles(void **state)
{
  struct vg_plane_report r;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(vg_plane_judge(&mesh, &r, &err), VG_OK);
  assert_int_equal(r.n_field, 1);
  assert_true(fabs(r.angle_min - 45) < 1e-9);
  assert_true(fabs(r.angle_max - 90) < 1e-9);
  assert_true(fabs(r.quad_min - 90) < 1e-9);
  assert_int_equal(r.n_below[VG_PLANE_LIMITS - 1], 0);
  assert_true(fabs(r.at[0] - 4.0 / 3) < 1e-12);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(extrudes),
    cmocka_unit_test(measures_angles),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
