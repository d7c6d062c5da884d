/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cells of the points of a surface, before its triangles are recovered. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/delaunay/insert.h"
#include "core/geometry/hilbert.h"
#include "core/metric/metric_seeds.h"
#include "core/recover/boundary_parts.h"

/* The five tetrahedra of a box whose corners have the bits x, y, z = 1, 2, 4.
 */
static const uint32_t box_cell[5][4] = {
  { 0, 1, 2, 4 }, { 3, 2, 1, 7 }, { 5, 4, 7, 1 }, { 6, 7, 4, 2 }, { 1, 2, 4, 7 }
};

/* Axes of the box, orthonormal and right-handed. Without a metric, they are
 * those of the coordinates. In a metric, they are the eigenvectors of the mean
 * size tensor: the corners of the box are then on one sphere in the mean
 * metric, too, so that its five cells are Delaunay. The cells of the first
 * points would otherwise not be, and cavities among cells that are not Delaunay
 * leave further ones. */
static void box_axes(size_t n, const double (*x)[3],
                     const struct vg_sizing *sizing, double axis[3][3])
{
  double mean[6] = { 1, 0, 0, 1, 0, 1 }, h[6], value[3];

  for (size_t i = 0; i < n && sizing; i++) {
    vg_sizing_tensor_at(sizing, x[i], h);
    for (int k = 0; k < 6; k++) mean[k] += (h[k] - mean[k]) / (double)(i + 1);
  }
  vg_tensor_eigen(mean, value, axis);
  if (!(vg_triple(axis[0], axis[1], axis[2]) > 0))
    for (int k = 0; k < 3; k++) axis[2][k] = -axis[2][k];
}

/* sizing: NULL without a metric. */
static vg_status start_in_box(struct vg_tets *t, size_t n, const double (*x)[3],
                              const struct vg_sizing *sizing,
                              struct vg_error *err)
{
  double axis[3][3], lo[3], hi[3], side = 0;

  if (vg_tets_reserve_points(t, n + 8) || vg_tets_reserve_cells(t, 7 * n + 5))
    return vg_fail_memory(err, "boundary recovery");
  memcpy(t->x, x, n * sizeof *x);
  t->n_point = n + 8;
  box_axes(n, x, sizing, axis);
  for (int k = 0; k < 3; k++) {
    lo[k] = hi[k] = vg_dot(x[0], axis[k]);
    for (size_t i = 1; i < n; i++) {
      double at = vg_dot(x[i], axis[k]);

      if (at < lo[k]) lo[k] = at;
      if (at > hi[k]) hi[k] = at;
    }
    if (hi[k] - lo[k] > side) side = hi[k] - lo[k];
  }
  for (size_t corner = 0; corner < 8; corner++) {
    double at[3];

    for (int k = 0; k < 3; k++)
      at[k] = corner >> k & 1 ? hi[k] + side : lo[k] - side;
    for (int k = 0; k < 3; k++)
      t->x[n + corner][k] = axis[0][k] * at[0] + axis[1][k] * at[1] +
                            axis[2][k] * at[2];
  }
  for (int c = 0; c < 5; c++) {
    for (int i = 0; i < 4; i++) t->cell[c].v[i] = (uint32_t)n + box_cell[c][i];
    t->flag[c] = 0;
  }
  t->n_cell = 5;
  return vg_tets_link(t, err);
}

/* Insert point p at x, near the last one. Among cells that are Delaunay in
 * metrics, a cavity cannot always be cut back to a valid one: the point then
 * gets the cells that contain it. */
static vg_status insert(struct vg_inserter *s, uint32_t p, const double x[3],
                        uint32_t *at, struct vg_error *err)
{
  vg_status st;

  *at = vg_tets_locate(s->t, *at, x);
  st = vg_insert(s, p, *at, 0, 0, err);
  if (st == VG_BLOCKED && s->metric) {
    s->is_least = 1;
    st = vg_insert(s, p, *at, 0, 0, err);
    s->is_least = 0;
  }
  if (st == VG_BLOCKED)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "point %u (%.17g %.17g %.17g) coincides with another point; "
                   "weld the surface",
                   p + 1, x[0], x[1], x[2]);
  *at = s->last;
  return st;
}

/* --- points in the void ------------------------------------------------- */

/* Is a corner of the cell nearer to x than `nearest`, in metric m? Most points
 * are refused for that reason, before the search for their cavities. */
static int has_corner_near(const struct vg_tets *t, uint32_t cell,
                           const double x[3], const double m[6], double nearest)
{
  for (int i = 0; i < 4; i++) {
    double d[3];

    vg_sub(t->x[t->cell[cell].v[i]], x, d);
    if (vg_tensor_form(m, d) < nearest * nearest) return 1;
  }
  return 0;
}

/* Insert x if it is in the box, at the distance `nearest` from all points, and
 * in the band of the region. */
static vg_status insert_inner(struct vg_inserter *s, struct vg_metrics *metrics,
                              const struct vg_region *region, const double x[3],
                              double nearest, uint32_t *at,
                              struct vg_error *err)
{
  struct vg_point_metric m;
  vg_status st;

  if (region && !vg_region_near(region, metrics->sizing, x, VG_BAND_PLACE))
    return VG_OK;
  *at = vg_tets_locate(s->t, *at, x);
  if (*at == VG_NONE) {
    *at = s->last;
    return VG_OK;
  }
  vg_metric_at(metrics->sizing, x, &m);
  if (has_corner_near(s->t, *at, x, m.m, nearest)) return VG_OK;
  st = vg_metrics_insert(metrics, s, x, &m, *at, 0, nearest, err);
  if (st == VG_OK) *at = s->last;
  return st == VG_BLOCKED ? VG_OK : st;
}

/* Apex over a triangle. Returns 0 if the triangle has no area. */
static int find_apex(const struct vg_boundary_input *in, const uint32_t v[3],
                     double apex[3])
{
  double c[3], h[6];

  if (!vg_metric_apex(in->sizing, in->x[v[0]], in->x[v[1]], in->x[v[2]], c, h,
                      apex))
    return 0;
  vg_tensor_apply(h, apex, apex);
  for (int k = 0; k < 3; k++) apex[k] += c[k];
  return 1;
}

/* Apexes make cells near the surface that are well-shaped in the metric. */
static vg_status insert_apexes(struct vg_inserter *s,
                               struct vg_metrics *metrics,
                               const struct vg_boundary_input *in,
                               struct vg_error *err)
{
  double(*x)[3] = vg_alloc(in->n_tri, sizeof *x);
  uint32_t *order = vg_alloc(in->n_tri, sizeof *order), at = s->last;
  vg_status st = x && order ? VG_OK : vg_fail_memory(err, "boundary recovery");

  for (size_t i = 0; st == VG_OK && i < in->n_tri; i++)
    memcpy(x[i], in->x[in->tri[i][0]], sizeof *x);
  if (st == VG_OK)
    st = vg_insertion_order(in->n_tri, (const double(*)[3])x, order, err);
  for (size_t i = 0; st == VG_OK && i < in->n_tri; i++) {
    double apex[3];

    if (find_apex(in, in->tri[order[i]], apex))
      st = insert_inner(s, metrics, in->region, apex, VG_METRIC_EXCLUSION, &at,
                        err);
  }
  free(x);
  free(order);
  return st;
}

/* Insert the points of the surface and the seeds in one order, so that the
 * first insertions are local, too. Without a metric there are no seeds. In a
 * metric, cells that reach from one side of the void to the other would extend
 * across regions of different metrics. They are so thin that few flips are
 * possible among them, and later insertions do not repair their connections. */
static vg_status insert_all(struct vg_inserter *s, struct vg_metrics *metrics,
                            const struct vg_boundary_input *in,
                            const struct vg_metric_seeds *seeds,
                            struct vg_error *err)
{
  size_t n = in->n + seeds->n;
  uint32_t *order = vg_alloc(n, sizeof *order), at = 0;
  double(*x)[3] = vg_alloc(n, sizeof *x);
  vg_status st = order && x ? VG_OK : vg_fail_memory(err, "boundary recovery");

  VG_TRY(st);
  memcpy(x, in->x, in->n * sizeof *x);
  if (seeds->n) memcpy(x + in->n, seeds->x, seeds->n * sizeof *x);
  VG_TRY(vg_insertion_order(n, (const double(*)[3])x, order, err));
  for (size_t i = 0; i < n; i++) {
    const double *point = x[order[i]];

    st = order[i] < in->n
         ? insert(s, order[i], point, &at, err)
         : insert_inner(s, metrics, NULL, point, VG_SEED_DISTANCE, &at, err);
    VG_TRY(st);
  }
done:
  free(order);
  free(x);
  return st;
}

/* Seeds are sparse points throughout the void (core/metric/metric_seeds.h).
 * Apexes come last: in the same rounds as the others, they would make thin
 * cells. */
vg_status vg_boundary_cells(struct vg_tets *t,
                            const struct vg_boundary_input *in, int inner,
                            struct vg_error *err)
{
  const int is_stretched = vg_boundary_is_stretched(in);
  struct vg_inserter s = { 0 };
  struct vg_metrics metrics = { .sizing = in->sizing };
  struct vg_metric_seeds seeds = { 0 };
  vg_status st;

  VG_TRY(start_in_box(t, in->n, in->x, is_stretched ? in->sizing : NULL, err));
  VG_TRY(vg_inserter_init(&s, t, err));
  if (is_stretched && vg_metrics_add(&metrics, t, 0, t->n_point)) {
    st = vg_fail_memory(err, "boundary recovery");
    goto done;
  }
  s.metric = metrics.at;
  inner = inner && is_stretched;
  if (inner)
    VG_TRY(vg_metric_seeds(in->n, in->x, in->sizing, in->region, &seeds, err));
  VG_TRY(insert_all(&s, &metrics, in, &seeds, err));
  if (inner) VG_TRY(insert_apexes(&s, &metrics, in, err));
done:
  free(seeds.x);
  vg_metrics_release(&metrics);
  vg_inserter_release(&s);
  return st;
}
