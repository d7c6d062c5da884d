/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* bench_sizing [N [M [GROWTH [SPAN [THREADS]]]]]: cost of the sizing field.
 *
 * A sphere of 12 N^2 triangles within a box of 12 M^2 triangles, SPAN times
 * larger: time to build, leaves of the octree, evaluations per second at random
 * points of the box, at random points near the sphere, and along a walk like
 * that of a mesher. Prints one line per figure. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/sizing/sizing.h"

static double clock_of(clockid_t id)
{
  struct timespec t;

  clock_gettime(id, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Processor time of this program: other load on the machine is not counted. */
static double now(void)
{
  return clock_of(CLOCK_PROCESS_CPUTIME_ID);
}

static double random_unit(uint64_t *state)
{
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return (double)(*state >> 11) * 0x1p-53;
}

/* Six faces of n x n squares of two triangles each. Faces do not share points,
 * which the sizing field does not need. */
static void add_cube(struct vg_mesh *m, int n, double radius, int round)
{
  for (int f = 0; f < 6; f++) {
    size_t base = m->n_point;

    for (int j = 0; j <= n; j++)
      for (int i = 0; i <= n; i++) {
        double *p = m->point[m->n_point++], scale = radius;
        double a = 2.0 * i / n - 1, b = 2.0 * j / n - 1;

        if (round) {
          a = tan(a * 0.7853981633974483);
          b = tan(b * 0.7853981633974483);
          scale /= sqrt(1 + a * a + b * b);
        }
        p[f / 2] = f % 2 ? scale : -scale;
        p[(f / 2 + 1) % 3] = a * scale;
        p[(f / 2 + 2) % 3] = b * scale;
      }
    for (int j = 0; j < n; j++)
      for (int i = 0; i < n; i++) {
        uint32_t v = (uint32_t)(base + (size_t)(j * (n + 1) + i));
        uint32_t w = v + (uint32_t)n + 1;
        uint32_t t[2][3] = { { v, v + 1, w + 1 }, { v, w + 1, w } };

        memcpy(m->tri + m->n_tri, t, sizeof t);
        m->n_tri += 2;
      }
  }
}

static void rate(const char *what, const struct vg_sizing *s, size_t n,
                 const double (*x)[3], double *h)
{
  double sum = 0, t;

  vg_sizing_eval(s, n, x, h);
  t = now();
  vg_sizing_eval(s, n, x, h);
  t = now() - t;
  for (size_t i = 0; i < n; i++) sum += h[i];
  printf("%-22s %8.2f M points/s   (mean %g)\n", what, n / t * 1e-6, sum / n);
}

int main(int argc, char **argv)
{
  int n = argc > 1 ? atoi(argv[1]) : 100, m = argc > 2 ? atoi(argv[2]) : 50;
  double span = argc > 4 ? atof(argv[4]) : 10, lo, hi, t, wall;
  size_t n_tri = 12 * (size_t)(n * n + m * m), count = 1u << 21;
  size_t n_point = 6 * (size_t)((n + 1) * (n + 1) + (m + 1) * (m + 1));
  struct vg_mesh mesh = VG_MESH_INIT;
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *s = NULL;
  struct vg_error err = VG_ERROR_INIT;
  double(*x)[3] = malloc(count * sizeof *x), *h = malloc(count * sizeof *h);
  uint64_t seed = 1;

  if (argc > 3) options.growth = atof(argv[3]);
  if (argc > 5) options.threads = atoi(argv[5]);
  mesh.point = malloc(n_point * sizeof *mesh.point);
  mesh.tri = malloc(n_tri * sizeof *mesh.tri);
  if (!x || !h || !mesh.point || !mesh.tri) return 1;
  add_cube(&mesh, n, 1, 1);
  add_cube(&mesh, m, span, 0);
  wall = clock_of(CLOCK_MONOTONIC);
  t = now();
  if (vg_sizing_new(&options, 0, NULL, &mesh, &s, &err) < 0) {
    fprintf(stderr, "%s\n", err.text);
    return 1;
  }
  t = now() - t;
  wall = clock_of(CLOCK_MONOTONIC) - wall;
  vg_sizing_range(s, &lo, &hi);
  printf("triangles %zu, sizes %g to %g\n", mesh.n_tri, lo, hi);
  printf("build                  %8.3f s of processors, %.3f s, %zu leaves\n",
         t, wall, vg_sizing_leaves(s));
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) x[i][k] = span * (2 * random_unit(&seed) - 1);
  rate("random in the box", s, count, (const double(*)[3])x, h);
  for (size_t i = 0; i < count; i++)
    for (int k = 0; k < 3; k++) x[i][k] = 1.2 * (2 * random_unit(&seed) - 1);
  rate("random near the sphere", s, count, (const double(*)[3])x, h);
  for (int k = 0; k < 3; k++) x[0][k] = 0.7;
  for (size_t i = 1; i < count; i++)
    for (int k = 0; k < 3; k++) {
      x[i][k] = x[i - 1][k] + 0.02 * (2 * random_unit(&seed) - 1);
      if (fabs(x[i][k]) > span) x[i][k] = x[i - 1][k];
    }
  rate("along a walk", s, count, (const double(*)[3])x, h);
  vg_sizing_free(s);
  vg_mesh_release(&mesh);
  free(x);
  free(h);
  return 0;
}
