/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Points projected back to a shape: located on old triangles, moved all at
 * once, and kept where triangles would fold, become slivers or intersect. */
#include "remesh_shapes.h"

#include "core/remesh/put_back.h"

static void put_back(struct vg_mesh *m, double (*to)[3], uint8_t *stays,
                     size_t *n_refused)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_remesh_put_back(m, (const double(*)[3])to, 1, NULL, stays, n_refused,
                         &err) < 0)
    fail_msg("%s", err.text);
}

/* Half a ball scaled by 1.01: all its points move, the others stay. */
static void moves_all(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  double(*to)[3];
  uint8_t *stays;
  size_t n_refused = 1;

  (void)unused;
  shape_ball(&m, size, 24);
  to = calloc(m.n_point, sizeof *to);
  stays = calloc(m.n_point, 1);
  for (size_t p = 0; p < m.n_point; p++) {
    for (int k = 0; k < 3; k++) to[p][k] = m.point[p][k] * 1.01;
    stays[p] = m.point[p][2] < 0;
  }
  put_back(&m, to, stays, &n_refused);
  assert_int_equal(n_refused, 0);
  for (size_t p = 0; p < m.n_point; p++)
    assert_float_equal(vg_norm(m.point[p]), stays[p] ? 1 : 1.01, 1e-12);
  shape_expect_sound(&m, 0);
  free(to);
  free(stays);
  vg_mesh_release(&m);
}

/* One point moved far along the surface is refused, and with it its neighbours
 * at most. */
static void refuses_folds(void **unused)
{
  const double size[3] = { 1, 1, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  double(*to)[3];
  uint8_t *stays;
  size_t n_refused = 0, p = 0;

  (void)unused;
  shape_ball(&m, size, 24);
  to = calloc(m.n_point, sizeof *to);
  stays = calloc(m.n_point, 1);
  while (fabs(m.point[p][2]) > 0.5) p++;
  for (size_t i = 0; i < m.n_point; i++)
    for (int k = 0; k < 3; k++) to[i][k] = m.point[i][k] * 1.001;
  to[p][2] += 0.3;
  put_back(&m, to, stays, &n_refused);
  assert_true(stays[p]);
  assert_true(n_refused >= 1 && n_refused < 30);
  assert_float_equal(vg_norm(m.point[p]), 1, 1e-12);
  shape_expect_sound(&m, 0);
  free(to);
  free(stays);
  vg_mesh_release(&m);
}

/* A box whose thickness would become negative: no triangle folds or becomes a
 * sliver, but the sides would intersect, so all points of one side are kept. */
static void refuses_meeting(void **unused)
{
  const double size[3] = { 1, 1, 0.01 };
  const uint32_t n[3] = { 8, 8, 1 };
  struct vg_mesh m = VG_MESH_INIT, old = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double(*to)[3];
  uint8_t *stays;
  size_t n_refused = 0;

  (void)unused;
  shape_box(&m, size, n);
  assert_int_equal(vg_mesh_copy(&old, &m, &err), VG_OK);
  to = calloc(m.n_point, sizeof *to);
  stays = calloc(m.n_point, 1);
  for (size_t p = 0; p < m.n_point; p++) {
    const double *x = m.point[p];
    int inside = x[0] > 0 && x[0] < 1 && x[1] > 0 && x[1] < 1;

    memcpy(to[p], x, sizeof *to);
    if (inside && x[2] > 0) to[p][2] -= 0.03;
  }
  put_back(&m, to, stays, &n_refused);
  assert_int_equal(n_refused, 7 * 7);
  assert_memory_equal(m.point, old.point, m.n_point * sizeof *m.point);
  shape_expect_sound(&m, 0);
  free(to);
  free(stays);
  vg_mesh_release(&m);
  vg_mesh_release(&old);
}

/* Two sides of a plate would intersect at one location: the points of other
 * locations move all the same. */
static void keeps_conflicts_local(void **unused)
{
  const double size[3] = { 1, 1, 0.01 };
  const uint32_t n[3] = { 24, 24, 1 };
  struct vg_mesh m = VG_MESH_INIT;
  double(*to)[3];
  uint8_t *stays;
  size_t n_refused = 0, n_inside = 0;

  (void)unused;
  shape_box(&m, size, n);
  to = calloc(m.n_point, sizeof *to);
  stays = calloc(m.n_point, 1);
  for (size_t p = 0; p < m.n_point; p++) {
    const double *x = m.point[p];
    const double far = hypot(x[0] - 0.5, x[1] - 0.5);
    const int inside = x[0] > 0 && x[0] < 1 && x[1] > 0 && x[1] < 1;

    memcpy(to[p], x, sizeof *to);
    if (!inside) continue;
    to[p][2] += x[2] > 0 ? 1e-3 : -1e-3;
    if (x[2] > 0 && far < 0.1) to[p][2] -= 0.02;
    n_inside++;
  }
  put_back(&m, to, stays, &n_refused);
  assert_true(n_refused > 0 && n_refused < n_inside / 10);
  shape_expect_sound(&m, 0);
  free(to);
  free(stays);
  vg_mesh_release(&m);
}

/* Every point of a box is located on a triangle that contains it, for either
 * orientation of triangles and any number of threads. */
static void locates(void **unused)
{
  const double size[3] = { 3, 2, 1 };
  const uint32_t n[3] = { 5, 4, 3 };
  struct vg_mesh m = VG_MESH_INIT, none = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  uint32_t *tri[2];
  double(*foot)[3];

  (void)unused;
  shape_box(&m, size, n);
  for (size_t t = 0; t < m.n_tri;
       t += 2) { /* neighbours have opposite orientations */
    uint32_t a = m.tri[t][0];

    m.tri[t][0] = m.tri[t][1];
    m.tri[t][1] = a;
  }
  foot = calloc(m.n_point, sizeof *foot);
  for (int k = 0; k < 2; k++) {
    tri[k] = calloc(m.n_point, sizeof *tri[k]);
    assert_int_equal(vg_remesh_locate(&m, m.n_point,
                                      (const double(*)[3])m.point, 1 + 3 * k,
                                      NULL, tri[k], foot, &err),
                     VG_OK);
  }
  assert_memory_equal(tri[0], tri[1], m.n_point * sizeof **tri);
  for (size_t p = 0; p < m.n_point; p++) {
    const uint32_t *v = m.tri[tri[0][p]];

    assert_true(v[0] == p || v[1] == p || v[2] == p);
    assert_float_equal(vg_distance(foot[p], m.point[p]), 0, 1e-15);
  }
  assert_int_equal(vg_remesh_locate(&none, 0, NULL, 1, NULL, NULL, NULL, &err),
                   VG_ERR_INPUT);
  free(tri[0]);
  free(tri[1]);
  free(foot);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(moves_all),       cmocka_unit_test(refuses_folds),
    cmocka_unit_test(refuses_meeting), cmocka_unit_test(keeps_conflicts_local),
    cmocka_unit_test(locates),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
