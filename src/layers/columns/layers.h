/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/columns/layers.h: viscous layers on the walls of a closed surface,
 * which are grown before the rest of the volume is meshed. Uses core,
 * layers/columns/columns.h.
 *
 * vg_layers_grow grows columns on the walls and returns the front above them:
 * the tops of the columns, the slide patches remeshed around their footprint,
 * and all other patches unchanged. vg_fill_front then fills the void within the
 * front, and vg_layers_join merges layers and field. */
#ifndef VG_LAYERS_COLUMNS_LAYERS_H
#define VG_LAYERS_COLUMNS_LAYERS_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/progress.h"
#include "base/stop.h"
#include "core/front/front.h"
#include "core/mesh/mesh.h"
#include "core/periodic/periodic.h"
#include "core/sizing/sizing.h"
#include "layers/columns/columns.h"

/** Requested layers of one patch. */
struct vg_layer_request {
  int is_wall; /* Grow layers on this patch. */
  struct vg_growth_law law;
  int n_max;    /* Maximum number of levels; 0: VG_LEVELS_MAX. */
  double total; /* Maximum total height; 0: no limit. */
  int n_exact;  /* 1: grow n_max levels even if the local size is reached
                   earlier. */
};

#define VG_FANS_SHARP (-1.0) /* a value of vg_layer_options.fan_angle */

struct vg_layer_options {
  const struct vg_layer_request *patch; /* [surface->n_patch] requested
                                           layers. */
  /* Growth law at a point of a wall (VGRID's grid=2); NULL: use that of the
   * patch. */
  void (*law_at)(void *user, const double x[3], struct vg_growth_law *law);
  void *law_user;
  double fan_angle;     /* Edges that turn by more than this angle, in degrees,
                           get fans. 180: no fans; 0: only at points that one
                           column cannot serve; VG_FANS_SHARP: there, and at
                           chains of sharp edges whose triangles are not
                           stretched along them. */
  double end;           /* A column ends where its next layer would be thicker
                           than this factor times the local edge length. */
  double gap;           /* Share of the distance to the opposite surface that a
                           column may take, < 0.5. */
  double slope;         /* Largest height difference of two neighbouring
                           columns, relative to the distance of their roots; >
                           0. */
  double jump;          /* Volume ratio across the tops to aim at in columns of
                           limited height, >= 1. */
  int smooth;           /* Smoothing sweeps over the directions. */
  int is_slab;          /* 1: the surface is a slab between two planes z =
                            constant, and only edges in these planes determine
                            the local edge length. */
  int threads;          /* Number of threads; 0: one per core. */
  struct vg_team *team; /* Ranks that share the work (base/team.h); NULL: this
                           rank alone. */
  struct vg_progress progress;
  struct vg_stop stop; /* Queried between rounds. */
  size_t n_periodic;
  const struct vg_periodic *periodic; /* [n_periodic] pairs of patches of the
                                         surface without layers, matched to
                                         rounding. */
};
/* L1: prisms have three times the volume of tetrahedra of the same height. */
#define VG_LAYER_END_MIXED 0.6
#define VG_LAYER_OPTIONS_INIT                                                  \
  {                                                                            \
    NULL, NULL, NULL, 0, 0.95, 0.4, 1, 1.5, 100, 0, 1, NULL, { NULL, NULL },   \
      { NULL, NULL }, 0, NULL                                                  \
  }

/* Most faces of a column from which the search for the opposite surface starts
 * rays (clear.h). */
enum { VG_AHEAD_FACES = 64 };

/** Report of vg_layers_grow. Times are wall-clock seconds. */
struct vg_layer_report {
  size_t n_wall_point, n_wall_tri, n_column, n_virtual_face;
  size_t n_cell;        /* Number of layer cells if all are tetrahedra. */
  size_t n_layer_point; /* Points above the wall, including those on side
                           faces. */
  size_t cause[VG_CAUSE_N], compressed[VG_CAUSE_N]; /* Number of columns with
                                                     each cause. */
  size_t n_round;                                   /* Rounds of lowering until
                                                       the layers were free of
                                                       collisions. */
  size_t n_many_faces; /* Columns with more than VG_AHEAD_FACES faces. */
  size_t n_slide_patch, n_slide_tri; /* Slide patches, and the number of their
                                        triangles in the front. */
  double time_topology, time_direction, time_height, time_clear, time_slide,
    time_total;
};

/* Ids of the points of the front above the layers. */
#define VG_LAYER_NEW UINT64_MAX /* New point of a remeshed patch. */

/** Id of the top of a column with at least one level. */
static inline uint64_t vg_layer_top_id(uint32_t column)
{
  return (uint64_t)1 << 32 | column;
}

/** Id of a point of the surface: not on a wall, or a root without levels. */
static inline uint64_t vg_layer_point_id(uint32_t point)
{
  return point;
}

/** Column whose top has this id, or VG_NO_INDEX. */
static inline uint32_t vg_layer_column_of(uint64_t id)
{
  return id >> 32 == 1 ? (uint32_t)id : VG_NO_INDEX;
}

/** Point of the surface with this id, or VG_NO_INDEX. */
static inline uint32_t vg_layer_point_of(uint64_t id)
{
  return id >> 32 == 0 ? (uint32_t)id : VG_NO_INDEX;
}

struct vg_layers {
  struct vg_columns columns;
  struct vg_front front;  /* Closed front of the void above the layers, with the
                             patches of the surface. Point ids as above. The id
                             of a face is the face of the columns whose top it
                             is, or VG_NO_INDEX for a triangle of a patch that
                             also bounds the final mesh. */
  struct vg_shmem common; /* Shared memory that holds the arrays if the ranks of
                             a node share them (layers/columns/share.h). */
};
#define VG_LAYERS_INIT                                                         \
  {                                                                            \
    VG_COLUMNS_INIT, VG_FRONT_INIT,                                            \
    {                                                                          \
      0                                                                        \
    }                                                                          \
  }

void vg_layers_release(struct vg_layers *l);

#endif
