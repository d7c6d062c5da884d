/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Figures of meshes in an analytic metric. Declared in metric_cases.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/tensor.h"
#include "metric_cases.h"

static const int ends[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 },
                                { 1, 2 }, { 1, 3 }, { 2, 3 } };

struct measure {
  const struct vg_mesh *m;
  double (*metric)[6]; /* [n_point] */
  size_t *first;       /* [n_point + 1] edges by their lower point */
  uint32_t *upper;     /* their upper points */
  struct metric_figures *f;
};

static double form(const struct measure *k, const double m[6], uint32_t a,
                   uint32_t b)
{
  double e[3];

  for (int c = 0; c < 3; c++) e[c] = k->m->point[b][c] - k->m->point[a][c];
  return vg_tensor_form(m, e);
}

static void count_length(struct measure *k, uint32_t a, uint32_t b)
{
  static const double from[4] = { 0.7, M_SQRT1_2, 0.5, 0.3 };
  static const double to[4] = { 1.4, M_SQRT2, 2, 3 };
  double la = sqrt(form(k, k->metric[a], a, b));
  double lb = sqrt(form(k, k->metric[b], a, b));
  double l = fabs(la - lb) < 1e-6 * la ? (la + lb) / 2
                                       : (la - lb) / log(la / lb);

  k->f->n_edge++;
  for (int i = 0; i < 4; i++) k->f->within[i] += l >= from[i] && l <= to[i];
  k->f->shortest = fmin(k->f->shortest, l);
  k->f->longest = fmax(k->f->longest, l);
}

static int by_value(const void *a, const void *b)
{
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;

  return (p > q) - (p < q);
}

static void measure_edges(struct measure *k)
{
  const struct vg_mesh *m = k->m;

  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < m->n_tet; i++)
      for (int e = 0; e < 6; e++) {
        uint32_t a = m->tet[i][ends[e][0]], b = m->tet[i][ends[e][1]];
        uint32_t low = a < b ? a : b;

        if (pass) k->upper[k->first[low]++] = a < b ? b : a;
        else k->first[low + 1]++;
      }
    for (size_t p = 0; p < m->n_point && !pass; p++)
      k->first[p + 1] += k->first[p];
  }
  /* first[p] is now the end of p's edges */
  for (size_t p = 0, at = 0; p < m->n_point; at = k->first[p++]) {
    qsort(k->upper + at, k->first[p] - at, sizeof *k->upper, by_value);
    for (size_t i = at; i < k->first[p]; i++)
      if (i == at || k->upper[i] != k->upper[i - 1])
        count_length(k, (uint32_t)p, k->upper[i]);
  }
}

static double volume(const struct measure *k, const uint32_t v[4])
{
  double e[3][3];

  for (int i = 0; i < 3; i++)
    for (int c = 0; c < 3; c++)
      e[i][c] = k->m->point[v[i + 1]][c] - k->m->point[v[0]][c];
  return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
          e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
          e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
         6;
}

static void measure_cell(struct measure *k, const uint32_t v[4])
{
  const double *finest = k->metric[v[0]];
  double sum = 0, ratio;

  for (int i = 1; i < 4; i++)
    if (vg_tensor_det(k->metric[v[i]]) > vg_tensor_det(finest))
      finest = k->metric[v[i]];
  for (int e = 0; e < 6; e++)
    sum += form(k, finest, v[ends[e][0]], v[ends[e][1]]);
  ratio = volume(k, v) * sqrt(72 * vg_tensor_det(finest));
  ratio = ratio > 0 ? pow(ratio, 2. / 3) / (sum / 6) : 0;
  k->f->mean += ratio;
  k->f->worst = fmin(k->f->worst, ratio);
  k->f->below[0] += ratio < 0.1;
  k->f->below[1] += ratio < 0.2;
}

vg_status metric_measure(const struct metric_case *c, const struct vg_mesh *m,
                         struct metric_figures *out, struct vg_error *err)
{
  struct measure k = { .m = m, .f = out };
  vg_status st = VG_OK;

  *out = (struct metric_figures){
    .n_point = m->n_point, .n_cell = m->n_tet, .shortest = INFINITY, .worst = 1
  };
  k.metric = vg_alloc(m->n_point, sizeof *k.metric);
  k.first = vg_calloc(m->n_point + 1, sizeof *k.first);
  k.upper = vg_alloc(6 * m->n_tet, sizeof *k.upper);
  if (!k.metric || !k.first || !k.upper) {
    st = vg_fail_memory(err, "the figures");
    goto done;
  }
  for (size_t p = 0; p < m->n_point; p++)
    metric_case_at(c, m->point[p], k.metric[p]);
  measure_edges(&k);
  for (size_t i = 0; i < m->n_tet; i++) measure_cell(&k, m->tet[i]);
  /* the division comes last: 100 % is exact, and its rest is not negative */
  for (int i = 0; i < 4; i++)
    out->within[i] = 100 * out->within[i] / (double)out->n_edge;
  for (int i = 0; i < 2; i++)
    out->below[i] = 100 * out->below[i] / (double)out->n_cell;
  out->mean /= (double)out->n_cell;
done:
  free(k.metric);
  free(k.first);
  free(k.upper);
  return st;
}

void metric_head(FILE *to)
{
  fprintf(to, "| | complexity | points | cells | edges in [0.7, 1.4] | in "
              "[0.71, 1.41] | in [0.5, 2] | outside [0.3, 3] | lengths from .. "
              "to | mean ratio: mean, worst, below 0.1, below 0.2 | s |\n"
              "|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void metric_row(FILE *to, const char *name, double complexity,
                const struct metric_figures *f, double seconds)
{
  fprintf(to,
          "| %s | %.0f | %zu | %zu | %.2f %% | %.2f %% | %.2f %% | %.4f %% | "
          "%.3f .. %.2f | %.4f, %.3f, %.4f %%, %.4f %% | ",
          name, complexity, f->n_point, f->n_cell, f->within[0], f->within[1],
          f->within[2], 100 - f->within[3], f->shortest, f->longest, f->mean,
          f->worst, f->below[0], f->below[1]);
  if (seconds >= 0) fprintf(to, "%.1f |\n", seconds);
  else fprintf(to, "- |\n");
}
