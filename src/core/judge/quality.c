/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh check: runs the sweeps one after the other and draws the
 * conclusion. */
#include "core/mesh/copies.h"
#include "core/judge/quality.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/geometry/volume.h"
#include "core/judge/quality_solver.h"

/* The inward faces of formats.md 2.3, with reversed orientation. */
const struct vg_cell_faces vg_cell_faces[VG_CELL_KINDS] = {
  { 4, 4, 4, { { 0, 2, 1 }, { 0, 1, 3 }, { 1, 2, 3 }, { 0, 3, 2 } } },
  { 5,
    5,
    4,
    { { 0, 2, 1 }, { 1, 2, 4 }, { 2, 3, 4 }, { 0, 3, 2 }, { 0, 1, 4, 3 } } },
  { 6,
    5,
    2,
    { { 0, 2, 1 },
      { 3, 4, 5 },
      { 0, 1, 4, 3 },
      { 1, 2, 5, 4 },
      { 0, 3, 5, 2 } } },
  { 8,
    6,
    0,
    { { 0, 3, 2, 1 },
      { 4, 5, 6, 7 },
      { 0, 1, 5, 4 },
      { 1, 2, 6, 5 },
      { 2, 3, 7, 6 },
      { 0, 4, 7, 3 } } },
};

struct vg_cells vg_mesh_cells(const struct vg_mesh *m, int kind)
{
  assert(kind >= 0 && kind < VG_CELL_KINDS);
  const struct vg_cells all[VG_CELL_KINDS] = {
    { (const uint32_t *)m->tet, m->n_tet, 0 },
    { (const uint32_t *)m->pyr, m->n_pyr, m->n_tet },
    { (const uint32_t *)m->pri, m->n_pri, m->n_tet + m->n_pyr },
    { (const uint32_t *)m->hex, m->n_hex, m->n_tet + m->n_pyr + m->n_pri },
  };

  return all[kind];
}

/* The largest node is found by vectors. */
static size_t out_of_range(const uint32_t *node, size_t n, size_t n_point)
{
  size_t bad = 0;
  uint32_t most = 0;

  for (size_t i = 0; i < n; i++) most = node[i] > most ? node[i] : most;
  if (!n || most < n_point) return 0;
  for (size_t i = 0; i < n; i++) bad += node[i] >= n_point;
  return bad;
}

size_t vg_count_bad_index(const struct vg_mesh *m)
{
  size_t bad = out_of_range((const uint32_t *)m->tri, 3 * m->n_tri,
                            m->n_point) +
               out_of_range((const uint32_t *)m->quad, 4 * m->n_quad,
                            m->n_point);

  for (int kind = 0; kind < VG_CELL_KINDS; kind++) {
    struct vg_cells c = vg_mesh_cells(m, kind);
    size_t n = c.n * (size_t)vg_cell_faces[kind].n_node;

    bad += out_of_range(c.node, n, m->n_point);
  }
  return bad;
}

size_t vg_count_not_finite(size_t n, const double (*x)[3])
{
  size_t bad = 0;

  for (size_t i = 0; i < n; i++)
    bad += !isfinite(x[i][0]) || !isfinite(x[i][1]) || !isfinite(x[i][2]);
  return bad;
}

void vg_mark_used(const struct vg_mesh *m, uint8_t *used)
{
  for (int kind = 0; kind < VG_CELL_KINDS; kind++) {
    struct vg_cells c = vg_mesh_cells(m, kind);
    size_t n = c.n * (size_t)vg_cell_faces[kind].n_node;

    for (size_t i = 0; i < n; i++) used[c.node[i]] = 1;
  }
}

static vg_status count_unused(const struct vg_mesh *m, struct vg_counts *n,
                              struct vg_error *err)
{
  uint8_t *used = vg_calloc(m->n_point, 1);

  if (!used) return vg_fail_memory(err, "the points in use");
  vg_mark_used(m, used);
  for (size_t i = 0; i < m->n_point; i++) n->unused_point += !used[i];
  free(used);
  return VG_OK;
}

static int same_place(const double a[3], const double b[3])
{
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Count points that coincide with an earlier one, except on both sides of inner
 * surfaces. They are not entered in the table, so that many points at one
 * position cost little. */
static vg_status count_duplicates(const struct vg_mesh *m, struct vg_counts *n,
                                  struct vg_error *err)
{
  struct vg_table t;
  uint64_t n_copy = 0;
  vg_status st = VG_OK;

  if (vg_table_init(&t, m->n_point))
    return vg_fail_memory(err, "the table of points");
  for (size_t i = 0; i < m->n_point; i++) {
    uint32_t *at;

    VG_TABLE_FIND(&t, at, vg_hash_point(m->point[i]),
                  same_place(m->point[*at], m->point[i]));
    if (*at != VG_TABLE_FREE) n->duplicate_point++;
    else *at = (uint32_t)i;
  }
  vg_table_release(&t);
  if (n->duplicate_point) st = vg_mesh_copies(m, &n_copy, err);
  n->duplicate_point -= n_copy;
  return st;
}

/* The cones start at the centre of the box, which minimises cancellation. */
double vg_enclosed_volume(const struct vg_mesh *m, const double lo[3],
                          const double hi[3])
{
  const double(*x)[3] = (const double(*)[3])m->point;
  struct vg_exact sum = { .n_odd = 0 };
  double o[3];

  for (int k = 0; k < 3; k++) o[k] = lo[k] + (hi[k] - lo[k]) / 2;
  for (size_t i = 0; i < m->n_tri; i++) {
    const uint32_t *n = m->tri[i];

    vg_exact_add(&sum, -vg_tri_cone(o, x[n[0]], x[n[1]], x[n[2]]));
  }
  for (size_t i = 0; i < m->n_quad; i++) {
    const uint32_t *n = m->quad[i];

    vg_exact_add(&sum, -vg_quad_cone(o, x[n[0]], x[n[1]], x[n[2]], x[n[3]]));
  }
  return vg_exact_value(&sum) / 6;
}

/* Compare edges with the field; in its metric, measure cells, too. */
static vg_status judge_sizes(const struct vg_mesh *m,
                             const struct vg_sizing *sizing, int in_metric,
                             size_t n_layer, struct vg_stats *f,
                             struct vg_error *err)
{
  struct vg_point_metrics metrics;
  vg_status st;

  if (!in_metric) return vg_judge_edges(m, sizing, NULL, f, NULL, err);
  st = vg_point_metrics_init(&metrics, sizing, m, n_layer, err);
  if (st < 0) return st;
  vg_judge_metric(&metrics, f);
  st = vg_judge_edges(m, sizing, &metrics, f, NULL, err);
  vg_point_metrics_release(&metrics);
  return st;
}

static vg_status judge_all(const struct vg_mesh *m,
                           const struct vg_sizing *sizing, int has,
                           size_t n_layer, struct vg_stats *f,
                           size_t *n_component, struct vg_error *err)
{
  const uint64_t first[VG_CELL_KINDS] = { 0, m->n_tet, m->n_tet + m->n_pyr,
                                          m->n_tet + m->n_pyr + m->n_pri };
  float *volume = NULL;
  struct vg_solver_sweep *solver = vg_calloc(1, sizeof *solver);
  vg_status st;

  VG_TRY(count_unused(m, &f->n, err));
  VG_TRY(count_duplicates(m, &f->n, err));
  volume = vg_alloc(f->n.n_cell, sizeof *volume);
  if (!volume || !solver) {
    st = vg_fail_memory(err, "the volumes of the cells");
    goto done;
  }
  VG_TRY(vg_solver_begin(solver, m, first, volume, f, err));
  vg_judge_shape(m, 0, NULL, volume, f, solver);
  VG_TRY(vg_judge_faces(m, volume, f, solver, NULL, n_component, err));
  vg_solver_finish(solver, NULL);
  vg_solver_release(solver);
  free(volume);
  volume = NULL;
  if (has & VG_HAS_SIZING)
    VG_TRY(judge_sizes(m, sizing, has & VG_HAS_METRIC, n_layer, f, err));
done:
  if (solver) vg_solver_release(solver);
  free(solver);
  free(volume);
  return st;
}

static vg_status judge(const struct vg_mesh *m, const struct vg_sizing *sizing,
                       int has, size_t n_layer, struct vg_mesh_report *report,
                       struct vg_error *err)
{
  assert(m && report);

  struct vg_stats *f = vg_stats_new();
  size_t n_component = 0;
  double lo[3], hi[3];
  int sound;
  vg_status st = VG_OK;

  if (!f) return vg_fail_memory(err, "the figures of the mesh");
  f->n.n_point = m->n_point;
  f->n.n_cell = vg_mesh_n_cell(m);
  f->n.bad_index = vg_count_bad_index(m);
  f->n.not_finite = vg_count_not_finite(m->n_point,
                                        (const double(*)[3])m->point);
  /* With bad indices or coordinates no other figure is meaningful. */
  sound = !f->n.bad_index && !f->n.not_finite && f->n.n_cell;
  if (!sound) has = 0;
  if (sound) VG_TRY(judge_all(m, sizing, has, n_layer, f, &n_component, err));
  vg_stats_report(f, n_component, sound ? has | VG_HAS_SOLVER : 0, report);
  if (!sound) goto done;
  vg_mesh_bounds(m, lo, hi);
  report->enclosed = vg_enclosed_volume(m, lo, hi);
  vg_report_conclude(report);
done:
  free(f);
  return st;
}

vg_status vg_mesh_judge(const struct vg_mesh *m, const struct vg_sizing *sizing,
                        struct vg_mesh_report *report, struct vg_error *err)
{
  int has = sizing ? VG_HAS_SIZING : 0;

  if (sizing && vg_sizing_is_stretched(sizing)) has |= VG_HAS_METRIC;
  return judge(m, sizing, has, 0, report, err);
}

vg_status vg_mesh_judge_in_metric(const struct vg_mesh *m, size_t n_layer,
                                  const struct vg_sizing *sizing,
                                  struct vg_mesh_report *report,
                                  struct vg_error *err)
{
  assert(sizing && n_layer <= m->n_tet);
  return judge(m, sizing, VG_HAS_SIZING | VG_HAS_METRIC, n_layer, report, err);
}
