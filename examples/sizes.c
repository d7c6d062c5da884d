/* SPDX-License-Identifier: BSD-2-Clause */
/* User-defined sizes: meshes a surface file with a size function that refines
 * around a point, and prints progress. usage: sizes SURFACE X Y Z SIZE STEM */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <vanguard/vanguard.h>

struct focus {
  double at[3], size;
};

/* Called by several threads at once, so it must not change any data. */
static double around(void *user, const double x[3])
{
  const struct focus *f = user;
  double d2 = 0;

  for (int k = 0; k < 3; k++) d2 += (x[k] - f->at[k]) * (x[k] - f->at[k]);
  return f->size + 0.2 * sqrt(d2);
}

/* A non-zero return value would stop the run. */
static int progress(void *user, const char *phase, uint64_t done,
                    uint64_t expected)
{
  (void)user;
  if (expected)
    fprintf(stderr, "%s: %.0f %%\n", phase,
            100.0 * (double)done / (double)expected);
  return 0;
}

int main(int argc, char **argv)
{
  struct vanguard_quality q = VANGUARD_INIT(q);
  struct vanguard_counts n = VANGUARD_INIT(n);
  struct focus f;
  vanguard_job *job;
  int bad;

  if (argc != 7) return fprintf(stderr, "sizes SURFACE X Y Z SIZE STEM\n"), 2;
  for (int k = 0; k < 3; k++) f.at[k] = atof(argv[2 + k]);
  f.size = atof(argv[5]);
  vanguard_prepare();
  bad = vanguard_new(VANGUARD_ABI, &job) || vanguard_open(job, argv[1], NULL) ||
        vanguard_sizes(job, around, &f) || vanguard_mesh(job, progress, NULL) ||
        vanguard_count(job, &n) || vanguard_measure(job, &q) ||
        vanguard_write(job, argv[6], "b8.ugrid");
  if (bad)
    fprintf(stderr, "%s\n%s", vanguard_message(job), vanguard_details(job));
  else
    printf("%llu tetrahedra, dihedral angles from %.1f to %.1f degrees\n",
           (unsigned long long)n.n_tet, q.angle_min, q.angle_max);
  vanguard_free(job);
  return bad;
}
