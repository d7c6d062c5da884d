/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The constants are bytes (M7). Data structures whose size the report of a run
 * gives have a constant each. Temporary arrays, and memory of the heap that is
 * free but not returned, are fitted to the measured peaks of the stages. */
#include "partition/model/memory_stages.h"

#include <assert.h>
#include <math.h>

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
                    slice_cell = 40, page_pictures = 12e6;

const char *vg_memory_stage_name(enum vg_memory_stage stage)
{
  static const char *const name[VG_MEMORY_STAGES] = { "surface", "sizes",
                                                      "fill", "check" };

  return name[stage];
}

void vg_memory_of_tasks(const struct vg_forecast *o, struct vg_memory_counts *c)
{
  c->largest_leaf = 0;
  c->separator_cells = o->separator_cells;
  c->n_leaf = o->n_leaf;
  for (size_t i = 0; i < o->n_node; i++)
    if (vg_forecast_is_leaf(&o->node[i]))
      c->largest_leaf = fmax(c->largest_leaf, o->node[i].cells);
}

double vg_memory_shared(const struct vg_memory_counts *c)
{
  return surface_triangle * c->triangles + layer_column * c->columns +
         leaf[c->is_stretched != 0] * c->leaves;
}

/* Until the layers are made, the first rank of a node works for all. Later the
 * ranks divide the cells of the field and the faces between slices, but not the
 * fronts and the boundary. */
void vg_memory_stages(const struct vg_memory_counts *c, int ranks, int threads,
                      double stage[VG_MEMORY_STAGES])
{
  const double busy = fmin(threads, (double)c->n_leaf);

  assert(ranks > 0 && threads > 0);
  stage[VG_MEMORY_SURFACE] = 0;
  stage[VG_MEMORY_SIZES] = check_triangle * c->triangles +
                           sizes_leaf[c->is_stretched != 0] * c->leaves +
                           sizes_column * c->columns;
  stage[VG_MEMORY_FILL] = fill_triangle * c->triangles +
                          (cell + fill_heap) * c->cells / ranks +
                          fill_cell * c->largest_leaf * busy;
  stage[VG_MEMORY_CHECK] = (number_triangle + between_triangle +
                            judge_triangle) *
                             c->triangles +
                           number_column * c->columns +
                           ((cell + judge_heap) * c->cells +
                            between_column * c->columns +
                            between_cell * c->separator_cells) /
                             ranks +
                           judge_thread * threads +
                           slice_cell * c->largest_leaf * busy +
                           (c->has_pictures ? page_pictures : 0);
}
