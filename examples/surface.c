/* SPDX-License-Identifier: BSD-2-Clause */
/* Minimal complete program: meshes the inside of a surface given in memory and
 * writes a file.
 *
 *   cc surface.c $(pkg-config --cflags --libs vanguard) -o surface */
#include <stdio.h>
#include <vanguard/vanguard.h>

int main(void)
{
  /* A cube. Its triangles are counter-clockwise seen from inside, so the fluid
   * is inside the cube, and the cube is a domain rather than a body. */
  const double xyz[8][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 },
    { 0, 0, 1 }, { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 }
  };
  const uint32_t tri[12][3] = { { 0, 1, 2 }, { 0, 2, 3 }, { 4, 6, 5 },
                                { 4, 7, 6 }, { 0, 5, 1 }, { 0, 4, 5 },
                                { 1, 6, 2 }, { 1, 5, 6 }, { 2, 7, 3 },
                                { 2, 6, 7 }, { 3, 4, 0 }, { 3, 7, 4 } };
  const int32_t patch[12] = { 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6 };
  struct vanguard_counts n = VANGUARD_INIT(n);
  vanguard_job *job;
  int bad = vanguard_new(VANGUARD_ABI, &job);

  if (!bad) bad = vanguard_surface(job, "cube", 8, xyz[0], 12, tri[0], patch);
  if (!bad) bad = vanguard_set(job, "hmax", "0.2");
  if (!bad) bad = vanguard_mesh(job, NULL, NULL);
  if (!bad) bad = vanguard_write(job, "cube", "b8.ugrid,vtu");
  if (!bad) bad = vanguard_count(job, &n);
  if (bad) printf("%s\n", vanguard_message(job));
  else
    printf("%llu points, %llu tetrahedra\n", (unsigned long long)n.n_point,
           (unsigned long long)n.n_tet);
  for (size_t i = 0; vanguard_note(job, i); i++)
    printf("note: %s\n", vanguard_note(job, i));
  vanguard_free(job);
  return bad != 0;
}
