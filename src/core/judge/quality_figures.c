/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Figures of a mesh check: added up in any order, and converted to a report. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/judge/quality_parts.h"

/* Relative difference allowed between the volumes of the cells and of the
 * boundary: far above the rounding of the cells' volumes, far below any
 * relevant cell. */
#define VOLUME_TOLERANCE 1e-9

#define DEGREE 57.295779513082320877

struct vg_stats *vg_stats_new(void)
{
  struct vg_stats *f = vg_calloc(1, sizeof *f);

  if (!f) return NULL;
  f->angle_min = 180;
  f->radius_ratio_min = 1;
  for (int k = 0; k < VG_MOST_N; k++) f->most[k] = -INFINITY;
  return f;
}

static int is_worse(const struct vg_worst_cell *a,
                    const struct vg_worst_cell *b)
{
  return a->value < b->value || (a->value == b->value && a->cell < b->cell);
}

void vg_stats_worst(struct vg_stats *f, const struct vg_worst_cell *w)
{
  assert(f->n_worst <= VG_WORST);

  size_t i = f->n_worst;

  if (i == VG_WORST) {
    if (!is_worse(w, &f->worst[VG_WORST - 1])) return;
    i--;
  } else f->n_worst++;
  while (i && is_worse(w, &f->worst[i - 1])) {
    f->worst[i] = f->worst[i - 1];
    i--;
  }
  f->worst[i] = *w;
}

static int is_worse_place(const struct vg_worst_place *a,
                          const struct vg_worst_place *b)
{
  if (a->value != b->value) return a->value < b->value;
  if (a->cell != b->cell) return a->cell < b->cell;
  for (int k = 0; k < 2; k++)
    if (a->at[k] != b->at[k]) return a->at[k] < b->at[k];
  return a->at[2] < b->at[2];
}

void vg_places_add(struct vg_places *list, const struct vg_worst_place *p)
{
  assert(list->n <= VG_WORST);

  size_t i = list->n;

  if (i == VG_WORST) {
    if (!is_worse_place(p, &list->place[VG_WORST - 1])) return;
    i--;
  } else list->n++;
  while (i && is_worse_place(p, &list->place[i - 1])) {
    list->place[i] = list->place[i - 1];
    i--;
  }
  list->place[i] = *p;
}

void vg_stats_add(struct vg_stats *f, const struct vg_stats *more)
{
  uint64_t *to = (uint64_t *)&f->n;
  const uint64_t *from = (const uint64_t *)&more->n;

  for (size_t i = 0; i < sizeof f->n / sizeof *to; i++) to[i] += from[i];
  if (more->angle_min < f->angle_min) f->angle_min = more->angle_min;
  if (more->angle_max > f->angle_max) f->angle_max = more->angle_max;
  if (more->radius_ratio_min < f->radius_ratio_min)
    f->radius_ratio_min = more->radius_ratio_min;
  for (int k = 0; k < VG_MOST_N; k++)
    if (more->most[k] > f->most[k]) f->most[k] = more->most[k];
  for (size_t i = 0; i < more->n_worst; i++) vg_stats_worst(f, &more->worst[i]);
  for (int k = 0; k < VG_PLACES_LISTS; k++)
    for (size_t i = 0; i < more->places[k].n; i++)
      vg_places_add(&f->places[k], &more->places[k].place[i]);
}

int vg_stats_face(struct vg_stats *f, size_t n_cell, size_t n_boundary,
                  int same_side)
{
  assert(n_cell + n_boundary > 0);

  struct vg_counts *n = &f->n;

  if (!n_cell) n->orphan_boundary += n_boundary;
  else if (n_cell + n_boundary > 2) n->crowded_face++;
  else if (n_cell + n_boundary == 1) n->open_face++;
  else if (n_boundary) /* points inwards: its winding is opposite to the
                          outward face of its cell */
    n->outward_boundary += same_side;
  else {
    n->n_inner_face++;
    n->same_side_face += same_side;
    return 1;
  }
  return 0;
}

void vg_stats_edge(struct vg_stats *f, double ratio)
{
  double bin = ratio * 10;

  vg_exact_add(&f->n.sum_edge, ratio);
  f->n.n_edge++;
  f->n.edge_within += ratio >= 0.7 && ratio <= 1.5;
  f->n.edge[bin < VG_HIST_UNIT ? (size_t)bin : VG_HIST_UNIT - 1]++;
}

static void copy(size_t *to, const uint64_t *from, size_t n)
{
  for (size_t i = 0; i < n; i++) to[i] = (size_t)from[i];
}

static void report_validity(const struct vg_counts *n, struct vg_mesh_report *r)
{
  r->bad_index = n->bad_index;
  r->unused_point = n->unused_point;
  r->not_finite = n->not_finite;
  r->duplicate_point = n->duplicate_point;
  r->not_positive = n->not_positive;
  r->open_face = n->open_face;
  r->crowded_face = n->crowded_face;
  r->same_side_face = n->same_side_face;
  r->orphan_boundary = n->orphan_boundary;
  r->outward_boundary = n->outward_boundary;
  r->volume = vg_exact_value(&n->volume);
  r->n_point = n->n_point;
  r->n_cell = n->n_cell;
  r->n_inner_face = n->n_inner_face;
}

static void report_shape(const struct vg_stats *f, struct vg_mesh_report *r)
{
  const struct vg_counts *n = &f->n;
  double n_tet = (double)n->n_tet;
  uint64_t at = 0, seen = n->fine[0];

  if (!n->n_tet) return;
  r->angle_min = f->angle_min;
  r->angle_max = f->angle_max;
  r->radius_ratio_min = f->radius_ratio_min;
  for (int k = 0; k < 5; k++) r->below[k] = 100 * (double)n->below[k] / n_tet;
  for (int k = 0; k < 3; k++) r->above[k] = 100 * (double)n->above[k] / n_tet;
  r->radius_ratio_mean = vg_exact_value(&n->sum_radius) / n_tet;
  r->mean_ratio_mean = vg_exact_value(&n->sum_mean) / n_tet;
  r->edge_length = vg_exact_value(&n->sum_length) / n_tet;
  while (100 * seen < n->n_tet) seen += n->fine[++at];
  r->angle_min_p1 = (double)at / VG_FINE_PER_DEGREE;
  copy(r->hist_angle_min, n->angle_min, VG_HIST_ANGLE);
  copy(r->hist_angle_max, n->angle_max, VG_HIST_ANGLE);
  copy(r->hist_radius_ratio, n->radius_ratio, VG_HIST_UNIT);
  memcpy(r->worst, f->worst, sizeof r->worst);
  r->n_worst = f->n_worst;
}

static double ratio_at(const struct vg_counts *n, uint64_t rank)
{
  uint64_t seen = 0;

  for (uint32_t i = 0; i < VG_N_RATIO; i++) {
    uint32_t bits = VG_ONE_BITS + (i << VG_RATIO_SHIFT);
    float value;

    seen += n->ratio[i];
    if (seen < rank) continue;
    memcpy(&value, &bits, sizeof value);
    return value;
  }
  return 0;
}

static void report_ratios(const struct vg_counts *c, struct vg_mesh_report *r)
{
  uint64_t n = 0;

  for (uint32_t i = 0; i < VG_N_RATIO; i++) n += c->ratio[i];
  if (!n) return;
  r->volume_ratio[0] = ratio_at(c, n / 2 + n % 2);
  r->volume_ratio[1] = ratio_at(c, n - n / 20);
  r->volume_ratio[2] = ratio_at(c, n);
}

static void report_edges(const struct vg_counts *n, struct vg_mesh_report *r)
{
  r->has_sizing = 1;
  copy(r->hist_edge, n->edge, VG_HIST_UNIT);
  if (!n->n_edge) return;
  r->edge_mean = vg_exact_value(&n->sum_edge) / (double)n->n_edge;
  r->edge_within = 100 * (double)n->edge_within / (double)n->n_edge;
}

static void report_flat(const struct vg_counts *n, struct vg_mesh_report *r)
{
  r->has_flat = 1;
  for (int c = 0; c < VG_FLAT_CAUSES; c++)
    r->flat[c] = (struct vg_flat_count){ (size_t)n->flat[c],
                                         (size_t)n->flat_interface[c],
                                         (size_t)n->flat_spanning[c],
                                         (size_t)n->flat_needle[c] };
}

static double degrees(double cosine)
{
  return acos(cosine > 1 ? 1 : cosine < -1 ? -1 : cosine) * DEGREE;
}

static double fixed_mean(uint64_t sum, uint64_t n)
{
  return n ? (double)(int64_t)sum / VG_FIXED / (double)n : 0;
}

static void report_places(const struct vg_stats *f, struct vg_solver_quality *q)
{
  for (int k = 0; k < VG_WORST_LISTS; k++) {
    const struct vg_places *list = &f->places[k];

    q->n_worst[k] = list->n;
    memcpy(q->worst[k], list->place, sizeof list->place);
    for (size_t i = 0; i < list->n; i++) {
      double *value = &q->worst[k][i].value;

      if (k == VG_WORST_ANGLE) *value = degrees(*value);
      if (k == VG_WORST_SKEWNESS) *value = -*value;
    }
  }
}

void vg_stats_report_solver(const struct vg_stats *f,
                            struct vg_solver_quality *q)
{
  const struct vg_counts *n = &f->n;

  q->n_face = (size_t)n->n_joined;
  q->n_boundary_face = (size_t)n->n_border;
  q->weight_min = 0.5;
  q->volume_ratio_min = 1;
  if (n->n_joined) {
    q->angle_max = degrees(-f->most[VG_MOST_OBLIQUE]);
    q->angle_mean = degrees(fixed_mean(n->sum_cosine, n->n_joined));
    q->weight_min = -f->most[VG_MOST_LOPSIDED];
    q->volume_ratio_min = -f->most[VG_MOST_UNEQUAL];
  }
  for (int i = (int)(VG_LIMIT_ANGLE / 5); i < VG_HIST_ANGLE; i++)
    q->n_angle += (size_t)n->solver_angle[i];
  for (int i = (int)(VG_LIMIT_SKEWNESS * 4); i < VG_HIST_SKEW; i++)
    q->n_skewness += (size_t)n->skewness[i];
  q->n_weight = (size_t)n->n_weight;
  q->n_volume_ratio = (size_t)n->n_volume_ratio;
  q->n_determinant = (size_t)n->n_determinant;
  if (n->n_joined + n->n_border) q->skewness_max = f->most[VG_MOST_SKEWED];
  q->determinant_min = -f->most[VG_MOST_SINGULAR];
  q->quality_min = -f->most[VG_MOST_SLANTED];
  q->quality_mean = fixed_mean(n->sum_quality, n->n_cell);
  copy(q->hist_angle, n->solver_angle, VG_HIST_ANGLE);
  copy(q->hist_skewness, n->skewness, VG_HIST_SKEW);
  copy(q->hist_quality, n->quality, VG_HIST_UNIT);
  report_places(f, q);
}

void vg_stats_report_dual(const struct vg_stats *f, struct vg_dual_quality *q)
{
  const struct vg_counts *n = &f->n;
  const struct vg_places *list = &f->places[VG_PLACES_DUAL];

  q->n_face = (size_t)n->n_dual_face;
  q->n_point = (size_t)n->n_dual_point;
  q->n_opposed = (size_t)n->n_dual_opposed;
  for (int i = 0; i < 3; i++)
    q->below[i] = n->n_dual_point
                  ? 100 * (double)n->dual_below[i] / (double)n->n_dual_point
                  : 0;
  for (int k = 0; k < VG_WORST_DUAL_LISTS; k++) {
    q->n_worst[k] = list[k].n;
    memcpy(q->worst[k], list[k].place, sizeof list[k].place);
  }
  for (size_t i = 0; i < list[VG_WORST_DUAL_VOLUME].n; i++)
    q->worst[VG_WORST_DUAL_VOLUME][i].value *= -1;
  q->volume_ratio_max = q->worst[VG_WORST_DUAL_VOLUME][0].value;
  q->point_min = q->worst[VG_WORST_DUAL_POINT][0].value;
  q->face_min = q->worst[VG_WORST_DUAL_FACE][0].value;
}

void vg_stats_report(const struct vg_stats *f, size_t n_component, int has,
                     struct vg_mesh_report *r)
{
  memset(r, 0, sizeof *r);
  report_validity(&f->n, r);
  report_shape(f, r);
  report_ratios(&f->n, r);
  if (has & VG_HAS_SIZING) report_edges(&f->n, r);
  if (has & VG_HAS_FLAT) report_flat(&f->n, r);
  r->has_metric = has & VG_HAS_METRIC ? 1 : 0;
  if (r->has_metric) vg_stats_report_metric(f, &r->metric);
  r->has_solver = has & VG_HAS_SOLVER && f->n.n_cell;
  if (r->has_solver) vg_stats_report_solver(f, &r->solver);
  r->has_dual = has & VG_HAS_DUAL && f->n.n_dual_point;
  if (r->has_dual) vg_stats_report_dual(f, &r->dual);
  r->n_component = n_component;
}

void vg_report_conclude(struct vg_mesh_report *r)
{
  double scale = fabs(r->enclosed);

  if (fabs(r->volume) > scale) scale = fabs(r->volume);
  /* NaN counts as a difference, too */
  r->volume_error = scale != 0 ? fabs(r->volume - r->enclosed) / scale : 0;
  r->is_valid = r->n_cell && !r->unused_point && !r->duplicate_point &&
                !r->not_positive && !r->open_face && !r->crowded_face &&
                !r->same_side_face && !r->orphan_boundary &&
                !r->outward_boundary && r->volume_error < VOLUME_TOLERANCE;
  if (r->is_valid) return;
  r->has_solver = r->has_dual = 0;
  memset(&r->solver, 0, sizeof r->solver);
  memset(&r->dual, 0, sizeof r->dual);
}
