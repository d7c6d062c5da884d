#include "partition/cut/needles.h"

#include <math.h>

#include "core/geometry/vector.h"

/* C14 */
#define ASPECT 100.0       /* longest side over the height upon it */
#define MANY 0.1           /* of all faces, that cross one plane */

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

/* Planes of the axis that are not above x. */
static int planes_below(const struct vg_lattice *l, int axis, double x)
{
  int k = 0;

  while (k < l->n[axis] && l->at[axis][k] <= x) k++;
  return k;
}

static int has_needles(const struct vg_front *f, const struct vg_lattice *l,
                       int axis)
{
  size_t count[VG_LATTICE_PLANES] = { 0 };

  for (size_t i = 0; l->n[axis] && i < f->n_face; i++) {
    const double *x[3];
    double lo = INFINITY, hi = -INFINITY;
    int first, last;

    for (int k = 0; k < 3; k++) {
      x[k] = f->x[f->face[i][k]];
      lo = fmin(lo, x[k][axis]);
      hi = fmax(hi, x[k][axis]);
    }
    first = planes_below(l, axis, lo);
    last = planes_below(l, axis, hi);
    if (first == last || !is_needle(x)) continue;
    for (int p = first; p < last; p++)
      if ((double)++count[p] > MANY * (double)f->n_face) return 1;
  }
  return 0;
}

int vg_crosses_needles(const struct vg_front *front,
                       const struct vg_lattice *l)
{
  return has_needles(front, l, 0) || has_needles(front, l, 1) ||
         has_needles(front, l, 2);
}
