/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/model/memory_stages.h: forecast of the memory of a rank in each
 * stage of a run, from counts that are known before the fill. Uses forecast.h.
 */
#ifndef VG_PARTITION_MODEL_MEMORY_STAGES_H
#define VG_PARTITION_MODEL_MEMORY_STAGES_H

#include "partition/model/forecast.h"

/** Stages of a run whose memory is forecast. */
enum vg_memory_stage {
  VG_MEMORY_SURFACE, /* The surface is closed, completed and remeshed. */
  VG_MEMORY_SIZES,   /* The sizing field and the layers are built. */
  VG_MEMORY_FILL,
  VG_MEMORY_CHECK, /* Mesh check, during which files are written. */
  VG_MEMORY_STAGES
};

/** "surface", "sizes", "fill", "check". Static storage. */
const char *vg_memory_stage_name(enum vg_memory_stage stage);

struct vg_memory_counts {
  double triangles, columns; /* Of the front; wall points. */
  double leaves;             /* Of the octree of sizes. */
  int is_stretched;          /* 1: these have size tensors. */
  double cells;              /* Expected outside the layers. */
  double largest_leaf;       /* Cells of the largest subdomain. */
  double separator_cells;
  size_t n_leaf;    /* Subdomains. */
  int has_pictures; /* 1: the HTML report is written. */
};

/** Counts of a forecast of the tasks: subdomains and cells of separators. */
void vg_memory_of_tasks(const struct vg_forecast *o,
                        struct vg_memory_counts *c);

/** Bytes of surface, layers and sizing field, of which a node has one copy. */
double vg_memory_shared(const struct vg_memory_counts *c);

/** Bytes of the rank that needs most, beyond those of the program, of MPI, and
 * of vg_memory_shared. stage[VG_MEMORY_SURFACE]: 0, it is not forecast. */
void vg_memory_stages(const struct vg_memory_counts *c, int ranks, int threads,
                      double stage[VG_MEMORY_STAGES]);

/** Bytes that MPI needs in each rank, if there are several. */
#define VG_MEMORY_MPI 16e6 /* M7 */

#endif
