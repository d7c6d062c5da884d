/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/domain/symmetry.h"

#include <assert.h>
#include <math.h>

#include "core/geometry/vector.h"

/* S9 */
#define STEEP 0.7      /* of normal and axis: cosine of 45 degrees */
#define MOSTLY 0.7     /* of the length of the open edges */
#define SPAN 0.5       /* of the extent of the body */
#define DEEP 1.5       /* times the width of the opening */
#define NEAR_ZERO 1e-3 /* of the length of the body */

/* Length of the sides of a triangle in the plane, and whether the triangle
 * meets the plane steeply. */
static double in_plane(const struct vg_mesh *m, const uint32_t *t, int axis,
                       double at, double tolerance, int *is_steep)
{
  double a[3], b[3], n[3], sum = 0;

  for (int k = 0; k < 3; k++) {
    const double *p = m->point[t[k]], *q = m->point[t[(k + 1) % 3]];

    if (fabs(p[axis] - at) <= tolerance && fabs(q[axis] - at) <= tolerance)
      sum += vg_distance(p, q);
  }
  vg_sub(m->point[t[1]], m->point[t[0]], a);
  vg_sub(m->point[t[2]], m->point[t[0]], b);
  vg_cross(a, b, n);
  *is_steep = fabs(n[axis]) < STEEP * vg_norm(n);
  return sum;
}

int vg_domain_is_steep(const struct vg_mesh *m, int axis, double at,
                       double tolerance)
{
  double sum = 0, steep = 0;

  for (size_t i = 0; i < m->n_tri + m->n_quad; i++) {
    int is_steep;
    double l = in_plane(m, i < m->n_tri ? m->tri[i] : m->quad[i - m->n_tri],
                        axis, at, tolerance, &is_steep);

    sum += l;
    if (is_steep) steep += l;
  }
  return sum > 0 && steep >= MOSTLY * sum;
}

int vg_is_symmetry(const struct vg_mesh *m, const struct vg_border *open,
                   int axis, double at)
{
  double lo[3], hi[3], from[3], to[3], length = 0, width = 0;
  int along = axis;

  assert(open->n > 0 && axis >= 0 && axis < 3);
  vg_mesh_bounds(m, lo, hi);
  for (int k = 0; k < 3; k++) {
    length = fmax(length, hi[k] - lo[k]);
    from[k] = INFINITY;
    to[k] = -INFINITY;
    for (size_t i = 0; i < 2 * open->n; i++) {
      double x = m->point[open->edge[i / 2][i % 2]][k];

      from[k] = fmin(from[k], x);
      to[k] = fmax(to[k], x);
    }
    if (k != axis && to[k] - from[k] > width) {
      width = to[k] - from[k];
      along = k;
    }
  }
  return width >= SPAN * (hi[along] - lo[along]) &&
         (hi[axis] - lo[axis] <= DEEP * width ||
          (axis && fabs(at) <= NEAR_ZERO * length)) &&
         vg_domain_is_steep(m, axis, at, VG_PLANE_TOLERANCE * length);
}
