/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shapes of many tetrahedra at once (core/judge/quality_tets.c), compared with
 * plain formulas in extended precision, cell by cell. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "core/geometry/predicates.h"
#include "core/judge/quality_tets.h"

#define CELLS (3 * VG_TET_BATCH + 5)
#define DEGREE 57.29577951308232087680L

static uint64_t seed = 1;

/* From -0.5 to 0.5. */
static double random_number(void)
{
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(int32_t)(seed >> 32) * 0x1p-32;
}

/* Random cells, stretched in one direction by up to 1e5, of sizes from 1e-6 to
 * 1e6, about half of them negative; every seventh one has all nodes in a plane,
 * every eleventh one a repeated node. */
static struct vg_mesh random_cells(void)
{
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = 4 * CELLS;
  m.n_tet = CELLS;
  m.point = vg_calloc(m.n_point, sizeof *m.point);
  m.tet = vg_calloc(m.n_tet, sizeof *m.tet);
  assert_true(m.point && m.tet);
  for (uint32_t i = 0; i < CELLS; i++) {
    double size = pow(10, 12 * random_number());
    double thin = pow(10, -5 * fabs(random_number()) * 2);

    for (uint32_t k = 0; k < 4; k++) {
      double *x = m.point[4 * i + k];

      for (int d = 0; d < 3; d++) x[d] = size * random_number();
      x[2] *= i % 7 ? thin : 0;
      m.tet[i][k] = 4 * i + (i % 11 == 0 && k == 3 ? 0 : k);
    }
  }
  return m;
}

struct shape {
  long double least, most, volume, radius_ratio, mean_ratio, edge;
};

static void cross(const long double a[3], const long double b[3],
                  long double c[3])
{
  for (int k = 0; k < 3; k++)
    c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}
static long double dot(const long double a[3], const long double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Angles between the outward normals of all pairs of faces. 0: a face has no
 * area. */
static int find_angles(const long double n[4][3], struct shape *s)
{
  s->least = 180;
  s->most = 0;
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < i; j++) {
      long double c = dot(n[i], n[j]) /
                      sqrtl(dot(n[i], n[i]) * dot(n[j], n[j]));
      long double angle = 180 - DEGREE * acosl(fminl(fmaxl(c, -1), 1));

      if (!(dot(n[i], n[i]) > 0 && dot(n[j], n[j]) > 0)) return 0;
      s->least = fminl(s->least, angle);
      s->most = fmaxl(s->most, angle);
    }
  return 1;
}

/* Returns 0 if a face has no area. */
static int measure(const struct vg_mesh *m, size_t i, struct shape *s)
{
  long double e[3][3], n[4][3], q[3], area = 0, sum = 0, six;

  for (int k = 0; k < 3; k++)
    for (int d = 0; d < 3; d++)
      e[k][d] = (long double)m->point[m->tet[i][k + 1]][d] -
                (long double)m->point[m->tet[i][0]][d];
  for (int k = 0; k < 3; k++) cross(e[(k + 1) % 3], e[(k + 2) % 3], n[k + 1]);
  for (int d = 0; d < 3; d++) {
    n[0][d] = -n[1][d] - n[2][d] - n[3][d];
    q[d] = 0;
    for (int k = 0; k < 3; k++) q[d] += dot(e[k], e[k]) * n[k + 1][d];
  }
  six = dot(n[3], e[2]);
  for (int k = 0; k < 4; k++) area += sqrtl(dot(n[k], n[k])) / 2;
  for (int k = 0; k < 3; k++) {
    long double side[3];

    for (int d = 0; d < 3; d++) side[d] = e[k][d] - e[(k + 1) % 3][d];
    sum += dot(e[k], e[k]) + dot(side, side);
  }
  s->volume = six / 6;
  s->edge = sqrtl(sum / 6);
  s->mean_ratio = 12 * cbrtl(six * six / 4) / sum;
  s->radius_ratio = 3 * (fabsl(six) / 2 / area) * 2 * fabsl(six) /
                    sqrtl(dot(q, q));
  return find_angles(n, s);
}

static void assert_near(double x, long double expected, long double within)
{
  if (!(fabsl((long double)x - expected) <= within))
    print_message("%.17g instead of %.17Lg\n", x, expected);
  assert_true(fabsl((long double)x - expected) <= within);
}

static struct vg_tet_batch *measured(const struct vg_mesh *m, size_t first,
                                     size_t n)
{
  struct vg_tet_batch *b = vg_calloc(1, sizeof *b);

  assert_non_null(b);
  vg_tets_measure(m, first, n, b);
  assert_int_equal(b->n, n);
  return b;
}

/* Angles near 0 and 180 degrees have errors of the square root of the rounding
 * error of the cosine, 1e-8, times 57. */
static void shapes_are_those_of_plain_formulas(void **state)
{
  struct vg_mesh m = random_cells();

  (void)state;
  for (size_t i = 0; i < CELLS; i += VG_TET_BATCH) {
    size_t n = CELLS - i < VG_TET_BATCH ? CELLS - i : VG_TET_BATCH;
    struct vg_tet_batch *b = measured(&m, i, n);

    for (size_t t = 0; t < n; t++) {
      const uint32_t *v = m.tet[i + t];
      double six = vg_orient3d(m.point[v[0]], m.point[v[1]], m.point[v[2]],
                               m.point[v[3]]);
      struct shape s;
      int has_area = measure(&m, i + t, &s);

      assert_int_equal((b->volume[t] > 0) - (b->volume[t] < 0),
                       (six > 0) - (six < 0));
      assert_near(b->edge[t], s.edge, 1e-14L * s.edge);
      assert_near(b->least[t], has_area ? s.least : 0, 2e-5L);
      assert_near(b->most[t], has_area ? s.most : 180, 2e-5L);
      if (!has_area) continue;
      assert_near(b->volume[t], s.volume,
                  1e-10L * fabsl(s.volume) + 1e-15L * s.edge * s.edge * s.edge);
      assert_near(b->radius_ratio[t], s.radius_ratio, 1e-9L);
      assert_near(b->mean_ratio[t], s.mean_ratio, 1e-9L);
    }
    free(b);
  }
  vg_mesh_release(&m);
}

/* A cell has the same bits in a batch, which is measured by vectors, and alone.
 */
static void vectors_have_the_bits_of_single_cells(void **state)
{
  struct vg_mesh m = random_cells();
  struct vg_tet_batch *b = measured(&m, 0, VG_TET_BATCH);

  (void)state;
  for (size_t t = 0; t < VG_TET_BATCH; t++) {
    struct vg_tet_batch *one = measured(&m, t, 1);

    assert_memory_equal(&b->least[t], one->least, sizeof *one->least);
    assert_memory_equal(&b->most[t], one->most, sizeof *one->most);
    assert_memory_equal(&b->volume[t], one->volume, sizeof *one->volume);
    assert_memory_equal(&b->edge[t], one->edge, sizeof *one->edge);
    assert_memory_equal(&b->radius_ratio[t], one->radius_ratio,
                        sizeof *one->radius_ratio);
    assert_memory_equal(&b->mean_ratio[t], one->mean_ratio,
                        sizeof *one->mean_ratio);
    free(one);
  }
  free(b);
  vg_mesh_release(&m);
}

static int32_t bin(double x, double per_unit, int32_t n)
{
  double at = x * per_unit;

  return !(at > 0) ? 0 : at < n ? (int32_t)at : n - 1;
}

/* Angles on and next to the borders of bins, and outside of all bins. */
static void counts_are_those_of_a_loop(void **state)
{
  static const double low[5] = { 5, 10, 15, 20, 30 };
  static const double high[3] = { 150, 160, 170 };
  struct vg_tet_batch *b = vg_calloc(1, sizeof *b);
  struct vg_tet_bins c;

  (void)state;
  assert_non_null(b);
  for (b->n = 0; b->n <= VG_TET_BATCH; b->n += b->n < 9 ? 1 : 7) {
    double least = 180, most = 0, ratio = 1;
    uint64_t below[5] = { 0 }, above[3] = { 0 };

    for (size_t t = 0; t < b->n; t++) {
      double border = 5 * floor(18 + 42 * random_number());

      b->least[t] = nextafter(border, t % 3 ? 400 * (t % 3 == 1) : border);
      b->most[t] = 180 - b->least[t];
      b->radius_ratio[t] = t % 5 ? 0.5 + random_number() : border / 100;
    }
    vg_tets_count(b, &c);
    for (size_t t = 0; t < b->n; t++) {
      double a = b->least[t], z = b->most[t], r = b->radius_ratio[t];

      assert_int_equal(c.angle_min[t], bin(a, 1 / 5., VG_HIST_ANGLE));
      assert_int_equal(c.angle_max[t], bin(z, 1 / 5., VG_HIST_ANGLE));
      assert_int_equal(c.fine[t], bin(a, VG_FINE_PER_DEGREE, VG_N_FINE));
      assert_int_equal(c.radius_ratio[t], bin(r, VG_HIST_UNIT, VG_HIST_UNIT));
      for (int k = 0; k < 5; k++) below[k] += a < low[k];
      for (int k = 0; k < 3; k++) above[k] += z > high[k];
      least = fmin(least, a);
      most = fmax(most, z);
      ratio = fmin(ratio, r);
    }
    assert_memory_equal(c.below, below, sizeof below);
    assert_memory_equal(c.above, above, sizeof above);
    assert_true(c.angle_least == least && c.angle_most == most);
    assert_true(c.radius_ratio_least == ratio);
  }
  free(b);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(shapes_are_those_of_plain_formulas),
    cmocka_unit_test(vectors_have_the_bits_of_single_cells),
    cmocka_unit_test(counts_are_those_of_a_loop),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
