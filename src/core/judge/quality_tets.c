/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* For a tetrahedron a b c d with u = b - a, v = c - a, w = d - a:
 *   V = u x v . w / 6,
 *   circumradius = | |u|^2 v x w + |v|^2 w x u + |w|^2 u x v | / (12 V),
 *   inradius = 3 V / (sum of face areas). */
#include "core/judge/quality_tets.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "core/judge/lanes.h"
#include "core/geometry/predicates.h"

#define DEGREE 57.295779513082320877

/* Arc cosine in degrees; 0 for NaN. With the rational approximation of fdlibm
 * (Sun Microsystems, 1993) for the arc sine up to 0.5, without branches, and
 * with the same bits on all processors. */
VG_WITHIN double degrees(double c)
{
  static const double pi = 3.14159265358979323846;
  double a = fabs(c) < 1 ? fabs(c) : 1;
  double half = (1 - a) / 2, root = sqrt(half), y;
  double z = a > 0.5 ? half : a * a, x = a > 0.5 ? root : a;
  double p = 7.91534994289814532176e-04 + z * 3.47933107596021167570e-05;
  double q = -6.88283971605453293030e-01 + z * 7.70381505559019352791e-02;

  p = -4.00555345006794114027e-02 + z * p;
  p = 2.01212532134862925881e-01 + z * p;
  p = -3.25565818622400915405e-01 + z * p;
  p = 1.66666666666666657415e-01 + z * p;
  q = 2.02094576023350569471e+00 + z * q;
  q = -2.40339491173441421878e+00 + z * q;
  q = 1 + z * q;
  y = x + x * (z * p / q);
  y = a > 0.5 ? 2 * y : pi / 2 - y;
  y = (c < 0 ? pi - y : y) * DEGREE;
  return c == c ? y : 0;
}

/* A step of Newton's iteration for x^(-1/3). */
VG_WITHIN double improved(double r, double x)
{
  return r * (4 - x * r * r * r) * (1 / 3.);
}

/* Cube root within 1e-15, 0 for 0: Newton's iteration for x^(-1/3) from a third
 * of the exponent. */
VG_WITHIN double cube_root(double x)
{
  uint64_t bits, third;
  double r;

  memcpy(&bits, &x, sizeof bits);
  third = (bits >> 2) + (bits >> 4); /* 5/16, then 5/16 * 16/15 = 1/3 */
  third += third >> 4;
  third += third >> 8;
  third += third >> 16;
  bits = UINT64_C(0x553ef00000000000) - third;
  memcpy(&r, &bits, sizeof r);
  r = improved(r, x);
  r = improved(r, x);
  r = improved(r, x);
  r = improved(r, x);
  return x * r * r;
}

VG_WITHIN void scale(double n[3], double by)
{
  for (int k = 0; k < 3; k++) n[k] *= by;
}

struct range {
  double low, high;
};

/* Extend the range by the cosine of the angle between two faces with the
 * outward unit normals a and b. */
VG_WITHIN void extend(struct range *r, const double a[3], const double b[3])
{
  double c = -vg_lane_dot(a, b);

  r->high = c > r->high ? c : r->high;
  r->low = c < r->low ? c : r->low;
}

/* Cosines of the angles between the faces with these outward normals. Not a
 * loop, which would keep compilers from vectorising the one around it. */
VG_WITHIN struct range cosines(double n[4][3], const double length[4])
{
  struct range r = { 2, -2 };

  for (int i = 0; i < 4; i++) scale(n[i], 1 / length[i]);
  extend(&r, n[1], n[0]);
  extend(&r, n[2], n[0]);
  extend(&r, n[2], n[1]);
  extend(&r, n[3], n[0]);
  extend(&r, n[3], n[1]);
  extend(&r, n[3], n[2]);
  return r;
}

/* For outward area vectors S_i of the faces and the centre c, the direction to
 * the centre of face i is (c - x_i) / 3, with S_i (c - x_i) = 9 V / 4. The
 * determinant of sum S_i S_i^T is 4 det(S_1 S_2 S_3)^2, since sum S_i = 0, and
 * det(S_1 S_2 S_3) = (6 V)^2 / 8. length: 2 |S_i|. */
VG_WITHIN void measure_for_solvers(struct vg_tet_batch *b, size_t t,
                                   const double length[4], double six2)
{
  double c[3], most = 0, mean, d;

  for (int k = 0; k < 3; k++)
    c[k] = (b->x[0][k][t] + b->x[1][k][t] + b->x[2][k][t] + b->x[3][k][t]) *
           0.25;
  for (int i = 0; i < 4; i++) {
    double x = c[0] - b->x[i][0][t], y = c[1] - b->x[i][1][t];
    double z = c[2] - b->x[i][2][t];
    double product = length[i] * length[i] * (x * x + y * y + z * z);

    most = product > most ? product : most;
  }
  b->slant2[t] = 0.5625 * six2 / most;
  mean = (length[0] + length[1] + length[2] + length[3]) * 0.125;
  d = six2 / (mean * mean * mean);
  b->determinant[t] = d * d * (1 / 128.);
}

/* Tetrahedron t of the batch. A face without area counts as the worst of both
 * kinds of angles, so that it cannot go unnoticed. */
VG_WITHIN void measure(struct vg_tet_batch *b, size_t t)
{
  double u[3], v[3], w[3], n[4][3], q[3], length[4];
  double uu, vv, ww, six, six2, area2, edge2 = 0, ratio, mean;
  struct range cosine;
  int flat;

  for (int k = 0; k < 3; k++) {
    u[k] = b->x[1][k][t] - b->x[0][k][t];
    v[k] = b->x[2][k][t] - b->x[0][k][t];
    w[k] = b->x[3][k][t] - b->x[0][k][t];
  }
  vg_lane_cross(v, w, n[1]);
  vg_lane_cross(w, u, n[2]);
  vg_lane_cross(u, v, n[3]);
  uu = vg_lane_dot(u, u);
  vv = vg_lane_dot(v, v);
  ww = vg_lane_dot(w, w);
  for (int k = 0; k < 3; k++) {
    double e = v[k] - u[k], f = w[k] - u[k], g = w[k] - v[k];

    n[0][k] = -n[1][k] - n[2][k] - n[3][k];
    q[k] = uu * n[1][k] + vv * n[2][k] + ww * n[3][k];
    edge2 += e * e + f * f + g * g;
  }
  edge2 += uu + vv + ww;
  for (int i = 0; i < 4; i++) length[i] = sqrt(vg_lane_dot(n[i], n[i]));
  six = vg_lane_dot(n[3], w);
  six2 = six * six;
  area2 = length[0] + length[1] + length[2] + length[3];
  flat = !((length[0] > 0) & (length[1] > 0) & (length[2] > 0) &
           (length[3] > 0));
  cosine = cosines(n, length);
  b->least[t] = degrees(flat ? 1 : cosine.high);
  b->most[t] = degrees(flat ? -1 : cosine.low);
  /* 3 (3 V / A) (12 V / |q|) with A = area2 / 2, |q| = |6 V| times twice the
   * circumradius */
  ratio = flat ? 0 : area2 * sqrt(vg_lane_dot(q, q));
  b->radius_ratio[t] = ratio > 0 ? 6 * fabs(six) * fabs(six) / ratio : ratio;
  /* (3 V)^2 = (6 V)^2 / 4 */
  mean = 12 * cube_root(six2 / 4) / edge2;
  b->mean_ratio[t] = edge2 > 0 ? mean : 0;
  b->edge[t] = sqrt(edge2 / 6);
  b->volume[t] = six;
  /* The sign of 6 V, as vg_orient3d computes it, is sure if its square is more.
   * The bound of vg_orient3d is at most 8.9e-16 times six products of three
   * lengths. */
  b->doubt2[t] = 3e-29 * uu * vv * ww;
  measure_for_solvers(b, t, length, six2);
}

VG_WITHIN void measure_all(struct vg_tet_batch *b)
{
  for (size_t t = 0; t < b->n; t++) measure(b, t);
}

#ifdef VG_WIDE
static VG_WIDE void measure_wide(struct vg_tet_batch *b)
{
  measure_all(b);
}
#endif

void vg_tets_measure(const struct vg_mesh *m, size_t first, size_t n,
                     struct vg_tet_batch *b)
{
  assert(n <= VG_TET_BATCH && first + n <= m->n_tet);
  b->n = n;
  for (size_t t = 0; t < n; t++)
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++)
        b->x[i][k][t] = m->point[m->tet[first + t][i]][k];
#ifdef VG_WIDE
  if (VG_IS_WIDE) measure_wide(b);
  else measure_all(b);
#else
  measure_all(b);
#endif
  for (size_t t = 0; t < n; t++) {
    const uint32_t *v = m->tet[first + t];
    double six = b->volume[t];

    if (!(six * six > b->doubt2[t]))
      six = vg_orient3d(m->point[v[0]], m->point[v[1]], m->point[v[2]],
                        m->point[v[3]]);
    b->volume[t] = six / 6;
  }
}

/* --- counting ------------------------------------------------------------- */

VG_WITHIN int32_t bin_of(double x, double per_unit, int32_t n)
{
  double at = x * per_unit;

  at = at > 0 ? at : 0;
  return (int32_t)(at < n - 1 ? at : n - 1);
}

VG_WITHIN void find_bins(const struct vg_tet_batch *b, struct vg_tet_bins *out)
{
  size_t n = b->n;

  for (size_t t = 0; t < n; t++)
    out->angle_min[t] = bin_of(b->least[t], 1 / 5., VG_HIST_ANGLE);
  for (size_t t = 0; t < n; t++)
    out->angle_max[t] = bin_of(b->most[t], 1 / 5., VG_HIST_ANGLE);
  for (size_t t = 0; t < n; t++)
    out->fine[t] = bin_of(b->least[t], VG_FINE_PER_DEGREE, VG_N_FINE);
  for (size_t t = 0; t < n; t++)
    out->radius_ratio[t] = bin_of(b->radius_ratio[t], VG_HIST_UNIT,
                                  VG_HIST_UNIT);
}

/* Cells below and above the limits, if the extremes say that there are any. */
VG_WITHIN void count_limits(const struct vg_tet_batch *b,
                            struct vg_tet_bins *out)
{
  static const double low[5] = { 5, 10, 15, 20, 30 };
  static const double high[3] = { 150, 160, 170 };

  for (int k = 0; k < 5; k++) {
    size_t n = out->angle_least < low[k] ? b->n : 0;
    uint64_t sum = 0;

    for (size_t t = 0; t < n; t++) sum += b->least[t] < low[k];
    out->below[k] = sum;
  }
  for (int k = 0; k < 3; k++) {
    size_t n = out->angle_most > high[k] ? b->n : 0;
    uint64_t sum = 0;

    for (size_t t = 0; t < n; t++) sum += b->most[t] > high[k];
    out->above[k] = sum;
  }
}

/* Lane by lane, because compilers must not reorder the comparisons. */
VG_WITHIN void find_extremes(const struct vg_tet_batch *b,
                             struct vg_tet_bins *out)
{
  double least[VG_TET_LANES], most[VG_TET_LANES], ratio[VG_TET_LANES];
  size_t whole = b->n - b->n % VG_TET_LANES;

  for (int l = 0; l < VG_TET_LANES; l++) {
    least[l] = 180;
    most[l] = 0;
    ratio[l] = 1;
  }
  for (size_t t = 0; t < whole; t += VG_TET_LANES)
    for (size_t l = 0; l < VG_TET_LANES; l++) {
      double a = b->least[t + l], z = b->most[t + l];
      double r = b->radius_ratio[t + l];

      least[l] = a < least[l] ? a : least[l];
      most[l] = z > most[l] ? z : most[l];
      ratio[l] = r < ratio[l] ? r : ratio[l];
    }
  for (size_t t = whole; t < b->n; t++) {
    least[0] = b->least[t] < least[0] ? b->least[t] : least[0];
    most[0] = b->most[t] > most[0] ? b->most[t] : most[0];
    ratio[0] = b->radius_ratio[t] < ratio[0] ? b->radius_ratio[t] : ratio[0];
  }
  for (int l = 1; l < VG_TET_LANES; l++) {
    least[0] = least[l] < least[0] ? least[l] : least[0];
    most[0] = most[l] > most[0] ? most[l] : most[0];
    ratio[0] = ratio[l] < ratio[0] ? ratio[l] : ratio[0];
  }
  out->angle_least = least[0];
  out->angle_most = most[0];
  out->radius_ratio_least = ratio[0];
}

#ifdef VG_WIDE
static VG_WIDE void count_wide(const struct vg_tet_batch *b,
                               struct vg_tet_bins *out)
{
  find_bins(b, out);
  find_extremes(b, out);
  count_limits(b, out);
}
#endif

void vg_tets_count(const struct vg_tet_batch *b, struct vg_tet_bins *out)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) {
    count_wide(b, out);
    return;
  }
#endif
  find_bins(b, out);
  find_extremes(b, out);
  count_limits(b, out);
}
