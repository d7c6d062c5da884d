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

/* Centre of a rotation, by its axis and angle, that takes the point `from` to
 * the point `to`, except for their distance along the axis. It is above the
 * middle of the way: sin / (1 - cos) is the cotangent of half the angle. */
static void set_centre(struct vg_periodic *p, const double from[3],
                       const double to[3], double extent)
{
  double way[3], turned[3], along;

  vg_sub(to, from, way);
  vg_cross(p->axis, way, turned);
  for (int k = 0; k < 3; k++)
    p->centre[k] = (from[k] + to[k]) / 2 +
                   turned[k] * p->sine / (2 * (1 - p->cosine));
  along = vg_dot(p->centre, p->axis);
  for (int k = 0; k < 3; k++) p->centre[k] -= along * p->axis[k];
  round_off(p->centre, extent);
}

/* The rotation leaves components along the axis unchanged, and takes the mean
 * normal of the first patch to the reverse of the other. Both the sum of the
 * normals and the way between the centroids are therefore normal to the
 * axis. */
static int find_rotation(const struct moments q[2], double extent,
                         struct vg_periodic *p)
{
  double sum[3], way[3], from[3], to[3], turned[3], along, l;

  for (int k = 0; k < 3; k++) {
    sum[k] = q[0].normal[k] + q[1].normal[k];
    from[k] = q[0].normal[k];
    to[k] = -q[1].normal[k];
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
  set_centre(p, q[0].middle, q[1].middle, extent);
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

/* --- rotations from points ------------------------------------------------ */

#define SWEEPS 60      /* of Jacobi's method; a few are enough */
#define ON_A_LINE 1e-3 /* S120: width of the points over their length */

/* One rotation of Jacobi's method, which makes a[i][j] zero. */
static void rotate(double a[4][4], double v[4][4], int i, int j)
{
  double theta, t, c, s;

  if (a[i][j] == 0) return;
  theta = (a[j][j] - a[i][i]) / (2 * a[i][j]);
  t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
  c = 1 / sqrt(t * t + 1);
  s = t * c;
  for (int k = 0; k < 4; k++) {
    const double x = a[k][i], y = a[k][j];

    a[k][i] = c * x - s * y;
    a[k][j] = s * x + c * y;
  }
  for (int k = 0; k < 4; k++) {
    const double x = a[i][k], y = a[j][k], w = v[k][i], z = v[k][j];

    a[i][k] = c * x - s * y;
    a[j][k] = s * x + c * y;
    v[k][i] = c * w - s * z;
    v[k][j] = s * w + c * z;
  }
}

/* Unit eigenvector of the greatest eigenvalue of a symmetric matrix. */
static void greatest(double a[4][4], double q[4])
{
  double v[4][4] = { { 1 }, { 0, 1 }, { 0, 0, 1 }, { 0, 0, 0, 1 } };
  int at = 0;

  for (int n = 0; n < SWEEPS; n++)
    for (int i = 0; i < 3; i++)
      for (int j = i + 1; j < 4; j++) rotate(a, v, i, j);
  for (int i = 1; i < 4; i++)
    if (a[i][i] > a[at][at]) at = i;
  for (int k = 0; k < 4; k++) q[k] = v[k][at];
}

/* Horn's matrix from the sums h[i][j] of the products of coordinates i of the
 * points and j of their partners. */
static void horn(double h[3][3], double a[4][4])
{
  a[0][0] = h[0][0] + h[1][1] + h[2][2];
  for (int i = 0; i < 3; i++) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;

    a[0][i + 1] = a[i + 1][0] = h[j][k] - h[k][j];
    a[i + 1][i + 1] = h[i][i] - h[j][j] - h[k][k];
    a[i + 1][j + 1] = a[j + 1][i + 1] = h[i][j] + h[j][i];
  }
}

/* Centroids of the points and of their partners; returns their number. */
static size_t centroids(const struct vg_mesh *m,
                        const struct vg_periodic_match *match,
                        double middle[2][3])
{
  size_t n = 0;

  memset(middle, 0, 6 * sizeof **middle);
  for (size_t i = 0; i < m->n_point; i++) {
    if (match->point[i] == VG_PERIODIC_NONE) continue;
    for (int k = 0; k < 3; k++) {
      middle[0][k] += m->point[i][k];
      middle[1][k] += m->point[match->point[i]][k];
    }
    n++;
  }
  for (int k = 0; k < 3 && n; k++) {
    middle[0][k] /= (double)n;
    middle[1][k] /= (double)n;
  }
  return n;
}

/* Whether the points are on a line through their centroid. */
static int is_line(const struct vg_mesh *m,
                   const struct vg_periodic_match *match, const double x[3])
{
  double far[3] = { 0 }, d[3], c[3], length = 0, width = 0;

  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < m->n_point; i++) {
      if (match->point[i] == VG_PERIODIC_NONE) continue;
      vg_sub(m->point[i], x, d);
      if (!pass && vg_norm(d) > length) {
        length = vg_norm(d);
        memcpy(far, d, sizeof far);
      }
      vg_cross(far, d, c);
      if (pass) width = fmax(width, vg_norm(c));
    }
  return !(width > ON_A_LINE * length * length);
}

void vg_periodic_refine_turn(const struct vg_mesh *m, struct vg_periodic *p,
                             const struct vg_periodic_match *match)
{
  double middle[2][3], h[3][3] = { { 0 } }, a[4][4], q[4], l;
  struct vg_periodic r = *p;

  if (!p->is_rotation || centroids(m, match, middle) < 3 ||
      is_line(m, match, middle[0]))
    return;
  for (size_t i = 0; i < m->n_point; i++) {
    const uint32_t to = match->point[i];

    for (int k = 0; k < 9 && to != VG_PERIODIC_NONE; k++)
      h[k / 3][k % 3] += (m->point[i][k / 3] - middle[0][k / 3]) *
                         (m->point[to][k % 3] - middle[1][k % 3]);
  }
  horn(h, a);
  greatest(a, q);
  memcpy(r.axis, q + 1, sizeof r.axis);
  l = vg_unit(r.axis);
  if (!(l > OPPOSITE)) return;
  r.sine = 2 * q[0] * l;
  r.cosine = q[0] * q[0] - l * l;
  if (vg_dot(r.axis, p->axis) < 0) {
    for (int k = 0; k < 3; k++) r.axis[k] = -r.axis[k];
    r.sine = -r.sine;
  }
  round_off(r.axis, 1);
  vg_unit(r.axis);
  r.n = 0;
  snap(&r);
  set_centre(&r, middle[0], middle[1], vg_periodic_extent(m, p));
  *p = r;
}
