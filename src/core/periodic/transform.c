/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Transforms of periodic patches. Declared in core/periodic/periodic.h. */
#include <math.h>
#include <string.h>

#include "core/geometry/vector.h"
#include "core/periodic/periodic.h"
#include "core/search/box.h"

#define PI 3.14159265358979323846
/* S99: mean normals that are opposite, relative to the area; parallel lines. */
#define OPPOSITE 1e-5
#define TERMS 12 /* of the series up to a quarter turn: error below 1e-20 */

/* Sine and cosine in plain arithmetic, of at most half a turn. */
static void sine_cosine(double x, double *s, double *c)
{
  const int is_far = fabs(x) > PI / 2;
  const double y = !is_far ? x : x > 0 ? PI - x : -PI - x;
  double sine = 0, cosine = 0;

  for (int k = TERMS; k >= 0; k--) {
    sine = 1 - y * y / (double)((2 * k + 2) * (2 * k + 3)) * sine;
    cosine = 1 - y * y / (double)((2 * k + 1) * (2 * k + 2)) * cosine;
  }
  *s = y * sine;
  *c = is_far ? -cosine : cosine;
}

/* Sets a rotation by 1 / n turns, backwards with sign -1. Quarters and halves
 * are exact. */
static void set_fraction(struct vg_periodic *p, int n, int sign)
{
  p->n = n;
  sine_cosine(2 * PI / n, &p->sine, &p->cosine);
  if (n == 2) p->sine = 0;
  if (n == 2 || n == 4) p->cosine = n == 2 ? -1 : 0;
  if (n == 4) p->sine = 1;
  p->sine *= sign;
}

/* Replaces the angle by that of a fraction of a turn that is near. */
static void snap(struct vg_periodic *p)
{
  const double limit = VG_PERIODIC_DEGREES * PI / 180;
  struct vg_periodic q = *p;

  for (int n = 2; n <= VG_PERIODIC_MOST; n++) {
    set_fraction(&q, n, p->sine < 0 ? -1 : 1);
    if (fabs(q.sine - p->sine) > limit || fabs(q.cosine - p->cosine) > limit)
      continue;
    *p = q;
    return;
  }
}

void vg_periodic_turn(struct vg_periodic *p, double degrees)
{
  p->n = 0;
  sine_cosine(degrees * (PI / 180), &p->sine, &p->cosine);
  snap(p);
}

double vg_periodic_degrees(const struct vg_periodic *p)
{
  return p->n ? (p->sine < 0 ? -360. : 360.) / p->n
              : atan2(p->sine, p->cosine) * (180 / PI);
}

void vg_periodic_image(const struct vg_periodic *p, const double x[3],
                       double out[3])
{
  double d[3], across[3], along;

  if (!p->is_rotation) {
    for (int k = 0; k < 3; k++) out[k] = x[k] + p->shift[k];
    return;
  }
  vg_sub(x, p->centre, d);
  along = vg_dot(d, p->axis);
  vg_cross(p->axis, d, across);
  for (int k = 0; k < 3; k++) {
    const double on_axis = p->axis[k] * along;

    out[k] = p->centre[k] +
             (on_axis + (d[k] - on_axis) * p->cosine + across[k] * p->sine);
  }
}

void vg_periodic_vector(const struct vg_periodic *p, int is_back,
                        const double v[3], double out[3])
{
  struct vg_periodic q = *p;

  if (!p->is_rotation) {
    memcpy(out, v, 3 * sizeof *v);
    return;
  }
  memset(q.centre, 0, sizeof q.centre);
  if (is_back) q.sine = -q.sine;
  vg_periodic_image(&q, v, out);
}

struct vg_periodic vg_periodic_reverse(const struct vg_periodic *p)
{
  struct vg_periodic q = *p;

  q.patch = p->image;
  q.image = p->patch;
  q.sine = -p->sine;
  for (int k = 0; k < 3; k++) q.shift[k] = -p->shift[k];
  return q;
}

void vg_periodic_angles(const struct vg_periodic *p, double angle[3])
{
  double a[3][3], e[3], sine; /* a[j]: image of the unit vector j */

  for (int j = 0; j < 3; j++) {
    for (int k = 0; k < 3; k++) e[k] = k == j;
    vg_periodic_vector(p, 0, e, a[j]);
  }
  sine = fmax(-1, fmin(1, -a[0][2]));
  angle[1] = asin(sine);
  if (fabs(sine) < 1 - 1e-14) {
    angle[0] = atan2(a[1][2], a[2][2]);
    angle[2] = atan2(a[0][1], a[0][0]);
  } else { /* x and z turn about the same line. */
    angle[0] = atan2(-a[2][1], a[1][1]);
    angle[2] = 0;
  }
}

/* Vector area, centroid and area of a patch. */
struct moments {
  double normal[3], middle[3], area;
};

static void add_triangle(struct moments *q, const double a[3],
                         const double b[3], const double c[3])
{
  double u[3], v[3], n[3], area;

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(u, v, n);
  area = vg_norm(n) / 2;
  q->area += area;
  for (int k = 0; k < 3; k++) {
    q->normal[k] += n[k] / 2;
    q->middle[k] += area * (a[k] + b[k] + c[k]) / 3;
  }
}

static struct moments moments_of(const struct vg_mesh *m, int32_t id)
{
  struct moments q = { .area = 0 };

  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t *t = m->tri[i];

    if (m->patch[m->tri_patch[i]].id == id)
      add_triangle(&q, m->point[t[0]], m->point[t[1]], m->point[t[2]]);
  }
  for (int k = 0; k < 3 && q.area > 0; k++) q.middle[k] /= q.area;
  return q;
}

double vg_periodic_extent(const struct vg_mesh *m, const struct vg_periodic *p)
{
  struct vg_box box = VG_BOX_EMPTY;

  for (size_t i = 0; i < m->n_tri; i++) {
    const int32_t id = m->patch[m->tri_patch[i]].id;

    for (int k = 0; k < 3 && (id == p->patch || id == p->image); k++)
      vg_box_add(&box, m->point[m->tri[i][k]]);
  }
  return box.lo[0] > box.hi[0] ? 0 : vg_distance(box.lo, box.hi);
}

/* Removes components that are 0 except for rounding. */
static void round_off(double v[3], double scale)
{
  for (int k = 0; k < 3; k++)
    if (fabs(v[k]) < VG_PERIODIC_ZERO * scale) v[k] = 0;
}

/* The rotation leaves components along the axis unchanged, and takes the mean
 * normal of the first patch to the reverse of the other. Both the sum of the
 * normals and the way between the centroids are therefore normal to the
 * axis. */
static int find_rotation(const struct moments q[2], double extent,
                         struct vg_periodic *p)
{
  double sum[3], way[3], from[3], to[3], turned[3], middle[3], along, l;

  for (int k = 0; k < 3; k++) {
    sum[k] = q[0].normal[k] + q[1].normal[k];
    from[k] = q[0].normal[k];
    to[k] = -q[1].normal[k];
    middle[k] = (q[0].middle[k] + q[1].middle[k]) / 2;
  }
  vg_sub(q[1].middle, q[0].middle, way);
  vg_cross(sum, way, p->axis);
  if (!(vg_unit(p->axis) > OPPOSITE * vg_norm(sum) * vg_norm(way))) return 0;
  round_off(p->axis, 1);
  vg_unit(p->axis);
  along = vg_dot(from, p->axis);
  for (int k = 0; k < 3; k++) from[k] -= along * p->axis[k];
  along = vg_dot(to, p->axis);
  for (int k = 0; k < 3; k++) to[k] -= along * p->axis[k];
  vg_unit(from);
  vg_unit(to);
  vg_cross(from, to, turned);
  p->sine = vg_dot(turned, p->axis);
  p->cosine = vg_dot(from, to);
  l = sqrt(p->sine * p->sine + p->cosine * p->cosine);
  if (!(l > 0.5) || !(p->cosine < 1 - OPPOSITE * OPPOSITE)) return 0;
  p->sine /= l;
  p->cosine /= l;
  p->n = 0;
  snap(p);
  /* The centre is above the middle of the way: sin / (1 - cos) is the cotangent
   * of half the angle. */
  vg_cross(p->axis, way, turned);
  for (int k = 0; k < 3; k++)
    p->centre[k] = middle[k] + turned[k] * p->sine / (2 * (1 - p->cosine));
  along = vg_dot(p->centre, p->axis);
  for (int k = 0; k < 3; k++) p->centre[k] -= along * p->axis[k];
  round_off(p->centre, extent);
  p->is_rotation = 1;
  return 1;
}

int vg_periodic_find(const struct vg_mesh *m, struct vg_periodic *p)
{
  const struct moments q[2] = { moments_of(m, p->patch),
                                moments_of(m, p->image) };
  double sum[3];

  if (!(q[0].area > 0 && q[1].area > 0)) return 0;
  for (int k = 0; k < 3; k++) sum[k] = q[0].normal[k] + q[1].normal[k];
  if (vg_norm(sum) > OPPOSITE * (q[0].area + q[1].area))
    return find_rotation(q, vg_periodic_extent(m, p), p);
  vg_sub(q[1].middle, q[0].middle, p->shift);
  round_off(p->shift, vg_norm(p->shift));
  p->is_rotation = 0;
  return vg_norm(p->shift) > 0;
}
