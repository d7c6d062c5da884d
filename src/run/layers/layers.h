/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/layers/layers.h: the layer stage of vanguard mesh, from settings to the
 * requested layers of each patch, growth, measurement and limits. Uses layers,
 * run/input/walls.h. */
#ifndef VG_RUN_LAYERS_LAYERS_H
#define VG_RUN_LAYERS_LAYERS_H

#include "layers/columns/layers.h"
#include "layers/expand/join.h"
#include "layers/measure/measure.h"
#include "layers/relax/relax.h"
#include "run/input/walls.h"

/* Layers end where cells are as thick as those of the field, for which a
 * coarser sizing field suffices (M6). */
#define VG_LAYERS_COARSENESS 4

struct vg_limit_missed {
  uint32_t patch;          /* Index in the surface. */
  const char *name, *unit; /* Name and unit of the limit; static strings. */
  int is_least;            /* 1: a lower limit; 0: an upper limit. */
  int is_bare;             /* 1: the patch has no layers, so `got` is
                              meaningless. */
  double wanted, got;      /* wanted NAN: any layers at all. */
};

/* Range of y+ relative to the request that counts as reached. */
#define VG_Y_PLUS_LOW 0.7
#define VG_Y_PLUS_HIGH 1.3

struct vg_y_plus_range {
  double min, median, max;
  double within; /* % of the points within the range above. */
};

/* y+ of the first heights on a patch, with the skin friction of first_from. */
struct vg_y_plus_patch {
  uint32_t patch; /* UINT32_MAX: the points of all patches. */
  size_t n_point; /* Number of points with layers and skin friction. */
  double wanted;  /* y_plus of the patch, times `scale` if scale_layers is set;
                     NAN for all patches. */
  struct vg_y_plus_range before, after; /* Of the heights by y_plus alone, and
                                           of those in the mesh. */
};

struct vg_layer_laws; /* Growth laws by source, private to
                         run/layers/layers.c. */

struct vg_layer_stage {
  int is_on; /* 1: layers are grown. */
  size_t n_patch;
  enum vg_wall_reason *reason;      /* [n_patch] why each patch is a wall. */
  struct vg_layer_request *request; /* [n_patch] requested layers. */
  struct vg_layer_limits *limit;    /* [n_patch] limits. */
  struct vg_layer_laws *laws;       /* NULL: laws by patch. */
  int has_shear; /* 1: laws->at has the skin friction of first_from. */
  double reynolds, length; /* 0: no y+. */
  struct vg_layer_options options;
  struct vg_layers layers;
  struct vg_layer_report report;
  struct vg_layer_judgement judgement;
  struct vg_wall_fields fields;
  size_t n_wall;                     /* Number of measured patches. */
  struct vg_patch_layers *wall, all; /* wall: [n_wall]. */
  struct vg_y_plus_patch *y_plus;    /* [n_wall + 1] as wall, then all; NULL:
                                        no first_from. */
  size_t n_missed, cap_missed;
  struct vg_limit_missed *missed;
  struct vg_join_info join;
  double *top; /* [columns.n_face] volume ratio across the top, from
                  vg_layer_slices_tops. */
  struct vg_relax_report
    relax; /* Tops lowered under flat cells of the field. */
  double time_measure, time_relax;
};
#define VG_LAYER_STAGE_INIT                                                    \
  {                                                                            \
    .is_on = 0                                                                 \
  }

void vg_layer_stage_release(struct vg_layer_stage *s);

/** 4. Decides whether layers are grown, on which patches and by which growth
 * laws, once the boundary is closed. Walls without a condition get one. Notes
 * report assumptions and missing settings. */
vg_status vg_layer_stage_plan(struct vg_layer_stage *s, struct vg_boundary *b,
                              struct vg_error *err);

/** Largest ratio of neighbouring layers by the setting `cap`: its default if
 * NAN, INFINITY if 0. */
double vg_layer_cap(double cap);

/** Adds a note on walls that get no layers because no first height is given. */
void vg_note_missing_first(const struct vg_layer_stage *s,
                           struct vg_boundary *b);

/** Adds notes on the choice of the walls and on first heights and growth. */
void vg_note_layers(const struct vg_layer_stage *s, struct vg_boundary *b);

/** Adds a note in front of all others if a first height, or the reference
 * length that determines it, is implausible for the size of the walls, which is
 * mostly a matter of units. s: planned, with options. */
void vg_note_first_heights(const struct vg_layer_stage *s,
                           struct vg_boundary *b);

/** Computes first heights and skin friction at the points of the walls of s
 * from the walls of the solution, b->read->shear. s: planned, with the requests
 * of y_plus. run/layers/first_from.c.
 *
 * @param out  empty; all points of walls. Owned by the caller, also on failure
 *
 * Patches with a first height of their own keep it. Notes say how many points
 * are too far from the walls of the solution and keep the height of y_plus.
 * VG_ERR_INPUT: all are. VG_ERR_MEMORY. */
vg_status vg_first_from(const struct vg_layer_stage *s,
                        const struct vg_boundary *b,
                        struct vg_point_heights *out, struct vg_error *err);

/** Replaces s->y_plus by the y+ of the measured first heights, s->fields, with
 * the skin friction of `at`. VG_ERR_MEMORY. */
vg_status vg_first_measure(struct vg_layer_stage *s,
                           const struct vg_mesh *surface,
                           const struct vg_point_heights *at,
                           struct vg_error *err);

/** Swaps slivers of the surface as the settings request, and makes p->resolved:
 * a run with these settings makes the same mesh. */
vg_status vg_problem_settle(struct vg_problem *p,
                            const struct vg_layer_stage *s,
                            struct vg_error *err);

/** Triangles that determine the edge length before layers grow. These are all
 * triangles, except for a VGRID front with layers: VGRID has already put the
 * points of the layers on the patches next to the walls, a thousandth of an
 * edge apart, so these patches are left out.
 * @param out  borrows points and patches of the surface, but owns tri and
 *             tri_patch: free only these */
vg_status vg_layer_stage_sizes(const struct vg_layer_stage *s,
                               const struct vg_boundary *b, struct vg_mesh *out,
                               struct vg_error *err);

/** Boundary of the field: the front above the layers, or, without layers, the
 * surface. Borrowed from both. */
static inline struct vg_mesh vg_layer_stage_front(
  const struct vg_layer_stage *s, const struct vg_mesh *surface)
{
  return s->is_on ? vg_front_mesh(&s->layers.front, surface) : *surface;
}

/** Grows, checks and measures the layers. s->layers.front bounds the remaining
 * void. VG_ERR_GEOMETRY if cells are invalid, which is a fault of the
 * program. */
vg_status vg_layer_stage_grow(struct vg_layer_stage *s,
                              const struct vg_mesh *surface,
                              const struct vg_sizing *sizing,
                              struct vg_display *show, struct vg_error *err);

/** Checks and measures the layers again, after tops were lowered. Same errors
 * as vg_layer_stage_grow. */
vg_status vg_layer_stage_relaxed(struct vg_layer_stage *s,
                                 const struct vg_mesh *surface,
                                 struct vg_error *err);

/** Steps that also need the field, once s->top is known: statistics of the
 * tops, and limits. run/layers/layer_limits.c. */
vg_status vg_layer_stage_finish(struct vg_layer_stage *s,
                                const struct vg_mesh *surface,
                                struct vg_error *err);

/** Writes the triangles of the walls with levels, heights and causes at their
 * points, and the volume ratio across their tops. */
vg_status vg_layer_stage_write(const struct vg_layer_stage *s,
                               const struct vg_mesh *surface, const char *path,
                               struct vg_error *err);

#endif
