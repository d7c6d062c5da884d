/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Memory of a rank in each stage of a run, from the counts of the forecast.
 *
 * The constants are bytes (M7). Data structures whose size the report of a run
 * gives have a constant each. Temporary arrays, and memory of the heap that is
 * free but not returned, are fitted to the measured peaks of the stages. */
#include <assert.h>
#include <math.h>

#include "cli/plan/plan_estimate.h"

/* MPI of every rank, if there are several. */
static const double mpi = 16e6;

/* Of every node: a triangle of the surface with its points; columns and front
 * of the layers, by wall points; a leaf of the octree of sizes, and of one with
 * size tensors. */
static const double surface_triangle = 28, layer_column = 193,
                    leaf[2] = { 37, 75 };

/* Temporary arrays of the surface check, by triangles; of the sizing field, by
 * leaves without and with tensors; of the layers, by wall points. */
static const double check_triangle = 270, sizes_leaf[2] = { 125, 235 },
                    sizes_column = 60;

/* A cell outside the layers until it is written, with its points. */
static const double cell = 13.4;

/* Fill: fronts of voids, by triangles of the first one; free memory, by cells;
 * a cell of the subdomain that a thread fills. */
static const double fill_triangle = 230, fill_heap = 7, fill_cell = 80;

/* Mesh check: numbers of points, by triangles and wall points; faces, edges
 * and points between slices, by boundary triangles, wall points and cells of
 * separators; free memory, by triangles and cells; buffers of a thread, and
 * its slice by cells; pictures of the report. */
static const double number_triangle = 14, number_column = 90;
static const double between_triangle = 142, between_column = 330,
                    between_cell = 60;
static const double judge_triangle = 60, judge_heap = 4.5, judge_thread = 12e6,
                    slice_cell = 40, pictures = 12e6;

static double largest_leaf(const struct vg_forecast *o)
{
  double most = 0;

  for (size_t i = 0; i < o->n_node; i++) {
    const struct vg_forecast_node *n = &o->node[i];

    if (vg_forecast_is_leaf(n) && n->cells > most) most = n->cells;
  }
  return most;
}

/* Bytes of the leaves of the run's octree. */
static double leaves(const struct vg_plan *p, const double bytes[2])
{
  return bytes[vg_sizing_is_stretched(p->sizing) != 0] *
         (double)vg_sizing_leaves(p->sizing) * p->finer;
}

double vg_plan_shared(const struct vg_plan *p)
{
  return surface_triangle * (double)p->front->n_tri +
         layer_column * (double)p->n_wall_point + leaves(p, leaf);
}

/* Until the layers are made, the first rank of a node works for all. The
 * forecast itself goes through the stage of the surface. Later the ranks divide
 * the cells of the field and the faces between slices, but not the fronts and
 * the boundary. */
void vg_plan_memory(const struct vg_plan *p, const struct vg_forecast *o,
                    int ranks, int threads, double stage[VG_PLAN_STAGES])
{
  const double triangles = (double)p->front->n_tri;
  const double columns = (double)p->n_wall_point;
  const double busy = fmin(threads, (double)o->n_leaf);
  const double node = p->program + (ranks > 1 ? mpi : 0) + p->shared;

  assert(ranks > 0 && threads > 0);
  stage[VG_PLAN_SURFACE] = p->surface_peak + (ranks > 1 ? mpi : 0);
  stage[VG_PLAN_SIZES] = node + check_triangle * triangles +
                         leaves(p, sizes_leaf) + sizes_column * columns;
  stage[VG_PLAN_FILL] = node + fill_triangle * triangles +
                        (cell + fill_heap) * p->load.cells / ranks +
                        fill_cell * largest_leaf(o) * busy;
  stage[VG_PLAN_CHECK] = node +
                         (number_triangle + between_triangle + judge_triangle) *
                           triangles +
                         number_column * columns +
                         ((cell + judge_heap) * p->load.cells +
                          between_column * columns +
                          between_cell * o->separator_cells) /
                           ranks +
                         judge_thread * threads +
                         slice_cell * largest_leaf(o) * busy +
                         (p->problem.resolved.settings.report_html ? pictures
                                                                   : 0);
}
