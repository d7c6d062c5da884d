/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Figures of one face. With the area vector A, the vectors f from the centre of
 * the first cell to that of the face, g from there to the centre of the second
 * cell, c = f + g and s = A.f / A.c, c passes through the face at s c, and
 * e = f - s c is the distance to the centre. With the corners x_i relative to
 * that centre, the skewness is
 *   |e| / max(0.2 |c|, |e/|e| . x_i|) = e.e / max(0.2 |c| |e|, |e . x_i|),
 * and the weight is the smaller one of A.f and A.g over their sum. */
#include "core/judge/quality_solver_parts.h"

#include <assert.h>
#include <math.h>

#include "core/judge/lanes.h"

/* Cosines of 5, 10, ... 175 degrees. */
static const double limit[VG_HIST_ANGLE - 1] = {
  0.99619469809174553,  0.98480775301220806,  0.96592582628906829,
  0.93969262078590838,  0.90630778703664996,  0.86602540378443865,
  0.81915204428899178,  0.76604444311897804,  0.70710678118654752,
  0.64278760968653933,  0.57357643635104610,  0.5,
  0.42261826174069943,  0.34202014332566873,  0.25881904510252076,
  0.17364817766693035,  0.08715574274765817,  0,
  -0.08715574274765817, -0.17364817766693035, -0.25881904510252076,
  -0.34202014332566873, -0.42261826174069943, -0.5,
  -0.57357643635104610, -0.64278760968653933, -0.70710678118654752,
  -0.76604444311897804, -0.81915204428899178, -0.86602540378443865,
  -0.90630778703664996, -0.93969262078590838, -0.96592582628906829,
  -0.98480775301220806, -0.99619469809174553
};
#define N_LIMIT (VG_HIST_ANGLE - 1)
#define N_ACUTE 18 /* limits up to 90 degrees */

VG_WITHIN double larger(double a, double b)
{
  return a > b ? a : b;
}

VG_WITHIN double reach(const double e[3], const double x[3],
                       const double centre[3])
{
  return fabs(e[0] * (x[0] - centre[0]) + e[1] * (x[1] - centre[1]) +
              e[2] * (x[2] - centre[2]));
}

/* Skewness from e and c; far: the largest |e . x_i|; share: 0.2 or 0.4. */
VG_WITHIN double skewness_of(const double e[3], double c2, double far,
                             double share)
{
  double e2 = vg_lane_dot(e, e), most = larger(share * sqrt(c2 * e2), far);
  double ratio = e2 / most;

  return most > 0 ? ratio : 0;
}

VG_WITHIN void triangle(const double a[3], const double b[3], const double c[3],
                        struct vg_face_shape *out)
{
  double u[3], v[3];

  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    out->centre[k] = (a[k] + b[k] + c[k]) * (1 / 3.);
  }
  vg_lane_cross(u, v, out->area);
  for (int k = 0; k < 3; k++) out->area[k] *= 0.5;
}

/* f and g: see above. */
VG_WITHIN void measure(const double f[3], const double g[3], const double a[3],
                       const double b[3], const double c[3], const double d[3],
                       const struct vg_face_shape *shape,
                       struct vg_face_figures *out)
{
  double n[3], e[3], af = vg_lane_dot(shape->area, f),
                     ag = vg_lane_dot(shape->area, g);
  double s, far, cosine;

  for (int k = 0; k < 3; k++) n[k] = f[k] + g[k];
  cosine = (af + ag) /
           sqrt(vg_lane_dot(shape->area, shape->area) * vg_lane_dot(n, n));
  cosine = cosine > -1 ? cosine : -1; /* -1 for NaN */
  out->cosine = cosine < 1 ? cosine : 1;
  s = af / (af + ag);
  s = af + ag != 0 ? s : 0;
  for (int k = 0; k < 3; k++) e[k] = f[k] - s * n[k];
  far = larger(reach(e, a, shape->centre), reach(e, b, shape->centre));
  far = larger(far,
               larger(reach(e, c, shape->centre), reach(e, d, shape->centre)));
  out->skewness = skewness_of(e, vg_lane_dot(n, n), far, 0.2);
  af = fabs(af);
  ag = fabs(ag);
  out->weight = (af < ag ? af : ag) / (af + ag);
}

/* With the corners r_i relative to their mean m, twice the areas of the
 * triangles around m are r_i x r_i+1, and their centres m + (r_i + r_i+1) / 3.
 * The four triangles are the lanes of the loops. */
static void quadrilateral(const double x[4][3], struct vg_face_shape *out)
{
  double r[3][5], n[3][4], area[4], total, scale;

  for (int k = 0; k < 3; k++) {
    double mean = ((x[0][k] + x[1][k]) + (x[2][k] + x[3][k])) * 0.25;

    for (int i = 0; i < 4; i++) r[k][i] = x[i][k] - mean;
    r[k][4] = r[k][0];
    out->centre[k] = mean;
  }
  for (int i = 0; i < 4; i++) {
    n[0][i] = r[1][i] * r[2][i + 1] - r[2][i] * r[1][i + 1];
    n[1][i] = r[2][i] * r[0][i + 1] - r[0][i] * r[2][i + 1];
    n[2][i] = r[0][i] * r[1][i + 1] - r[1][i] * r[0][i + 1];
  }
  for (int i = 0; i < 4; i++)
    area[i] = sqrt(n[0][i] * n[0][i] + n[1][i] * n[1][i] + n[2][i] * n[2][i]);
  total = (area[0] + area[1]) + (area[2] + area[3]);
  scale = total > 0 ? 1 / (3 * total) : 0;
  for (int k = 0; k < 3; k++) {
    double sum = 0;

    for (int i = 0; i < 4; i++) sum += area[i] * (r[k][i] + r[k][i + 1]);
    out->centre[k] += sum * scale;
    out->area[k] = ((n[k][0] + n[k][1]) + (n[k][2] + n[k][3])) * 0.5;
  }
}

void vg_face_shape(const double x[4][3], int n, struct vg_face_shape *out)
{
  assert(n == 3 || n == 4);
  if (n == 3) triangle(x[0], x[1], x[2], out);
  else quadrilateral(x, out);
}

void vg_face_measure(const struct vg_face_end end[2], const double x[4][3],
                     int n, const struct vg_face_shape *shape,
                     struct vg_face_figures *out)
{
  double f[3], g[3];

  for (int k = 0; k < 3; k++) {
    f[k] = (shape->centre[k] - end[0].at[k]) * end[0].share;
    g[k] = (end[1].at[k] - shape->centre[k]) * end[1].share;
  }
  measure(f, g, x[0], x[1], x[2], x[n - 1], shape, out);
}

double vg_face_border_skewness(const double cell[3], const double x[4][3],
                               int n, const struct vg_face_shape *shape)
{
  double f[3], c[3], e[3], far = 0,
                           area2 = vg_lane_dot(shape->area, shape->area), s;

  for (int k = 0; k < 3; k++) f[k] = shape->centre[k] - cell[k];
  s = area2 > 0 ? vg_lane_dot(shape->area, f) / area2 : 0;
  for (int k = 0; k < 3; k++) {
    c[k] = s * shape->area[k];
    e[k] = f[k] - c[k];
  }
  for (int i = 0; i < n; i++) far = larger(far, reach(e, x[i], shape->centre));
  return skewness_of(e, vg_lane_dot(c, c), far, 0.4);
}

int vg_angle_bin(double cosine)
{
  int bin = 0;

  while (bin < N_LIMIT && cosine < limit[bin]) bin++;
  return bin;
}

VG_WITHIN void measure_lane(struct vg_solver_batch *b, size_t t)
{
  double x[5][3], f[3], g[3];
  struct vg_face_shape shape;
  struct vg_face_figures figures;

  for (int i = 0; i < 5; i++)
    for (int k = 0; k < 3; k++) x[i][k] = b->x[i][k][t];
  triangle(x[2], x[3], x[4], &shape);
  for (int k = 0; k < 3; k++) {
    f[k] = (shape.centre[k] - x[0][k]) * b->share[0][t];
    g[k] = (x[1][k] - shape.centre[k]) * b->share[1][t];
  }
  measure(f, g, x[2], x[3], x[4], x[4], &shape, &figures);
  b->cosine[t] = figures.cosine;
  b->skewness[t] = figures.skewness;
  b->weight[t] = figures.weight;
}

/* All lanes, also the unused ones. */
VG_WITHIN void measure_all(struct vg_solver_batch *b)
{
  for (size_t t = 0; t < VG_SOLVER_BATCH; t++) measure_lane(b, t);
  for (size_t t = 0; t < VG_SOLVER_BATCH; t++) {
    double bin = 4 * b->skewness[t];

    b->quality[t] = vg_signed_square(b->cosine[t]);
    b->ratio[t] = vg_volume_ratio(b->volume[0][t], b->volume[1][t]);
    bin = bin < VG_HIST_SKEW - 1 ? bin : VG_HIST_SKEW - 1;
    b->skewness_bin[t] = (int32_t)bin;
  }
  for (size_t t = 0; t < VG_SOLVER_BATCH; t++) {
    int32_t bin = 0;

    for (int i = 0; i < N_ACUTE; i++) bin += b->cosine[t] < limit[i];
    b->angle_bin[t] = bin;
  }
}

/* In four lanes, because compilers must not change the order. */
#define LANES 4

VG_WITHIN void sum_all(const struct vg_solver_batch *b,
                       struct vg_solver_sums *out)
{
  double least[LANES], most[LANES], low[LANES], ratio[LANES], sum[LANES];
  size_t n = b->n, whole = n - n % LANES;
  uint64_t n_weight = 0, n_ratio = 0;

  for (int l = 0; l < LANES; l++) {
    least[l] = low[l] = ratio[l] = 1;
    most[l] = sum[l] = 0;
  }
  for (size_t t = 0; t < whole; t += LANES)
    for (size_t l = 0; l < LANES; l++) {
      double c = b->cosine[t + l], k = b->skewness[t + l];
      double w = b->weight[t + l], v = b->ratio[t + l];

      least[l] = c < least[l] ? c : least[l];
      most[l] = k > most[l] ? k : most[l];
      low[l] = w < low[l] ? w : low[l];
      ratio[l] = v < ratio[l] ? v : ratio[l];
      sum[l] += vg_fixed(c);
    }
  for (size_t t = whole; t < n; t++) {
    least[0] = b->cosine[t] < least[0] ? b->cosine[t] : least[0];
    most[0] = larger(b->skewness[t], most[0]);
    low[0] = b->weight[t] < low[0] ? b->weight[t] : low[0];
    ratio[0] = b->ratio[t] < ratio[0] ? b->ratio[t] : ratio[0];
    sum[0] += vg_fixed(b->cosine[t]);
  }
  for (int l = 1; l < LANES; l++) {
    least[0] = least[l] < least[0] ? least[l] : least[0];
    most[0] = larger(most[l], most[0]);
    low[0] = low[l] < low[0] ? low[l] : low[0];
    ratio[0] = ratio[l] < ratio[0] ? ratio[l] : ratio[0];
    sum[0] += sum[l];
  }
  if (low[0] < VG_LIMIT_WEIGHT)
    for (size_t t = 0; t < n; t++) n_weight += b->weight[t] < VG_LIMIT_WEIGHT;
  if (ratio[0] < VG_LIMIT_VOLUME_RATIO)
    for (size_t t = 0; t < n; t++)
      n_ratio += b->ratio[t] < VG_LIMIT_VOLUME_RATIO;
  *out = (struct vg_solver_sums){ least[0], most[0],  low[0], ratio[0],
                                  sum[0],   n_weight, n_ratio };
}

#ifdef VG_WIDE
static VG_WIDE void measure_wide(struct vg_solver_batch *b,
                                 struct vg_solver_sums *sums)
{
  measure_all(b);
  sum_all(b, sums);
}
#endif

static void measure_plain(struct vg_solver_batch *b,
                          struct vg_solver_sums *sums)
{
  measure_all(b);
  sum_all(b, sums);
}

void vg_solver_measure_batch(struct vg_solver_batch *b,
                             struct vg_solver_sums *sums)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) measure_wide(b, sums);
  else measure_plain(b, sums);
#else
  measure_plain(b, sums);
#endif
  for (size_t t = 0; sums->cosine_least < 0 && t < b->n; t++)
    b->angle_bin[t] = vg_angle_bin(b->cosine[t]);
}
