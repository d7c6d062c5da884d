/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Metrics at the points of a background mesh. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/geometry/tensor.h"
#include "core/sizing/sizing_mesh.h"
#include "core/sizing/sizing_tensor.h"

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

enum { N = 4, POINTS = (N + 1) * (N + 1) * (N + 1) };

static double random_unit(uint64_t *state)
{
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*state >> 11) * 0x1p-53;
}

/* A size tensor that is linear in x. */
static void linear(const double x[3], double h[6])
{
  h[0] = 0.1 + 0.05 * x[0];
  h[1] = 0.02 * x[1];
  h[2] = 0.01;
  h[3] = 0.2 - 0.1 * x[2];
  h[4] = -0.01 * x[0];
  h[5] = 0.3;
}

/* The unit cube divided into N^3 hexahedra (kind 1), two prisms in each (2),
 * or its points only. */
static void make_box(struct vg_mesh *m, int kind, double (*metric)[6])
{
  uint32_t n = N + 1;

  *m = (struct vg_mesh)VG_MESH_INIT;
  m->point = calloc(POINTS, sizeof *m->point);
  m->hex = calloc(N * N * N, sizeof *m->hex);
  m->pri = calloc(2 * N * N * N, sizeof *m->pri);
  assert_true(m->point && m->hex && m->pri);
  for (uint32_t i = 0; i < POINTS; i++) {
    double h[6], *x = m->point[m->n_point++];

    x[0] = (double)(i % n) / N;
    x[1] = (double)(i / n % n) / N;
    x[2] = (double)(i / n / n) / N;
    linear(x, h);
    vg_size_metric(h, metric[i]);
  }
  for (uint32_t i = 0; kind && i < N * N * N; i++) {
    uint32_t a = i % N + i / N % N * n + i / N / N * n * n, up = n * n;
    uint32_t hex[8] = { a,      a + 1,      a + 1 + n,      a + n,
                        a + up, a + 1 + up, a + 1 + n + up, a + n + up };
    uint32_t pri[2][6] = { { a, a + 1, a + n, a + up, a + 1 + up, a + n + up },
                           { a + 1, a + 1 + n, a + n, a + 1 + up,
                             a + 1 + n + up, a + n + up } };

    if (kind == 1) memcpy(m->hex[m->n_hex++], hex, sizeof hex);
    for (int k = 0; k < 2 && kind == 2; k++)
      memcpy(m->pri[m->n_pri++], pri[k], sizeof pri[k]);
  }
}

/* The metrics of the box (make_box). */
static const struct vg_size_map *map_box(int kind, struct vg_size_mesh **s)
{
  double metric[POINTS][6];
  struct vg_mesh m;

  make_box(&m, kind, metric);
  assert_int_equal(vg_size_mesh_new(&m, (const double(*)[6])metric, 1.2, s,
                                    NULL),
                   VG_OK);
  vg_mesh_release(&m);
  return vg_size_mesh_map(*s);
}

static void cells_interpolate_linearly(void **state)
{
  (void)state;
  for (int kind = 1; kind <= 2; kind++) {
    struct vg_size_mesh *s = NULL;
    const struct vg_size_map *map = map_box(kind, &s);
    uint64_t seed = 1;

    assert_non_null(map->least);
    assert_near(map->most, 0.302, 2e-3);
    for (int i = 0; i < 1000; i++) {
      double x[3], h[6], got[6], exact[6];

      for (int k = 0; k < 3; k++) x[k] = random_unit(&seed);
      linear(x, h);
      vg_size_metric(h, exact);
      map->metric(map->user, x, got);
      for (int k = 0; k < 6; k++)
        assert_near(got[k], exact[k], 1e-5 * exact[0] + 1e-5 * exact[3]);
    }
    vg_size_mesh_free(s);
  }
}

static void sizes_at(const struct vg_size_map *map, double x, double y,
                     double z, double h[6])
{
  double metric[6], t[6];

  map->metric(map->user, (const double[3]){ x, y, z }, metric);
  vg_tensor_root(metric, t);
  vg_tensor_invert(t, h);
}

/* Without cells, the size tensor of the nearest point grows beyond one edge
 * length. */
static void the_nearest_point_grows(void **state)
{
  struct vg_size_mesh *s = NULL;
  const struct vg_size_map *map = map_box(0, &s);
  double h[6];

  (void)state;
  sizes_at(map, 0.25, 0.5, 0.5, h);
  assert_near(h[0], 0.1125, 1e-6);
  sizes_at(map, 0.26, 0.5, 0.5, h);
  assert_near(h[0], 0.1125, 1e-6);
  sizes_at(map, 1.5, 0, 0, h);
  assert_near(h[0], 0.15 + 0.2 * (0.5 - 0.15), 3e-3);
  vg_size_mesh_free(s);
}

/* Outside of cells, the size tensor at the nearest point of a face does. */
static void the_nearest_face_grows(void **state)
{
  struct vg_size_mesh *s = NULL;
  const struct vg_size_map *map = map_box(1, &s);
  double h[6], near[6], exact[6];
  uint64_t seed = 1;

  (void)state;
  for (int i = 0; i < 1000; i++) {
    double x[3] = { 1, random_unit(&seed), random_unit(&seed) };

    linear(x, exact);
    sizes_at(map, 1.001, x[1], x[2], near);
    sizes_at(map, 1.1, x[1], x[2], h);
    for (int k = 0; k < 6; k++) {
      assert_near(near[k], exact[k], 1e-5);
      assert_near(h[k], exact[k], 1e-5);
    }
    sizes_at(map, 1.5, x[1], x[2], h);
    assert_true(h[0] > exact[0] + 0.2 * 0.3 && h[0] < exact[0] + 0.2 * 0.5);
  }
  vg_size_mesh_free(s);
}

static const double at[2][3] = { { 0, 0, 0 }, { 1, 2, 3 } };

static vg_status read_metrics(int components, enum vg_tensor_order order,
                              const double *value, double (*out)[6],
                              struct vg_error *err)
{
  return vg_size_metrics_read("a.sol", 2, at, components, order, value, out,
                              err);
}

static void orders_are_converted(void **state)
{
  const double medit[2][6] = { { 1, 2, 30, 4, 5, 60 }, { 1, 0, 1, 0, 0, 1e9 } };
  const double upper[2][6] = { { 1, 2, 4, 30, 5, 60 }, { 1, 0, 0, 1, 0, 1 } };
  const double vtk[2][6] = { { 1, 30, 60, 2, 5, 4 }, { 1, 1, 1, 0, 0, 0 } };
  const double full[2][9] = { { 1, 2, 4, 2, 30, 5, 4, 5, 60 },
                              { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };
  const double want[6] = { 1, 2, 4, 30, 5, 60 };
  double out[2][6];

  (void)state;
  assert_int_equal(read_metrics(6, VG_TENSOR_MEDIT, medit[0], out, NULL),
                   VG_OK);
  assert_memory_equal(out[0], want, sizeof want);
  assert_int_equal(vg_size_metrics_beyond(2, (const double(*)[6])out, 100), 1);
  assert_int_equal(read_metrics(6, VG_TENSOR_UPPER, upper[0], out, NULL),
                   VG_OK);
  assert_memory_equal(out[0], want, sizeof want);
  assert_int_equal(vg_size_metrics_beyond(2, (const double(*)[6])out, 100), 0);
  assert_int_equal(read_metrics(6, VG_TENSOR_VTK, vtk[0], out, NULL), VG_OK);
  assert_memory_equal(out[0], want, sizeof want);
  assert_int_equal(read_metrics(9, VG_TENSOR_VTK, full[0], out, NULL), VG_OK);
  assert_memory_equal(out[0], want, sizeof want);
}

static void refuse(int components, const double *value, const char *what)
{
  struct vg_error err = VG_ERROR_INIT;
  double out[2][6];

  assert_int_equal(read_metrics(components, VG_TENSOR_MEDIT, value, out, &err),
                   VG_ERR_INPUT);
  if (!strstr(err.text, "a.sol: the metric at point 2, (1, 2, 3), is not ") ||
      !strstr(err.text, what))
    fail_msg("%s", err.text);
}

static void bad_metrics_are_refused(void **state)
{
  const double indefinite[2][6] = { { 1, 0, 1, 0, 0, 1 },
                                    { 1, 0, 1, 0, 2, 1 } };
  const double wrong_order[2][6] = { { 1, 0, 0, 2, 0, 3 },
                                     { 1, 0.5, 0, 2, 0, 3 } };
  const double nan[2][6] = { { 1, 0, 1, 0, 0, 1 }, { 1, 0, 1, 0, 0, NAN } };
  const double skew[2][9] = { { 1, 0, 0, 0, 1, 0, 0, 0, 1 },
                              { 1, 0.5, 0, -0.5, 1, 0, 0, 0, 1 } };
  const double zero[2][6] = { { 1, 0, 1, 0, 0, 1 }, { 0, 0, 0, 0, 0, 0 } };
  struct vg_error err = VG_ERROR_INIT;
  double out[2][6];

  (void)state;
  refuse(6, indefinite[0], "positive; its eigenvalues");
  refuse(6, zero[0], "positive; its eigenvalues");
  refuse(6, nan[0], "finite");
  refuse(9, skew[0], "symmetric");
  assert_int_equal(read_metrics(6, VG_TENSOR_MEDIT, wrong_order[0], out, &err),
                   VG_ERR_INPUT);
  if (!strstr(err.text, "point 1") ||
      !strstr(err.text, "set metric_order to upper"))
    fail_msg("%s", err.text);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(cells_interpolate_linearly),
    cmocka_unit_test(the_nearest_point_grows),
    cmocka_unit_test(the_nearest_face_grows),
    cmocka_unit_test(orders_are_converted),
    cmocka_unit_test(bad_metrics_are_refused),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
