/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Shape of cells: sign and size of volumes, dihedral angles, radius ratio.
 * Tetrahedra are measured in batches (quality_tets.c). */
#include <assert.h>
#include <math.h>

#include "core/geometry/predicates.h"
#include "core/geometry/volume.h"
#include "core/judge/quality_solver.h"
#include "core/judge/quality_tets.h"

static void count_batch(struct vg_stats *f, const struct vg_tet_batch *b,
                        const struct vg_tet_bins *c)
{
  struct vg_counts *n = &f->n;

  for (size_t i = 0; i < b->n; i++) {
    n->angle_min[c->angle_min[i]]++;
    n->angle_max[c->angle_max[i]]++;
    n->fine[c->fine[i]]++;
    n->radius_ratio[c->radius_ratio[i]]++;
  }
  for (int k = 0; k < 5; k++) n->below[k] += c->below[k];
  for (int k = 0; k < 3; k++) n->above[k] += c->above[k];
  if (c->angle_least < f->angle_min) f->angle_min = c->angle_least;
  if (c->angle_most > f->angle_max) f->angle_max = c->angle_most;
  if (c->radius_ratio_least < f->radius_ratio_min)
    f->radius_ratio_min = c->radius_ratio_least;
  n->n_tet += b->n;
  vg_exact_add_all(&n->volume, b->n, b->volume);
  vg_exact_add_all(&n->sum_radius, b->n, b->radius_ratio);
  vg_exact_add_all(&n->sum_mean, b->n, b->mean_ratio);
  vg_exact_add_all(&n->sum_length, b->n, b->edge);
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

/* Could a cell with this smallest angle be flat or one of the worst? */
static int is_notable(const struct vg_stats *f, const struct vg_flat_part *part,
                      double angle)
{
  return (part && angle < VG_FLAT_LIMIT) || f->n_worst < VG_WORST ||
         angle <= f->worst[VG_WORST - 1].value;
}

/* Measure n tetrahedra of m from `first` on. cell: number of the first one. */
static void judge_batch(const struct vg_mesh *m, size_t first, size_t n,
                        size_t cell, const struct vg_flat_part *part,
                        float *volume, struct vg_stats *f,
                        struct vg_solver_sweep *solver)
{
  struct vg_tet_batch b;
  struct vg_tet_bins bins;

  vg_tets_measure(m, first, n, &b);
  vg_tets_count(&b, &bins);
  count_batch(f, &b, &bins);
  for (size_t i = 0; i < n; i++) {
    f->n.not_positive += !(b.volume[i] > 0);
    volume[first + i] = (float)b.volume[i];
  }
  for (size_t i = 0; solver && i < n; i++) {
    solver->quality[first + i] = (float)b.slant2[i];
    solver->determinant[first + i] = (float)b.determinant[i];
  }
  if (!is_notable(f, part, bins.angle_least)) return;
  for (size_t i = 0; i < n; i++)
    if (is_notable(f, part, b.least[i]))
      note_worst(f, m, first + i, cell + i, part, b.least[i]);
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
                    struct vg_stats *f, struct vg_solver_sweep *solver)
{
  assert(volume || !vg_mesh_n_cell(m));
  for (size_t i = 0, n; i < m->n_tet; i += n) {
    n = m->n_tet - i < VG_TET_BATCH ? m->n_tet - i : VG_TET_BATCH;
    judge_batch(m, i, n, first + i, part, volume, f, solver);
  }
  for (int kind = VG_CELL_PYR; kind < VG_CELL_KINDS; kind++)
    judge_mixed(m, kind, volume, f);
  if (solver) vg_solver_measure_mixed(solver);
}

void vg_mesh_cell_quality(const struct vg_mesh *m, float *angle_min,
                          float *radius_ratio)
{
  struct vg_tet_batch b;

  for (size_t i = 0, n; i < m->n_tet; i += n) {
    n = m->n_tet - i < VG_TET_BATCH ? m->n_tet - i : VG_TET_BATCH;
    vg_tets_measure(m, i, n, &b);
    for (size_t t = 0; t < n; t++) {
      if (angle_min) angle_min[i + t] = (float)b.least[t];
      if (radius_ratio) radius_ratio[i + t] = (float)b.radius_ratio[t];
    }
  }
}
