/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lengths of edges and shapes of tetrahedra in the metric of the sizing field.
 * Only + - * / and sqrt are used, so that the figures are the same on all
 * processors. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "core/judge/quality_parts.h"

/* Number of regular tetrahedra of edge length 1 in a unit volume: 6 sqrt 2. */
#define TETS_PER_UNIT 8.485281374238570

/* --- metrics at points ---------------------------------------------------- */

vg_status vg_point_metrics_init(struct vg_point_metrics *p,
                                const struct vg_sizing *sizing,
                                const struct vg_mesh *m, size_t first,
                                struct vg_error *err)
{
  assert(sizing && m && first <= m->n_tet);
  p->sizing = sizing;
  p->m = m;
  p->first = first;
  p->at = vg_calloc(m->n_point, sizeof *p->at);
  return p->at ? VG_OK : vg_fail_memory(err, "the metrics at the points");
}

void vg_point_metrics_release(struct vg_point_metrics *p)
{
  free(p->at);
  p->at = NULL;
}

static const struct vg_judged_point *metric_at(struct vg_point_metrics *p,
                                               uint32_t i)
{
  struct vg_judged_point *at = &p->at[i];
  double t[6];

  if (at->size > 0) return at;
  at->size = vg_sizing_stretch_at(p->sizing, p->m->point[i], t);
  vg_tensor_square(t, at->m);
  return at;
}

/* --- lengths -------------------------------------------------------------- */

double vg_length_in_metric(struct vg_point_metrics *p, uint32_t a, uint32_t b)
{
  const double *from = p->m->point[a], *to = p->m->point[b];
  double e[3];

  for (int k = 0; k < 3; k++) e[k] = to[k] - from[k];
  return vg_metric_length(metric_at(p, a)->m, metric_at(p, b)->m, e);
}

/* Bins begin at 2^(k / 12) times powers of 2. */
static size_t length_bin(double length)
{
  static const double begin[VG_PER_OCTAVE + 1] = { 1,
                                                   1.0594630943592953,
                                                   1.1224620483093730,
                                                   1.1892071150027210,
                                                   1.2599210498948732,
                                                   1.3348398541700344,
                                                   1.4142135623730951,
                                                   1.4983070768766815,
                                                   1.5874010519681994,
                                                   1.6817928305074290,
                                                   1.7817974362806785,
                                                   1.8877486253633868,
                                                   2 };
  const size_t octaves = VG_HIST_LENGTH / VG_PER_OCTAVE;
  double scaled = length / VG_LENGTH_LOWEST;
  size_t k;
  int e;

  if (!(scaled >= 1)) return 0;
  if (!(scaled < (double)(1u << octaves))) return VG_HIST_LENGTH - 1;
  scaled = 2 * frexp(scaled, &e);
  /* log2(1 + x) is at least x, and at most 0.09 more */
  k = (size_t)((scaled - 1) * VG_PER_OCTAVE);
  while (scaled >= begin[k + 1]) k++;
  return (size_t)(e - 1) * VG_PER_OCTAVE + k;
}

void vg_stats_length(struct vg_stats *f, double length)
{
  static const double from[3] = { 0.7, 0.7071067811865475, 0.5 };
  static const double to[3] = { 1.4, 1.4142135623730951, 2 };

  f->n.n_length++;
  f->n.length[length_bin(length)]++;
  for (int k = 0; k < 3; k++)
    f->n.within[k] += length >= from[k] && length <= to[k];
  if (-length > f->most[VG_MOST_SHORT]) f->most[VG_MOST_SHORT] = -length;
  if (length > f->most[VG_MOST_LONG]) f->most[VG_MOST_LONG] = length;
}

/* --- cells ---------------------------------------------------------------- */

/* Six times the volume of a tetrahedron with the edges u, v, w. */
static double volume6(const double u[3], const double v[3], const double w[3])
{
  return (u[1] * v[2] - u[2] * v[1]) * w[0] +
         (u[2] * v[0] - u[0] * v[2]) * w[1] +
         (u[0] * v[1] - u[1] * v[0]) * w[2];
}

/* Sum of the squared edges of a tetrahedron in the metric m. */
static double edges_squared(const double m[6], const double u[3],
                            const double v[3], const double w[3])
{
  double e[3][3];

  for (int k = 0; k < 3; k++) {
    e[0][k] = v[k] - u[k];
    e[1][k] = w[k] - v[k];
    e[2][k] = u[k] - w[k];
  }
  return vg_tensor_form(m, u) + vg_tensor_form(m, v) + vg_tensor_form(m, w) +
         vg_tensor_form(m, e[0]) + vg_tensor_form(m, e[1]) +
         vg_tensor_form(m, e[2]);
}

/* sqrt(det M) */
static double density(double size)
{
  return 1 / (size * size * size);
}

/* Mean of sqrt(det M) over a cell, by the rule of second order with the weights
 * 1/20 at corners and 4/5 at the centroid, where the size is the mean of those
 * at the corners. */
static double mean_density(const struct vg_judged_point *const corner[4])
{
  double sum = 0, size = 0;

  for (int k = 0; k < 4; k++) {
    sum += density(corner[k]->size);
    size += corner[k]->size / 4;
  }
  return sum / 20 + 0.8 * density(size);
}

static void count_cell(struct vg_stats *f, double mean_ratio)
{
  double bin = mean_ratio * VG_HIST_UNIT;

  f->n.n_metric_cell++;
  f->n.metric_below[0] += mean_ratio < 0.1;
  f->n.metric_below[1] += mean_ratio < 0.2;
  f->n.metric_ratio[bin < VG_HIST_UNIT ? (size_t)bin : VG_HIST_UNIT - 1]++;
  vg_exact_add(&f->n.sum_metric_ratio, mean_ratio);
  if (-mean_ratio > f->most[VG_MOST_DISTORTED])
    f->most[VG_MOST_DISTORTED] = -mean_ratio;
}

/* A cell without positive volume has the mean ratio 0. */
static void judge_cell(struct vg_point_metrics *p, const uint32_t node[4],
                       struct vg_stats *f)
{
  double(*const x)[3] = p->m->point;
  const struct vg_judged_point *corner[4], *finest;
  double e[3][3], six, sum, ratio = 0;

  for (int k = 0; k < 4; k++) corner[k] = metric_at(p, node[k]);
  finest = corner[0];
  for (int k = 1; k < 4; k++) {
    if (corner[k]->size < finest->size) finest = corner[k];
    for (int c = 0; c < 3; c++) e[k - 1][c] = x[node[k]][c] - x[node[0]][c];
  }
  six = volume6(e[0], e[1], e[2]);
  sum = edges_squared(finest->m, e[0], e[1], e[2]);
  if (six > 0 && sum > 0) {
    double three = six / 2 * density(finest->size); /* 3 V */

    if (three > 0) ratio = 12 * vg_cube_root(three * three) / sum;
  }
  count_cell(f, ratio);
  vg_exact_add(&f->n.complexity, six / 6 * mean_density(corner));
}

void vg_judge_metric(struct vg_point_metrics *p, struct vg_stats *f)
{
  assert(p && f);
  for (size_t i = p->first; i < p->m->n_tet; i++)
    judge_cell(p, p->m->tet[i], f);
}

/* --- report --------------------------------------------------------------- */

static double share(uint64_t part, uint64_t all)
{
  return all ? 100 * (double)part / (double)all : 0;
}

void vg_stats_report_metric(const struct vg_stats *f,
                            struct vg_metric_report *r)
{
  const struct vg_counts *n = &f->n;

  r->n_edge = n->n_length;
  r->n_cell = n->n_metric_cell;
  for (int k = 0; k < 3; k++) r->within[k] = share(n->within[k], n->n_length);
  for (int k = 0; k < 2; k++)
    r->below[k] = share(n->metric_below[k], n->n_metric_cell);
  for (int k = 0; k < VG_HIST_LENGTH; k++)
    r->hist_length[k] = (size_t)n->length[k];
  for (int k = 0; k < VG_HIST_UNIT; k++)
    r->hist_mean_ratio[k] = (size_t)n->metric_ratio[k];
  r->complexity = vg_exact_value(&n->complexity);
  r->ideal = TETS_PER_UNIT * r->complexity;
  if (n->n_length) {
    r->length_min = -f->most[VG_MOST_SHORT];
    r->length_max = f->most[VG_MOST_LONG];
  }
  if (!n->n_metric_cell) return;
  r->mean_ratio_mean = vg_exact_value(&n->sum_metric_ratio) /
                       (double)n->n_metric_cell;
  r->mean_ratio_min = -f->most[VG_MOST_DISTORTED];
}
