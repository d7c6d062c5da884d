/* Shape of cells: sign and size of volumes, dihedral angles, radius ratio.
 *
 * For a tetrahedron a b c d with u = b - a, v = c - a, w = d - a:
 *   V = u x v . w / 6,
 *   circumradius = | |u|^2 v x w + |v|^2 w x u + |w|^2 u x v | / (12 V),
 *   inradius = 3 V / (sum of face areas). */
#include <math.h>

#include "core/predicates.h"
#include "core/quality_parts.h"

#define DEGREE 57.295779513082320877

struct tet_shape {
  double cos_max, cos_min;   /* of the smallest and largest dihedral angle */
  double volume6;            /* |6 V| */
  double radius_ratio, edge2_sum;
};

static double dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

/* Extreme cosines of the angles between the faces of outward normals n and
 * squared lengths l. A face without area makes the worst of both kinds, so
 * that it cannot hide. Returns the sum of the lengths. */
static double add_angles(double n[4][3], const double l[4],
                         struct tet_shape *s)
{
  double length[4];

  for (int i = 0; i < 4; i++) {
    length[i] = sqrt(l[i]);
    if (!(length[i] > 0)) {
      s->cos_max = 1;
      s->cos_min = -1;
      return 0;
    }
  }
  for (int i = 0; i < 4; i++) {
    double scale = 1 / length[i];

    for (int k = 0; k < 3; k++) n[i][k] *= scale;
    for (int j = 0; j < i; j++) {
      double c = -dot(n[i], n[j]);

      if (c > s->cos_max) s->cos_max = c;
      if (c < s->cos_min) s->cos_min = c;
    }
  }
  return length[0] + length[1] + length[2] + length[3];
}

static struct tet_shape measure_tet(const double a[3], const double b[3],
                                    const double c[3], const double d[3])
{
  struct tet_shape s = { -2, 2, 0, 0, 0 };
  double u[3], v[3], w[3], n[4][3], l[4], q[3];
  double uu, vv, ww, area2;

  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = d[k] - a[k];
  }
  cross(v, w, n[1]);
  cross(w, u, n[2]);
  cross(u, v, n[3]);
  for (int k = 0; k < 3; k++) n[0][k] = -n[1][k] - n[2][k] - n[3][k];
  for (int i = 0; i < 4; i++) l[i] = dot(n[i], n[i]);
  uu = dot(u, u);
  vv = dot(v, v);
  ww = dot(w, w);
  for (int k = 0; k < 3; k++) {
    double e = v[k] - u[k], f = w[k] - u[k], g = w[k] - v[k];

    q[k] = uu * n[1][k] + vv * n[2][k] + ww * n[3][k];
    s.edge2_sum += e * e + f * f + g * g;
  }
  s.edge2_sum += uu + vv + ww;
  s.volume6 = fabs(dot(n[3], w));
  area2 = add_angles(n, l, &s);   /* normalises n */
  /* 3 (3 V / A) (12 V / |q|) with A = area2 / 2 and V = volume6 / 6 */
  s.radius_ratio = area2 * sqrt(dot(q, q));
  if (s.radius_ratio > 0)
    s.radius_ratio = 6 * s.volume6 * s.volume6 / s.radius_ratio;
  return s;
}

static double angle_of(double cosine)
{
  if (cosine >= 1) return 0;
  if (cosine <= -1) return 180;
  return cosine == cosine ? acos(cosine) * DEGREE : 0;
}

static size_t bin_of(double x, double per_unit, size_t n)
{
  double at = x * per_unit;

  if (!(at > 0)) return 0;
  return at < (double)n ? (size_t)at : n - 1;
}

static void count_angles(struct vg_figures *f, double least, double most)
{
  static const double low[5] = { 5, 10, 15, 20, 30 };
  static const double high[3] = { 150, 160, 170 };
  struct vg_counts *n = &f->n;

  if (least < f->angle_min) f->angle_min = least;
  if (most > f->angle_max) f->angle_max = most;
  for (int k = 0; k < 5; k++) n->below[k] += least < low[k];
  for (int k = 0; k < 3; k++) n->above[k] += most > high[k];
  n->angle_min[bin_of(least, 1 / 5., VG_HIST_ANGLE)]++;
  n->angle_max[bin_of(most, 1 / 5., VG_HIST_ANGLE)]++;
  n->fine[bin_of(least, VG_FINE_PER_DEGREE, VG_N_FINE)]++;
}

static void note_worst(struct vg_figures *f, const struct vg_mesh *m,
                       size_t i, size_t cell, double angle)
{
  struct vg_worst_cell w = { .cell = cell, .value = angle };

  if (f->n_worst == VG_WORST && angle > f->worst[VG_WORST - 1].value) return;
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 4; j++) w.at[k] += m->point[m->tet[i][j]][k] / 4;
  vg_figures_worst(f, &w);
}

static void judge_tet(const struct vg_mesh *m, size_t i, size_t cell,
                      struct vg_figures *f)
{
  const uint32_t *n = m->tet[i];
  struct tet_shape s = measure_tet(m->point[n[0]], m->point[n[1]],
                                   m->point[n[2]], m->point[n[3]]);
  double least = angle_of(s.cos_max), most = angle_of(s.cos_min);

  f->n.n_tet++;
  count_angles(f, least, most);
  note_worst(f, m, i, cell, least);
  vg_exact_add(&f->n.sum_radius, s.radius_ratio);
  if (s.radius_ratio < f->radius_ratio_min)
    f->radius_ratio_min = s.radius_ratio;
  f->n.radius_ratio[bin_of(s.radius_ratio, VG_HIST_UNIT, VG_HIST_UNIT)]++;
  /* (3 V)^2 = volume6^2 / 4 */
  if (s.edge2_sum > 0)
    vg_exact_add(&f->n.sum_mean,
                 12 * cbrt(s.volume6 * s.volume6 / 4) / s.edge2_sum);
}

/* A corner tetrahedron of a prism, pyramid or hexahedron is spanned by a node
 * and its three neighbours; a cell is sound when all of them are positive. */
static const uint8_t pri_corner[6][4] = {
  {0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5},
  {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}
};
static const uint8_t pyr_corner[4][4] = { /* of the base, with the apex */
  {0, 3, 1, 2}, {3, 4, 0, 2}, {4, 1, 3, 2}, {1, 0, 4, 2}
};
static const uint8_t hex_corner[8][4] = {
  {0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7},
  {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}
};

static int corners_positive(const struct vg_mesh *m, int kind,
                            const uint32_t *n)
{
  static const int count[VG_CELL_KINDS] = { 0, 4, 6, 8 };
  static const uint8_t (*const corner[VG_CELL_KINDS])[4] = {
    NULL, pyr_corner, pri_corner, hex_corner
  };

  for (int i = 0; i < count[kind]; i++) {
    const uint8_t *c = corner[kind][i];

    if (!(vg_orient3d(m->point[n[c[0]]], m->point[n[c[1]]],
                      m->point[n[c[2]]], m->point[n[c[3]]]) > 0)) return 0;
  }
  return 1;
}

/* By the divergence theorem, each quad as the mean of its two diagonals. */
static double mixed_volume(const struct vg_mesh *m, int kind,
                           const uint32_t *n)
{
  const struct vg_cell_faces *f = &vg_cell_faces[kind];
  const double *o = m->point[n[0]];
  double six = 0;

  for (int i = 0; i < f->n_face; i++) {
    const double *a = m->point[n[f->node[i][0]]];
    const double *b = m->point[n[f->node[i][1]]];
    const double *c = m->point[n[f->node[i][2]]];

    if (i < f->n_tri) six += vg_tri_cone(o, a, b, c);
    else six += vg_quad_cone(o, a, b, c, m->point[n[f->node[i][3]]]);
  }
  return six / 6;
}

static void judge_mixed(const struct vg_mesh *m, int kind, float *volume,
                        struct vg_figures *f)
{
  struct vg_cells c = vg_mesh_cells(m, kind);
  size_t width = (size_t)vg_cell_faces[kind].n_node;

  for (size_t i = 0; i < c.n; i++) {
    const uint32_t *n = c.node + width * i;
    double v = mixed_volume(m, kind, n);

    vg_exact_add(&f->n.volume, v);
    volume[c.first + i] = (float)v;
    f->n.not_positive += !(v > 0) || !corners_positive(m, kind, n);
  }
}

void vg_judge_shape(const struct vg_mesh *m, size_t first, float *volume,
                    struct vg_figures *f)
{
  for (size_t i = 0; i < m->n_tet; i++) {
    const uint32_t *n = m->tet[i];
    double six = vg_orient3d(m->point[n[0]], m->point[n[1]], m->point[n[2]],
                             m->point[n[3]]);

    f->n.not_positive += !(six > 0);
    vg_exact_add(&f->n.volume, six / 6);
    volume[i] = (float)(six / 6);
    judge_tet(m, i, first + i, f);
  }
  for (int kind = VG_CELL_PYR; kind < VG_CELL_KINDS; kind++)
    judge_mixed(m, kind, volume, f);
}

void vg_mesh_cell_quality(const struct vg_mesh *m, float *angle_min,
                          float *radius_ratio)
{
  for (size_t i = 0; i < m->n_tet; i++) {
    const uint32_t *n = m->tet[i];
    struct tet_shape s = measure_tet(m->point[n[0]], m->point[n[1]],
                                     m->point[n[2]], m->point[n[3]]);

    if (angle_min) angle_min[i] = (float)angle_of(s.cos_max);
    if (radius_ratio) radius_ratio[i] = (float)s.radius_ratio;
  }
}
