/* layers/columns/layers.h: viscous layers on the walls of a closed surface,
 * before anything else is meshed. Uses core, layers/columns/columns.h.
 *
 * vg_layers_grow turns walls into columns and leaves the front: the tops of
 * the columns, the slide patches re-meshed around their footprint, and all
 * other patches as they were. vg_fill_front fills the void within the front;
 * vg_layers_join then puts layers and field together. */
#ifndef VG_LAYERS_COLUMNS_LAYERS_H
#define VG_LAYERS_COLUMNS_LAYERS_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "base/progress.h"
#include "base/stop.h"
#include "core/front/front.h"
#include "core/mesh/mesh.h"
#include "core/sizing/sizing.h"
#include "layers/columns/columns.h"

/** What one patch asks for. */
struct vg_layer_request {
  int is_wall; /* grow layers on it */
  struct vg_growth_law law;
  int n_max;    /* levels at most; 0: VG_LEVELS_MAX */
  double total; /* no higher than this; 0: no limit */
  int n_exact;  /* 1: n_max levels also where the local size is
                   reached earlier */
};

struct vg_layer_options {
  const struct vg_layer_request *patch; /* [surface->n_patch] */
  /* Law at a point of a wall (VGRID's grid=2), or NULL: the patch's. */
  void (*law_at)(void *user, const double x[3], struct vg_growth_law *law);
  void *law_user;
  double fan_angle;     /* edges that turn by more than this, in degrees,
                           get fans; 180: none; 0: only points that one
                           column cannot serve */
  double end;           /* a column ends where its next layer would be
                           thicker than this times the local edge */
  double gap;           /* share of the distance to the nearest surface in
                           front that a column may take, < 0.5 */
  double slope;         /* by how much two columns may differ in height, of
                           the distance of their roots; > 0 */
  int smooth;           /* sweeps over the directions */
  int threads;          /* 0: one per core */
  struct vg_team *team; /* that makes them together (base/team.h), or NULL */
  struct vg_progress progress;
  struct vg_stop stop; /* asked between rounds */
};
/* L1 */
#define VG_LAYER_OPTIONS_INIT                                                  \
  {                                                                            \
    NULL, NULL, NULL, 0, 0.95, 0.4, 2, 100, 1, NULL, { NULL, NULL },           \
    {                                                                          \
      NULL, NULL                                                               \
    }                                                                          \
  }

/** What happened. Times are wall seconds. */
/* Faces of a column that lines start from where it looks ahead (clear.h). */
enum { VG_AHEAD_FACES = 64 };

struct vg_layer_report {
  size_t n_wall_point, n_wall_tri, n_column, n_virtual_face;
  size_t n_cell;        /* layer cells if all are tetrahedra */
  size_t n_layer_point; /* points above the wall, flanks included */
  size_t cause[VG_CAUSE_N], compressed[VG_CAUSE_N]; /* columns */
  size_t n_round;      /* of lowering until clear */
  size_t n_many_faces; /* columns of more than VG_AHEAD_FACES faces */
  size_t n_slide_patch, n_slide_tri; /* patches next to walls; triangles they
                                        have in the front */
  double time_topology, time_direction, time_height, time_clear, time_slide,
    time_total;
};

/* Ids of the points of the front above layers. */
#define VG_LAYER_NEW UINT64_MAX /* a new point of a patch that was remeshed */

/** The top of a column of at least one level. */
static inline uint64_t vg_layer_top_id(uint32_t column)
{
  return (uint64_t)1 << 32 | column;
}

/** A point of the surface: off the walls, or a root without levels. */
static inline uint64_t vg_layer_point_id(uint32_t point)
{
  return point;
}

/** The column whose top it is, or VG_NO_INDEX. */
static inline uint32_t vg_layer_column_of(uint64_t id)
{
  return id >> 32 == 1 ? (uint32_t)id : VG_NO_INDEX;
}

/** The point of the surface that it is, or VG_NO_INDEX. */
static inline uint32_t vg_layer_point_of(uint64_t id)
{
  return id >> 32 == 0 ? (uint32_t)id : VG_NO_INDEX;
}

struct vg_layers {
  struct vg_columns columns;
  struct vg_front front;  /* of the void above, closed, with the patches of the
                             surface. Ids of points: above. Ids of faces: the
                             face of the columns of which it is the top, or
                             VG_NO_INDEX for a triangle of a patch that is
                             boundary of the result too */
  struct vg_shmem common; /* where the arrays are, if a node has them in
                             common (layers/columns/share.h) */
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
