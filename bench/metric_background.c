/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Background meshes of the analytic metrics. Declared in metric_cases.h.
 *
 * A grid of hexahedra in the coordinates in which the metric is simple: x, y, z
 * or r, t, z. Lines across the layer are two sizes apart, and one is in the
 * middle of the layer, where the size has a kink. Each hexahedron consists of
 * six tetrahedra around a diagonal; those that collapse at the axis r = 0 are
 * left out. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "io/mesh/medit.h"
#include "metric_cases.h"

#define APART 2.0    /* lines, in sizes */
#define TURN 120     /* cells of a right angle: 0.75 degrees each */
#define REACH 1.4145 /* radius of the grid, a little beyond the cube's edge */
#define MOST_LINES 20000

struct lines {
  size_t n;
  double at[MOST_LINES];
};

struct grid {
  const struct metric_case *c;
  struct lines across; /* z or r */
  size_t n[3];         /* lines: across, along, and in the third direction */
  struct vg_mesh m;
};

/* Size across the layer at r or z. */
static double size_across(const struct metric_case *c, double at)
{
  const double x[3] = { c->kind == METRIC_LINEAR ? 0 : at, 0, at };
  double m[6];

  metric_case_at(c, x, m);
  return 1 / sqrt(c->kind == METRIC_LINEAR ? m[5] : m[0]);
}

/* Lines from `from` to `to`, with steps of APART sizes or a little less. */
static void add_lines(struct lines *l, const struct metric_case *c, double from,
                      double to)
{
  const int fine = 100000;
  double dx = (to - from) / fine, total = 0, sum = 0;
  size_t n, next = 1;

  for (int i = 0; i < fine; i++)
    total += fabs(dx) / (APART * size_across(c, from + (i + 0.5) * dx));
  n = (size_t)ceil(total);
  if (!l->n) l->at[l->n++] = from;
  for (int i = 0; i < fine && next < n; i++) {
    sum += fabs(dx) / (APART * size_across(c, from + (i + 0.5) * dx));
    if (sum < total * (double)next / (double)n || l->n == MOST_LINES - 1)
      continue;
    l->at[l->n++] = from + (i + 1) * dx;
    next++;
  }
  l->at[l->n++] = to;
}

static void make_lines(struct grid *g)
{
  const struct metric_case *c = g->c;
  double end = c->kind == METRIC_LINEAR ? 1 : REACH;
  double along = ceil(1 / (APART * 0.1 * c->scale));

  add_lines(&g->across, c, 0, 0.5);
  add_lines(&g->across, c, 0.5, end);
  g->n[0] = g->across.n;
  g->n[1] = c->kind == METRIC_LINEAR ? (size_t)along + 1 : TURN + 1;
  g->n[2] = (size_t)along + 1;
}

/* At the axis all lines of t meet. */
static uint32_t node(const struct grid *g, size_t i, size_t j, size_t k)
{
  if (g->c->kind != METRIC_LINEAR && !i) j = 0;
  return (uint32_t)(i + g->n[0] * (j + g->n[1] * k));
}

static void place(const struct grid *g, size_t i, size_t j, size_t k,
                  double x[3])
{
  double at = g->across.at[i], v = (double)j / (double)(g->n[1] - 1);
  double w = (double)k / (double)(g->n[2] - 1);

  if (g->c->kind == METRIC_LINEAR) {
    x[0] = v;
    x[1] = w;
    x[2] = at;
  } else {
    x[0] = at * cos(v * M_PI / 2);
    x[1] = at * sin(v * M_PI / 2);
    x[2] = w;
  }
}

static void add_cell(struct grid *g, size_t i, size_t j, size_t k)
{
  static const int path[6][2] = { { 0, 1 }, { 1, 2 }, { 2, 0 },
                                  { 0, 2 }, { 2, 1 }, { 1, 0 } };

  for (int p = 0; p < 6; p++) {
    size_t at[3] = { i, j, k };
    uint32_t *t = g->m.tet[g->m.n_tet];

    t[0] = node(g, i, j, k);
    at[path[p][0]]++;
    t[1] = node(g, at[0], at[1], at[2]);
    at[path[p][1]]++;
    t[p < 3 ? 2 : 3] = node(g, at[0], at[1], at[2]);
    t[p < 3 ? 3 : 2] = node(g, i + 1, j + 1, k + 1);
    g->m.n_tet += t[0] != t[1] && t[1] != t[2] && t[0] != t[2] &&
                  t[0] != t[3] && t[1] != t[3] && t[2] != t[3];
  }
}

/* Remove points that no cell uses. */
static vg_status compact(struct vg_mesh *m, struct vg_error *err)
{
  uint32_t *to = vg_calloc(m->n_point, sizeof *to);
  size_t n = 0;

  if (!to) return vg_fail_memory(err, "the background mesh");
  for (size_t i = 0; i < m->n_tet; i++)
    for (int k = 0; k < 4; k++) to[m->tet[i][k]] = 1;
  for (size_t p = 0; p < m->n_point; p++) {
    if (!to[p]) continue;
    memcpy(m->point[n], m->point[p], sizeof *m->point);
    to[p] = (uint32_t)n++;
  }
  for (size_t i = 0; i < m->n_tet; i++)
    for (int k = 0; k < 4; k++) m->tet[i][k] = to[m->tet[i][k]];
  m->n_point = n;
  free(to);
  return VG_OK;
}

static vg_status make_grid(struct grid *g, struct vg_error *err)
{
  const size_t *n = g->n;

  make_lines(g);
  g->m.n_point = n[0] * n[1] * n[2];
  g->m.point = vg_alloc(g->m.n_point, sizeof *g->m.point);
  g->m.tet = vg_alloc(6 * (n[0] - 1) * (n[1] - 1) * (n[2] - 1) + 1,
                      sizeof *g->m.tet);
  if (!g->m.point || !g->m.tet)
    return vg_fail_memory(err, "the background mesh");
  for (size_t k = 0; k < n[2]; k++)
    for (size_t j = 0; j < n[1]; j++)
      for (size_t i = 0; i < n[0]; i++) {
        place(g, i, j, k, g->m.point[i + n[0] * (j + n[1] * k)]);
        if (i + 1 < n[0] && j + 1 < n[1] && k + 1 < n[2]) add_cell(g, i, j, k);
      }
  return compact(&g->m, err);
}

/* Medit's components: xx, xy, yy, xz, yz, zz. */
static vg_status write_metrics(const struct grid *g, const char *path,
                               struct vg_error *err)
{
  static const int order[6] = { 0, 1, 3, 2, 4, 5 };
  FILE *f = fopen(path, "w");
  int bad;

  if (!f) return vg_fail(err, VG_ERR_IO, "%s: %s", path, strerror(errno));
  fprintf(f, "MeshVersionFormatted 2\nDimension 3\nSolAtVertices\n%zu\n1 3\n",
          g->m.n_point);
  for (size_t p = 0; p < g->m.n_point; p++) {
    double m[6];

    metric_case_at(g->c, g->m.point[p], m);
    for (int k = 0; k < 6; k++)
      fprintf(f, "%.15g%c", m[order[k]], k < 5 ? ' ' : '\n');
  }
  fprintf(f, "End\n");
  bad = ferror(f);
  if (fclose(f) || bad)
    return vg_fail(err, VG_ERR_IO, "%s: cannot write", path);
  return VG_OK;
}

vg_status metric_background(const struct metric_case *c, const char *stem,
                            struct vg_error *err)
{
  struct grid *g = vg_calloc(1, sizeof *g);
  char path[4096];
  vg_status st;

  if (!g) return vg_fail_memory(err, "the background mesh");
  g->c = c;
  VG_TRY(make_grid(g, err));
  snprintf(path, sizeof path, "%s.sol", stem);
  VG_TRY(write_metrics(g, path, err));
  snprintf(path, sizeof path, "%s.meshb", stem);
  VG_TRY(vg_medit_write(path, &g->m, err));
done:
  vg_mesh_release(&g->m);
  free(g);
  return st;
}
