/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/topology/most_normal.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"

#define STEPS_MAX 200
#define SLACK 1e-9 /* Tolerance of a constraint. */

/* Solves G c = 1 for a symmetric matrix G of order k <= 3; returns 0 unless it
 * is positive definite. The Cholesky factorisation is written out because BLAS
 * and LAPACK choose code by processor, and differences in the last bits would
 * change the mesh. */
static int solve_gram(int k, double g[3][3], double c[3])
{
  for (int j = 0; j < k; j++) {
    for (int i = 0; i < j; i++) g[j][j] -= g[i][j] * g[i][j];
    if (!(g[j][j] > 0)) return 0;
    g[j][j] = sqrt(g[j][j]);
    for (int m = j + 1; m < k; m++) {
      for (int i = 0; i < j; i++) g[j][m] -= g[i][j] * g[i][m];
      g[j][m] /= g[j][j];
    }
  }
  for (int j = 0; j < k; j++) {
    c[j] = 1;
    for (int i = 0; i < j; i++) c[j] -= g[i][j] * c[i];
    c[j] /= g[j][j];
  }
  for (int j = k - 1; j >= 0; j--) {
    c[j] /= g[j][j];
    for (int i = 0; i < j; i++) c[i] -= c[j] * g[i][j];
  }
  return 1;
}

/* w for the active normals; 0 unless all weights are positive. */
static int solve(const double (*n)[3], const int *active, int k, double w[3])
{
  double g[3][3], c[3];

  for (int i = 0; i < k; i++)
    for (int j = 0; j < k; j++) g[i][j] = vg_dot(n[active[i]], n[active[j]]);
  if (k == 1) c[0] = g[0][0] > 0 ? 1 / g[0][0] : -1;
  else if (!solve_gram(k, g, c)) return 0;
  memset(w, 0, 3 * sizeof *w);
  for (int i = 0; i < k; i++) {
    if (!(c[i] > 0) || c[i] > 1e12) return 0;
    for (int x = 0; x < 3; x++) w[x] += c[i] * n[active[i]][x];
  }
  return 1;
}

static int keeps(const double (*n)[3], const int *among, int k,
                 const double w[3])
{
  for (int i = 0; i < k; i++)
    if (vg_dot(n[among[i]], w) < 1 - SLACK) return 0;
  return 1;
}

/* Optimum over old[] and the normal that it violates: that normal is active,
 * together with at most two of the others. */
static int exchange(const double (*n)[3], int old[3], int *n_old, int worst,
                    double w[3])
{
  int all[4] = { worst }, k = *n_old;

  memcpy(all + 1, old, (size_t)k * sizeof *old);
  for (int mask = 0; mask < 1 << k; mask++) {
    int set[4] = { worst }, size = 1;

    for (int i = 0; i < k; i++)
      if (mask >> i & 1) set[size++] = old[i];
    if (size > 3 || !solve(n, set, size, w) || !keeps(n, all, k + 1, w))
      continue;
    memcpy(old, set, (size_t)size * sizeof *old);
    *n_old = size;
    return 1;
  }
  return 0;
}

int vg_most_normal(int k, const double (*n)[3], double w[3])
{
  int active[3] = { 0 }, n_active = 1;

  assert(k > 0 && n);
  if (!k || !solve(n, active, 1, w)) return 0;
  for (int step = 0; step < STEPS_MAX; step++) {
    int worst = 0;
    double least = vg_dot(n[0], w);

    for (int i = 1; i < k; i++) {
      double d = vg_dot(n[i], w);

      if (d < least) least = d, worst = i;
    }
    if (least >= 1 - SLACK) return 1;
    if (!exchange(n, active, &n_active, worst, w)) return 0;
  }
  return 0;
}
