/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Hessians of a solution, and the metric of least interpolation error. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/geometry/tensor.h"
#include "core/geometry/vector.h"
#include "core/hessian/multiscale.h"

enum { SIDE = 9 }; /* cubes along a side */

static double uniform(uint32_t *state)
{
  *state = *state * 1664525 + 1013904223;
  return *state / 4294967296.0;
}

static uint32_t at(int i, int j, int k)
{
  return (uint32_t)((k * (SIDE + 1) + j) * (SIDE + 1) + i);
}

/* The unit cube of six tetrahedra for each small cube. Points inside are moved
 * by up to `jitter` of a side. The lowest `n_prism` sheets of cubes become two
 * prisms each. */
static void make_cube(struct vg_mesh *m, double jitter, int n_prism)
{
  static const int way[6][3] = { { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 },
                                 { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 } };
  uint32_t random = 7;

  *m = (struct vg_mesh)VG_MESH_INIT;
  m->n_point = (SIDE + 1) * (SIDE + 1) * (SIDE + 1);
  m->point = calloc(m->n_point, sizeof *m->point);
  m->tet = calloc(6 * SIDE * SIDE * SIDE, sizeof *m->tet);
  m->pri = calloc(2 * SIDE * SIDE * SIDE, sizeof *m->pri);
  for (int i = 0; i <= SIDE; i++)
    for (int j = 0; j <= SIDE; j++)
      for (int k = 0; k <= SIDE; k++) {
        const int v[3] = { i, j, k };
        int inside = k > n_prism;

        for (int c = 0; c < 3; c++) inside = inside && v[c] && v[c] < SIDE;
        for (int c = 0; c < 3; c++)
          m->point[at(i, j, k)][c] =
            (v[c] + (inside ? jitter * (2 * uniform(&random) - 1) : 0)) / SIDE;
      }
  for (int i = 0; i < SIDE; i++)
    for (int j = 0; j < SIDE; j++)
      for (int k = 0; k < SIDE; k++)
        for (int w = 0; w < 6; w++) {
          int v[3] = { i, j, k };
          uint32_t *to = m->tet[m->n_tet], kept;

          if (k < n_prism) continue;
          to[0] = at(i, j, k);
          for (int c = 0; c < 3; c++) {
            v[way[w][c]]++;
            to[c + 1] = at(v[0], v[1], v[2]);
          }
          if (w == 1 || w == 2 || w == 5) { /* odd permutations */
            kept = to[1];
            to[1] = to[2];
            to[2] = kept;
          }
          m->n_tet++;
        }
  for (int i = 0; i < SIDE; i++)
    for (int j = 0; j < SIDE; j++)
      for (int k = 0; k < n_prism; k++)
        for (int s = 0; s < 2; s++) {
          uint32_t *to = m->pri[m->n_pri++];

          for (int c = 0; c < 2; c++) {
            to[3 * c] = at(i, j, k + c);
            to[3 * c + 1] = at(i + 1, j + s, k + c);
            to[3 * c + 2] = at(i + !s, j + 1, k + c);
          }
        }
}

/* 2 x^2 + x y - y^2 / 2 + 3 z^2 - y z + x: a constant Hessian. */
static double quadratic(const double x[3])
{
  return 2 * x[0] * x[0] + x[0] * x[1] - x[1] * x[1] / 2 + 3 * x[2] * x[2] -
         x[1] * x[2] + x[0];
}
static const double hessian_of_quadratic[6] = { 4, 1, 0, -1, -1, 6 };

static double *values_of(const struct vg_mesh *m, double f(const double x[3]))
{
  double *v = calloc(m->n_point, sizeof *v);

  for (size_t p = 0; p < m->n_point; p++) v[p] = f(m->point[p]);
  return v;
}

/* The Hessian of a quadratic, whose values v may be wrong in the layers, is
 * exact at all points. Releases m and v. */
static void expect_exact(struct vg_mesh *m, double *v, size_t n_layer,
                         size_t n_left_out)
{
  struct vg_estimate e = VG_ESTIMATE_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double(*h)[6] = calloc(m->n_point, sizeof *h);

  assert_int_equal(vg_estimate_open(&e, m, n_layer, &err), VG_OK);
  assert_int_equal(e.n_left_out, n_left_out);
  assert_int_equal(vg_hessian(&e, v, h, &err), VG_OK);
  for (size_t p = 0; p < m->n_point; p++)
    for (int k = 0; k < 6; k++)
      assert_true(fabs(h[p][k] - hessian_of_quadratic[k]) < 1e-9);
  vg_estimate_release(&e);
  free(h);
  free(v);
  vg_mesh_release(m);
}

/* Values of the quadratic above the height z, and wrong ones below. */
static double *values_above(const struct vg_mesh *m, double z)
{
  double *v = values_of(m, quadratic);

  for (size_t p = 0; p < m->n_point; p++)
    if (m->point[p][2] < z) v[p] = 1e6 * (double)p;
  return v;
}

/* On the boundary and in its first ring as well. */
static void exact_for_quadratics(void **state)
{
  struct vg_mesh m;

  (void)state;
  make_cube(&m, 0, 0);
  expect_exact(&m, values_of(&m, quadratic), 0, 0);
}

/* Prisms next to tetrahedra are layers: values there change nothing. */
static void layers_are_left_out(void **state)
{
  struct vg_mesh m;

  (void)state;
  make_cube(&m, 0, 3);
  expect_exact(&m, values_above(&m, 2.5 / SIDE), 0, 3 * 2 * SIDE * SIDE);
}

/* The first tetrahedra, in sheets above z = 0, are layers. */
static void layer_tetrahedra_are_left_out(void **state)
{
  struct vg_mesh m;
  size_t n_layer = 0;

  (void)state;
  make_cube(&m, 0, 0);
  for (size_t i = 0; i < m.n_tet; i++) { /* those below come first */
    double z = 0;
    uint32_t kept[4];

    for (int k = 0; k < 4; k++) z += m.point[m.tet[i][k]][2] / 4;
    if (z > 2.0 / SIDE) continue;
    memcpy(kept, m.tet[i], sizeof kept);
    memmove(m.tet[n_layer + 1], m.tet[n_layer], (i - n_layer) * sizeof *m.tet);
    memcpy(m.tet[n_layer++], kept, sizeof kept);
  }
  assert_int_equal(n_layer, 6 * 2 * SIDE * SIDE);
  expect_exact(&m, values_above(&m, 1.5 / SIDE), n_layer, n_layer);
}

/* A mesh of prisms alone has no layers to leave out. */
static void prisms_alone(void **state)
{
  struct vg_mesh m;

  (void)state;
  make_cube(&m, 0, SIDE);
  assert_int_equal(m.n_tet, 0);
  expect_exact(&m, values_of(&m, quadratic), 0, 0);
}

/* A layer at x = 0.5, and one at y = 0.3. */
static double front_x(const double x[3])
{
  return tanh((x[0] - 0.5) / 0.1);
}
static double front_y(const double x[3])
{
  return 1e5 * tanh((x[1] - 0.3) / 0.1);
}

/* The metric of one or two functions on a moved mesh. *e: of *m. */
static double (*metric_of(struct vg_mesh *m, struct vg_estimate *e, int n,
                          const struct vg_multiscale_options *o,
                          struct vg_multiscale_report *r))[6]
{
  struct vg_error err = VG_ERROR_INIT;
  double(*h)[6], (*metric)[6];

  make_cube(m, 0.2, 0);
  h = calloc(m->n_point, sizeof *h);
  metric = calloc(m->n_point, sizeof *metric);
  assert_int_equal(vg_estimate_open(e, m, 0, &err), VG_OK);
  for (int i = 0; i < n; i++) {
    double *v = values_of(m, i ? front_y : front_x);

    assert_int_equal(vg_hessian(e, v, h, &err), VG_OK);
    assert_int_equal(vg_multiscale_add(e, v, (const double(*)[6])h, o->norm,
                                       i == 0, metric, &err),
                     VG_OK);
    free(v);
  }
  assert_int_equal(vg_multiscale_scale(e, o, metric, r, &err), VG_OK);
  free(h);
  return metric;
}

/* Complexity, growth and bounds are as requested. */
static void metric_as_requested(void **state)
{
  const int norms[] = { 1, 2, 4, VG_NORM_MAX };
  const double log_growth = log(1.5);

  (void)state;
  for (size_t i = 0; i < sizeof norms / sizeof *norms; i++) {
    struct vg_multiscale_options o = { 3000, norms[i], 1.5, 0, 0.3, 20 };
    struct vg_multiscale_report r;
    struct vg_estimate e = VG_ESTIMATE_INIT;
    struct vg_mesh m;
    double(*metric)[6] = metric_of(&m, &e, 2, &o, &r), sum = 0;

    for (size_t p = 0; p < m.n_point; p++) {
      double value[3], vector[3][3];

      vg_tensor_eigen(metric[p], value, vector);
      assert_true(value[0] > (1 - 1e-9) / (0.3 * 0.3));
      assert_true(value[2] < value[0] * 400 * (1 + 1e-9));
      sum += e.volume[p] * sqrt(vg_tensor_det(metric[p]));
    }
    assert_true(fabs(sum - 3000) < 0.005 * 3000);
    assert_true(fabs(r.complexity - sum) < 1e-9 * sum);
    assert_true(r.aspect_most < 20 * (1 + 1e-9) && r.h_most < 0.3 * (1 + 1e-9));
    for (size_t k = 0; k < e.n_edge; k++)
      for (int s = 0; s < 2; s++) { /* lengths along the edge itself */
        double way[3], from, to;

        vg_sub(m.point[e.edge[k][1]], m.point[e.edge[k][0]], way);
        from = sqrt(vg_tensor_form(metric[e.edge[k][s]], way));
        to = sqrt(vg_tensor_form(metric[e.edge[k][!s]], way));
        assert_true(from / to < (1 + from * log_growth) * 1.02);
      }
    vg_estimate_release(&e);
    free(metric);
    vg_mesh_release(&m);
  }
}

/* Edge length in a direction at the point nearest to x. */
static double length_at(const struct vg_mesh *m, const double (*metric)[6],
                        const double x[3], const double way[3])
{
  size_t best = 0;
  double least = INFINITY;

  for (size_t p = 0; p < m->n_point; p++) {
    double d[3];

    vg_sub(m->point[p], x, d);
    if (vg_dot(d, d) < least) least = vg_dot(d, d), best = p;
  }
  return 1 / sqrt(vg_tensor_form(metric[best], way));
}

/* Edges are short across a front and long along it; with two functions both
 * fronts are resolved, whatever their units. */
static void metric_follows_fronts(void **state)
{
  const struct vg_multiscale_options o = { 3000, 2, 3, 0, INFINITY, 100 };
  const double in_x[3] = { 0.5, 0.75, 0.5 }, in_y[3] = { 0.15, 0.3, 0.5 };
  const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 };
  double alone = 0;

  (void)state;
  for (int n = 1; n <= 2; n++) {
    struct vg_multiscale_report r;
    struct vg_estimate e = VG_ESTIMATE_INIT;
    struct vg_mesh m;
    double(*metric)[6] = metric_of(&m, &e, n, &o, &r);
    const double(*all)[6] = (const double(*)[6])metric;

    assert_true(length_at(&m, all, in_x, y) >
                2.5 * length_at(&m, all, in_x, x));
    if (n == 1) alone = length_at(&m, all, in_y, y);
    else assert_true(length_at(&m, all, in_y, y) < alone / 3);
    vg_estimate_release(&e);
    free(metric);
    vg_mesh_release(&m);
  }
}

/* Bounds that do not admit the complexity end the search; the report says what
 * was reached. */
static void bounds_come_first(void **state)
{
  const struct vg_multiscale_options o = { 1e6, 2, 1.5, 0.2, 0.4, 10 };
  struct vg_multiscale_report r;
  struct vg_estimate e = VG_ESTIMATE_INIT;
  struct vg_mesh m;
  double(*metric)[6] = metric_of(&m, &e, 1, &o, &r);

  (void)state;
  assert_true(r.complexity > 100 && r.complexity < 126); /* 1 / 0.2^3 */
  assert_int_equal(r.n_min, m.n_point);
  assert_true(r.h_least > 0.2 * (1 - 1e-9));
  vg_estimate_release(&e);
  free(metric);
  vg_mesh_release(&m);
}

static double linear(const double x[3])
{
  return 3 * x[0] - x[2];
}
static double zero(const double x[3])
{
  (void)x;
  return 0;
}
static double rounded(const double x[3]) /* to 4 bytes */
{
  return (float)(300 + 1e-4 * x[1]);
}
static double curved(const double x[3])
{
  return 300 + x[1] * x[1];
}

static void refuses(void **state)
{
  struct vg_mesh m, empty = VG_MESH_INIT;
  struct vg_estimate e = VG_ESTIMATE_INIT;
  struct vg_error err = VG_ERROR_INIT;
  double (*const f[])(const double[3]) = { zero, linear, rounded, curved };
  double(*h)[6], (*metric)[6], *v;

  (void)state;
  assert_int_equal(vg_estimate_open(&e, &empty, 0, &err), VG_ERR_INPUT);
  make_cube(&m, 0, 0);
  m.n_tet = 6;
  assert_int_equal(vg_estimate_open(&e, &m, 0, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "boundary"));
  m.n_tet = 6 * SIDE * SIDE * SIDE;
  h = calloc(m.n_point, sizeof *h);
  metric = calloc(m.n_point, sizeof *metric);
  assert_int_equal(vg_estimate_open(&e, &m, 0, &err), VG_OK);
  for (size_t i = 0; i < 4; i++) {
    v = values_of(&m, f[i]);
    assert_int_equal(vg_hessian(&e, v, h, &err), VG_OK);
    assert_int_equal(vg_multiscale_add(&e, v, (const double(*)[6])h, 2, 1,
                                       metric, &err),
                     i < 3 ? VG_ERR_INPUT : VG_OK);
    if (i < 3) assert_non_null(strstr(err.text, "linear"));
    free(v);
  }
  free(metric);
  vg_estimate_release(&e);
  free(h);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(exact_for_quadratics),
    cmocka_unit_test(layers_are_left_out),
    cmocka_unit_test(layer_tetrahedra_are_left_out),
    cmocka_unit_test(prisms_alone),
    cmocka_unit_test(metric_as_requested),
    cmocka_unit_test(metric_follows_fronts),
    cmocka_unit_test(bounds_come_first),
    cmocka_unit_test(refuses),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
