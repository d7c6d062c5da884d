/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The most normal direction, compared with a search through all active sets,
 * whose systems LAPACK solves. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <lapacke.h>

#include "core/geometry/vector.h"
#include "layers/topology/most_normal.h"

enum { MOST = 7 };

/* The shortest w with w . n = 1 for the normals of a set; 0 if it does
 * not exist. */
static int solve(const double (*n)[3], const int *set, int k, double w[3])
{
  double g[9], c[3] = { 1, 1, 1 };

  for (int i = 0; i < k; i++)
    for (int j = 0; j < k; j++) g[i * k + j] = vg_dot(n[set[i]], n[set[j]]);
  if (LAPACKE_dposv(LAPACK_COL_MAJOR, 'U', k, 1, g, k, c, k)) return 0;
  memset(w, 0, 3 * sizeof *w);
  for (int i = 0; i < k; i++)
    for (int x = 0; x < 3; x++) w[x] += c[i] * n[set[i]][x];
  return 1;
}

/* Length of the shortest w that satisfies all constraints; INFINITY: there is
 * none. */
static double search(int k, const double (*n)[3], double best[3])
{
  double least = INFINITY;

  for (int mask = 1; mask < 1 << k; mask++) {
    int set[MOST], size = 0, keeps = 1;
    double w[3];

    for (int i = 0; i < k; i++)
      if (mask >> i & 1) set[size++] = i;
    if (size > 3 || !solve(n, set, size, w)) continue;
    for (int i = 0; i < k; i++) keeps &= vg_dot(n[i], w) >= 1 - 1e-9;
    if (!keeps || vg_norm(w) >= least) continue;
    least = vg_norm(w);
    memcpy(best, w, 3 * sizeof *w);
  }
  return least;
}

static double chance(void)
{
  return (double)rand() / RAND_MAX * 2 - 1;
}

/* Unit vectors within a cone about z: the wider the cone, the fewer sets have a
 * direction that sees all of them. */
static void make_normals(int k, double wide, double (*n)[3])
{
  for (int i = 0; i < k; i++) {
    n[i][0] = wide * chance();
    n[i][1] = wide * chance();
    n[i][2] = wide > 2 ? chance() : 1;
    vg_unit(n[i]);
  }
}

static void finds_the_shortest_vector(void **state)
{
  int n_none = 0, n_some = 0;

  (void)state;
  srand(7);
  for (int round = 0; round < 4000; round++) {
    int k = 1 + round % MOST;
    double n[MOST][3], w[3], best[3], least;
    int got;

    make_normals(k, round % 4 ? 0.3 * (round % 9) + 0.01 : 3, n);
    least = search(k, (const double(*)[3])n, best);
    got = vg_most_normal(k, (const double(*)[3])n, w);
    if (least > 1e4) continue; /* hardly visible, or not at all */
    assert_true(got);
    n_some++;
    assert_true(fabs(vg_norm(w) / least - 1) < 1e-7);
    for (int x = 0; x < 3; x++)
      assert_true(fabs(w[x] - best[x]) < 1e-5 * least);
  }
  for (int round = 0; round < 1000; round++) {
    double n[2][3] = { { chance(), chance(), 1 } }, w[3];

    vg_unit(n[0]);
    for (int x = 0; x < 3; x++) n[1][x] = -n[0][x];
    n_none += !vg_most_normal(2, (const double(*)[3])n, w);
  }
  assert_true(n_some > 2000);
  assert_int_equal(n_none, 1000);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(
    finds_the_shortest_vector) };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
