/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/cut/needles.h"

#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"

/* C19 */
#define ASPECT 100.0 /* longest side over height */
#define MANY 0.1     /* as a share of all faces, crossing one plane */

static int is_needle(const double *const x[3])
{
  double e[3], f[3], n[3], longest = 0;

  for (int k = 0; k < 3; k++) {
    vg_sub(x[(k + 1) % 3], x[k], e);
    longest = fmax(longest, vg_dot(e, e));
  }
  vg_sub(x[1], x[0], e);
  vg_sub(x[2], x[0], f);
  vg_cross(e, f, n);
  return longest > ASPECT * vg_norm(n);
}

/* Number of planes of the axis at or below x. */
static int planes_below(const struct vg_lattice *l, int axis, double x)
{
  int k = 0;

  while (k < l->n[axis] && l->at[axis][k] <= x) k++;
  return k;
}

int vg_crosses_needles(const struct vg_front *front, const struct vg_lattice *l)
{
  size_t count[3][VG_LATTICE_PLANES] = { { 0 } };

  assert(front && l);
  if (!l->n[0] && !l->n[1] && !l->n[2]) return 0;
  for (size_t i = 0; i < front->n_face; i++) {
    const double *x[3];
    int first[3], last[3], crosses = 0;

    for (int k = 0; k < 3; k++) x[k] = front->x[front->face[i][k]];
    for (int a = 0; a < 3; a++) {
      first[a] = planes_below(l, a, fmin(fmin(x[0][a], x[1][a]), x[2][a]));
      last[a] = planes_below(l, a, fmax(fmax(x[0][a], x[1][a]), x[2][a]));
      crosses |= first[a] < last[a];
    }
    if (!crosses || !is_needle(x)) continue;
    for (int a = 0; a < 3; a++)
      for (int p = first[a]; p < last[a]; p++)
        if ((double)++count[a][p] > MANY * (double)front->n_face) return 1;
  }
  return 0;
}
