/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Case `library` of faults.py: the functions of the library in one program.
 * Usage: library FILE.b8.ugrid */
#include <stdio.h>
#include <stdlib.h>
#include <vanguard.h>

static const double xyz[8][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 },
                                  { 0, 1, 0 }, { 0, 0, 1 }, { 1, 0, 1 },
                                  { 1, 1, 1 }, { 0, 1, 1 } };
static const uint32_t tri[12][3] = { { 0, 1, 2 }, { 0, 2, 3 }, { 4, 6, 5 },
                                     { 4, 7, 6 }, { 0, 5, 1 }, { 0, 4, 5 },
                                     { 1, 6, 2 }, { 1, 5, 6 }, { 2, 7, 3 },
                                     { 2, 6, 7 }, { 3, 4, 0 }, { 3, 7, 4 } };
static const int32_t patch[12] = { 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6 };

/* The status of the first call that fails. */
static int mesh(vanguard_job *job, const char *stem)
{
  struct vanguard_counts n = VANGUARD_INIT(n);
  int bad = vanguard_surface(job, "cube", 8, xyz[0], 12, tri[0], patch);

  if (!bad) bad = vanguard_set(job, "hmax", "0.3");
  if (!bad) bad = vanguard_mesh(job, NULL, NULL);
  if (!bad) bad = vanguard_count(job, &n);
  if (!bad) bad = vanguard_write(job, stem, "b8.ugrid,vtu,foam");
  if (!bad) printf("%llu tetrahedra\n", (unsigned long long)n.n_tet);
  return bad;
}

int main(int argc, char **argv)
{
  vanguard_job *job;
  int bad = argc == 2 ? vanguard_new(VANGUARD_ABI, &job) : 1;

  if (!bad) bad = mesh(job, argv[1]);
  if (bad)
    fprintf(stderr, "library: %d: %s\n", bad,
            argc == 2 ? vanguard_message(job) : "no name");
  if (argc == 2) vanguard_free(job);
  return bad != 0;
}
