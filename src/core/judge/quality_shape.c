/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shape of cells: sign and size of volumes, dihedral angles, radius ratio.
 *
 * For a tetrahedron a b c d with u = b - a, v = c - a, w = d - a:
 *   V = u x v . w / 6,
 *   circumradius = | |u|^2 v x w + |v|^2 w x u + |w|^2 u x v | / (12 V),
 *   inradius = 3 V / (sum of face areas). */
#include <assert.h>
#include <math.h>

#include "base/wide.h"
#include "core/geometry/predicates.h"
#include "core/geometry/volume.h"
#include "core/judge/quality_parts.h"

#define DEGREE 57.295779513082320877

/* Tetrahedra are measured GROUP at a time, each step for all of them, which
 * compilers vectorise. They are counted in batches of BATCH. */
#define GROUP 4
#define BATCH 256

typedef double lanes[GROUP];

/* Results for GROUP tetrahedra. */
struct tet_shapes {
  lanes cos_max, cos_min; /* cosines of the smallest and largest dihedral
                             angle */
  lanes least, most;      /* these angles, in degrees */
  lanes det;              /* 6 V, as vg_orient3d computes it */
  lanes doubt2;           /* the sign of det is sure if its square is more */
  lanes volume6;          /* |6 V| */
  lanes radius_ratio, edge2_sum;
};

/* Results for up to BATCH tetrahedra. */
struct batch {
  double least[BATCH], most[BATCH]; /* angles */
  double volume[BATCH];
  double radius_ratio[BATCH], mean_ratio[BATCH], edge[BATCH];
};

VG_WITHIN void dot(lanes a[3], lanes b[3], lanes out)
{
  for (int t = 0; t < GROUP; t++)
    out[t] = a[0][t] * b[0][t] + a[1][t] * b[1][t] + a[2][t] * b[2][t];
}

VG_WITHIN void cross(lanes a[3], lanes b[3], lanes c[3])
{
  for (int t = 0; t < GROUP; t++) {
    c[0][t] = a[1][t] * b[2][t] - a[2][t] * b[1][t];
    c[1][t] = a[2][t] * b[0][t] - a[0][t] * b[2][t];
    c[2][t] = a[0][t] * b[1][t] - a[1][t] * b[0][t];
  }
}

/* Extreme cosines of the angles between the faces with outward normals n. A
 * face without area counts as the worst of both kinds, so that it cannot go
 * unnoticed. area2: sum of the lengths of the normals, which are normalised. */
VG_WITHIN void add_angles(lanes n[4][3], struct tet_shapes *s, lanes area2)
{
  lanes length[4], c;

  for (int i = 0; i < 4; i++) {
    dot(n[i], n[i], length[i]);
    for (int t = 0; t < GROUP; t++) length[i][t] = sqrt(length[i][t]);
  }
  for (int t = 0; t < GROUP; t++) {
    s->cos_max[t] = -2;
    s->cos_min[t] = 2;
    area2[t] = length[0][t] + length[1][t] + length[2][t] + length[3][t];
  }
  for (int i = 0; i < 4; i++) {
    lanes scale;

    for (int t = 0; t < GROUP; t++) scale[t] = 1 / length[i][t];
    for (int k = 0; k < 3; k++)
      for (int t = 0; t < GROUP; t++) n[i][k][t] *= scale[t];
    for (int j = 0; j < i; j++) {
      dot(n[i], n[j], c);
      for (int t = 0; t < GROUP; t++) {
        s->cos_max[t] = -c[t] > s->cos_max[t] ? -c[t] : s->cos_max[t];
        s->cos_min[t] = -c[t] < s->cos_min[t] ? -c[t] : s->cos_min[t];
      }
    }
  }
  for (int t = 0; t < GROUP; t++) {
    if (length[0][t] > 0 && length[1][t] > 0 && length[2][t] > 0 &&
        length[3][t] > 0)
      continue;
    s->cos_max[t] = 1;
    s->cos_min[t] = -1;
    area2[t] = 0;
  }
}

/* Computes the sum of squared edges, and q with |q| = |6 V| times twice the
 * circumradius. n: normals of the faces. */
VG_WITHIN void add_edges(lanes u[3], lanes v[3], lanes w[3], lanes n[4][3],
                         lanes q[3], struct tet_shapes *s)
{
  lanes uu, vv, ww;

  dot(u, u, uu);
  dot(v, v, vv);
  dot(w, w, ww);
  /* The bound of vg_orient3d is at most 8.9e-16 times six products of three
   * lengths. */
  for (int t = 0; t < GROUP; t++) s->doubt2[t] = 3e-29 * uu[t] * vv[t] * ww[t];
  for (int t = 0; t < GROUP; t++) s->edge2_sum[t] = 0;
  for (int k = 0; k < 3; k++)
    for (int t = 0; t < GROUP; t++) {
      double e = v[k][t] - u[k][t], f = w[k][t] - u[k][t];
      double g = w[k][t] - v[k][t];

      q[k][t] = uu[t] * n[1][k][t] + vv[t] * n[2][k][t] + ww[t] * n[3][k][t];
      s->edge2_sum[t] += e * e + f * f + g * g;
    }
  for (int t = 0; t < GROUP; t++) s->edge2_sum[t] += uu[t] + vv[t] + ww[t];
}

/* Arc cosines in degrees; 0 for NaN. With the rational approximation of fdlibm
 * (Sun Microsystems, 1993) for the arc sine up to 0.5, without branches, and
 * with the same bits on all processors. */
VG_WITHIN void degrees(lanes c, lanes out)
{
  static const double pi = 3.14159265358979323846;

  for (int t = 0; t < GROUP; t++) {
    double a = fabs(c[t]) < 1 ? fabs(c[t]) : 1, is_steep = a > 0.5 ? 1.0 : 0.0;
    double z = a > 0.5 ? (1 - a) / 2 : a * a, x = a > 0.5 ? sqrt(z) : a;
    double p = 7.91534994289814532176e-04 + z * 3.47933107596021167570e-05;
    double q = -6.88283971605453293030e-01 + z * 7.70381505559019352791e-02;
    double y;

    p = -4.00555345006794114027e-02 + z * p;
    p = 2.01212532134862925881e-01 + z * p;
    p = -3.25565818622400915405e-01 + z * p;
    p = 1.66666666666666657415e-01 + z * p;
    q = 2.02094576023350569471e+00 + z * q;
    q = -2.40339491173441421878e+00 + z * q;
    q = 1 + z * q;
    y = x + x * (z * p / q);
    y = is_steep > 0 ? 2 * y : pi / 2 - y;
    y = (c[t] < 0 ? pi - y : y) * DEGREE;
    out[t] = c[t] == c[t] ? y : 0;
  }
}

/* x: corners, [4][3] of GROUP tetrahedra. */
VG_WITHIN void measure_lanes(lanes x[4][3], struct tet_shapes *s)
{
  lanes u[3], v[3], w[3], n[4][3], q[3], area2, qq;

  for (int k = 0; k < 3; k++)
    for (int t = 0; t < GROUP; t++) {
      u[k][t] = x[1][k][t] - x[0][k][t];
      v[k][t] = x[2][k][t] - x[0][k][t];
      w[k][t] = x[3][k][t] - x[0][k][t];
    }
  cross(v, w, n[1]);
  cross(w, u, n[2]);
  cross(u, v, n[3]);
  for (int k = 0; k < 3; k++)
    for (int t = 0; t < GROUP; t++)
      n[0][k][t] = -n[1][k][t] - n[2][k][t] - n[3][k][t];
  add_edges(u, v, w, n, q, s);
  dot(n[3], w, s->det);
  dot(q, q, qq);
  add_angles(n, s, area2);
  degrees(s->cos_max, s->least);
  degrees(s->cos_min, s->most);
  /* 3 (3 V / A) (12 V / |q|) with A = area2 / 2 and V = volume6 / 6 */
  for (int t = 0; t < GROUP; t++) {
    double ratio = area2[t] * sqrt(qq[t]);

    s->volume6[t] = fabs(s->det[t]);
    s->radius_ratio[t] = ratio > 0 ? 6 * s->volume6[t] * s->volume6[t] / ratio
                                   : ratio;
  }
}

#ifdef VG_WIDE
static VG_WIDE void measure_wide(lanes x[4][3], struct tet_shapes *s)
{
  measure_lanes(x, s);
}
#endif

/* Four lanes at once if the processor supports AVX2. The operations are the
 * same and give the same bits (no products are fused). */
static void measure_tets(lanes x[4][3], struct tet_shapes *s)
{
#ifdef VG_WIDE
  if (VG_IS_WIDE) {
    measure_wide(x, s);
    return;
  }
#endif
  measure_lanes(x, s);
}

/* Tetrahedra first .. first + n - 1 of m, n <= GROUP. */
static void measure_some(const struct vg_mesh *m, size_t first, size_t n,
                         struct tet_shapes *s)
{
  lanes x[4][3];

  for (size_t t = 0; t < GROUP; t++)
    for (int i = 0; i < 4; i++)
      for (int k = 0; k < 3; k++)
        x[i][k][t] = m->point[m->tet[first + (t < n ? t : 0)][i]][k];
  measure_tets(x, s);
}

static size_t bin_of(double x, double per_unit, size_t n)
{
  double at = x * per_unit;

  if (!(at > 0)) return 0;
  return at < (double)n ? (size_t)at : n - 1;
}

static void count_angles(struct vg_stats *f, size_t n, const double *least,
                         const double *most)
{
  static const double low[5] = { 5, 10, 15, 20, 30 };
  static const double high[3] = { 150, 160, 170 };

  for (size_t i = 0; i < n; i++) {
    if (least[i] < f->angle_min) f->angle_min = least[i];
    if (most[i] > f->angle_max) f->angle_max = most[i];
    f->n.angle_min[bin_of(least[i], 1 / 5., VG_HIST_ANGLE)]++;
    f->n.angle_max[bin_of(most[i], 1 / 5., VG_HIST_ANGLE)]++;
    f->n.fine[bin_of(least[i], VG_FINE_PER_DEGREE, VG_N_FINE)]++;
  }
  for (int k = 0; k < 5; k++)
    for (size_t i = 0; i < n; i++) f->n.below[k] += least[i] < low[k];
  for (int k = 0; k < 3; k++)
    for (size_t i = 0; i < n; i++) f->n.above[k] += most[i] > high[k];
}

static void count_ratios(struct vg_stats *f, size_t n, const double *ratio)
{
  for (size_t i = 0; i < n; i++) {
    if (ratio[i] < f->radius_ratio_min) f->radius_ratio_min = ratio[i];
    f->n.radius_ratio[bin_of(ratio[i], VG_HIST_UNIT, VG_HIST_UNIT)]++;
  }
}

/* Classifies and counts a flat cell. */
static void count_flat(struct vg_stats *f, const struct vg_mesh *m,
                       const struct vg_flat_part *part, const uint32_t node[4],
                       struct vg_flat_points *points)
{
  uint32_t id[4];
  const double *x[4];
  enum vg_point_kind inner[4];
  struct vg_flat_class c;

  for (int k = 0; k < 4; k++) {
    x[k] = m->point[node[k]];
    id[k] = part->id[node[k]];
    inner[k] = part->is_interface || id[k] - part->own_at >= part->n_own
               ? VG_POINT_INTERFACE
               : VG_POINT_FIELD;
  }
  c = vg_flat_classify(part->flat, id, x, inner);
  f->n.flat[c.cause]++;
  f->n.flat_interface[c.cause] += (uint64_t)c.at_interface;
  f->n.flat_spanning[c.cause] += (uint64_t)c.is_spanning;
  f->n.flat_needle[c.cause] += (uint64_t)c.has_needle;
  *points = c.points;
}

static void note_worst(struct vg_stats *f, const struct vg_mesh *m, size_t i,
                       size_t cell, const struct vg_flat_part *part,
                       double angle)
{
  struct vg_worst_cell w = { .cell = cell, .value = angle };

  if (part && angle < VG_FLAT_LIMIT)
    count_flat(f, m, part, m->tet[i], &w.points);
  if (f->n_worst == VG_WORST && angle > f->worst[VG_WORST - 1].value) return;
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 4; j++) w.at[k] += m->point[m->tet[i][j]][k] / 4;
  vg_stats_worst(f, &w);
}

/* Signed volume of tetrahedron v, the one in lane t of s. */
static double volume_of(const struct vg_mesh *m, const uint32_t v[4],
                        const struct tet_shapes *s, size_t t)
{
  double six = s->det[t];

  if (!(six * six > s->doubt2[t]))
    six = vg_orient3d(m->point[v[0]], m->point[v[1]], m->point[v[2]],
                      m->point[v[3]]);
  return six / 6;
}

/* Tetrahedra first + at .. first + at + n - 1 of m, n <= GROUP: entries `at` to
 * at + n - 1 of the batch. */
static void measure_group(const struct vg_mesh *m, size_t first, size_t at,
                          size_t n, struct batch *b)
{
  struct tet_shapes s;

  measure_some(m, first + at, n, &s);
  for (size_t t = 0; t < n; t++) {
    b->volume[at + t] = volume_of(m, m->tet[first + at + t], &s, t);
    b->least[at + t] = s.least[t];
    b->most[at + t] = s.most[t];
    b->radius_ratio[at + t] = s.radius_ratio[t];
    /* (3 V)^2 = volume6^2 / 4 */
    b->mean_ratio[at + t] = s.edge2_sum[t] > 0
                            ? 12 * cbrt(s.volume6[t] * s.volume6[t] / 4) /
                                s.edge2_sum[t]
                            : 0;
    b->edge[at + t] = sqrt(s.edge2_sum[t] / 6);
  }
}

/* Measure n tetrahedra of m from `first` on. cell: number of the first one. */
static void judge_batch(const struct vg_mesh *m, size_t first, size_t n,
                        size_t cell, const struct vg_flat_part *part,
                        float *volume, struct vg_stats *f)
{
  struct batch b;

  for (size_t i = 0; i < n; i += GROUP)
    measure_group(m, first, i, n - i < GROUP ? n - i : GROUP, &b);
  for (size_t i = 0; i < n; i++) {
    f->n.not_positive += !(b.volume[i] > 0);
    volume[first + i] = (float)b.volume[i];
  }
  f->n.n_tet += n;
  count_angles(f, n, b.least, b.most);
  count_ratios(f, n, b.radius_ratio);
  for (size_t i = 0; i < n; i++)
    note_worst(f, m, first + i, cell + i, part, b.least[i]);
  vg_exact_add_all(&f->n.volume, n, b.volume);
  vg_exact_add_all(&f->n.sum_radius, n, b.radius_ratio);
  vg_exact_add_all(&f->n.sum_mean, n, b.mean_ratio);
  vg_exact_add_all(&f->n.sum_length, n, b.edge);
}

/* The corner tetrahedra of a prism, pyramid or hexahedron, each spanned by a
 * node and its three neighbours. A cell is valid if all of them are positive.
 */
static const uint8_t pri_corner[6][4] = { { 0, 1, 2, 3 }, { 1, 2, 0, 4 },
                                          { 2, 0, 1, 5 }, { 3, 5, 4, 0 },
                                          { 4, 3, 5, 1 }, { 5, 4, 3, 2 } };
static const uint8_t pyr_corner[4][4] = { /* corners of the base, with the
                                             apex */
                                          { 0, 3, 1, 2 },
                                          { 3, 4, 0, 2 },
                                          { 4, 1, 3, 2 },
                                          { 1, 0, 4, 2 }
};
static const uint8_t hex_corner[8][4] = { { 0, 1, 3, 4 }, { 1, 2, 0, 5 },
                                          { 2, 3, 1, 6 }, { 3, 0, 2, 7 },
                                          { 4, 7, 5, 0 }, { 5, 4, 6, 1 },
                                          { 6, 5, 7, 2 }, { 7, 6, 4, 3 } };

static int corners_positive(const double (*x)[3], int kind, const uint32_t *n)
{
  static const int count[VG_CELL_KINDS] = { 0, 4, 6, 8 };
  static const uint8_t(*const corner[VG_CELL_KINDS])[4] = { NULL, pyr_corner,
                                                            pri_corner,
                                                            hex_corner };

  for (int i = 0; i < count[kind]; i++) {
    const uint8_t *c = corner[kind][i];

    if (!(vg_orient3d(x[n[c[0]]], x[n[c[1]]], x[n[c[2]]], x[n[c[3]]]) > 0))
      return 0;
  }
  return 1;
}

/* By the divergence theorem; each quad is the mean of its two triangulations.
 */
double vg_cell_volume(const double (*x)[3], int kind, const uint32_t *n)
{
  assert(kind >= 0 && kind < VG_CELL_KINDS);

  const struct vg_cell_faces *f = &vg_cell_faces[kind];
  const double *o = x[n[0]];
  double six = 0;

  for (int i = 0; i < f->n_face; i++) {
    const double *a = x[n[f->node[i][0]]], *b = x[n[f->node[i][1]]];
    const double *c = x[n[f->node[i][2]]];

    if (i < f->n_tri) six += vg_tri_cone(o, a, b, c);
    else six += vg_quad_cone(o, a, b, c, x[n[f->node[i][3]]]);
  }
  return six / 6;
}

int vg_cell_positive(const double (*x)[3], int kind, const uint32_t *n)
{
  assert(kind >= 0 && kind < VG_CELL_KINDS);
  if (kind == VG_CELL_TET)
    return vg_orient3d(x[n[0]], x[n[1]], x[n[2]], x[n[3]]) > 0;
  return vg_cell_volume(x, kind, n) > 0 && corners_positive(x, kind, n);
}

static void judge_mixed(const struct vg_mesh *m, int kind, float *volume,
                        struct vg_stats *f)
{
  const double(*x)[3] = (const double(*)[3])m->point;
  struct vg_cells c = vg_mesh_cells(m, kind);
  size_t width = (size_t)vg_cell_faces[kind].n_node;

  for (size_t i = 0; i < c.n; i++) {
    const uint32_t *n = c.node + width * i;
    double v = vg_cell_volume(x, kind, n);

    vg_exact_add(&f->n.volume, v);
    volume[c.first + i] = (float)v;
    f->n.not_positive += !(v > 0) || !corners_positive(x, kind, n);
  }
}

void vg_judge_shape(const struct vg_mesh *m, size_t first,
                    const struct vg_flat_part *part, float *volume,
                    struct vg_stats *f)
{
  assert(volume || !(m->n_tet + m->n_pyr + m->n_pri + m->n_hex));
  for (size_t i = 0, n; i < m->n_tet; i += n) {
    n = m->n_tet - i < BATCH ? m->n_tet - i : BATCH;
    judge_batch(m, i, n, first + i, part, volume, f);
  }
  for (int kind = VG_CELL_PYR; kind < VG_CELL_KINDS; kind++)
    judge_mixed(m, kind, volume, f);
}

void vg_mesh_cell_quality(const struct vg_mesh *m, float *angle_min,
                          float *radius_ratio)
{
  for (size_t i = 0, n; i < m->n_tet; i += n) {
    struct tet_shapes s;

    n = m->n_tet - i < GROUP ? m->n_tet - i : GROUP;
    measure_some(m, i, n, &s);
    for (size_t t = 0; t < n; t++) {
      if (angle_min) angle_min[i + t] = (float)s.least[t];
      if (radius_ratio) radius_ratio[i + t] = (float)s.radius_ratio[t];
    }
  }
}
