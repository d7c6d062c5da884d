/* run/input/layers.h: the layer stage of vanguard mesh: from settings to what
 * each patch asks for, growing, measuring, limits. Uses layers,
 * run/input/walls.h. */
#ifndef VG_RUN_INPUT_LAYERS_H
#define VG_RUN_INPUT_LAYERS_H

#include "layers/columns/layers.h"
#include "layers/expand/join.h"
#include "layers/measure/measure.h"
#include "run/input/walls.h"

/* Layers end where cells are as thick as the field's: a coarser one will do
 * (M6). */
#define VG_LAYERS_COARSENESS 4

struct vg_limit_missed {
  uint32_t patch;          /* index in the surface */
  const char *name, *unit; /* of the limit; static */
  int is_least;            /* a least value, not a largest */
  int is_bare;             /* the patch has no layers: got means nothing */
  double wanted, got;
};

struct vg_layer_laws; /* laws by source, private to run/input/layers.c */

struct vg_layer_stage {
  int is_on; /* layers are grown */
  size_t n_patch;
  enum vg_wall_reason *reason;      /* [n_patch] */
  struct vg_layer_request *request; /* [n_patch] */
  struct vg_layer_limits *limit;    /* [n_patch] */
  struct vg_layer_laws *laws;       /* NULL: by patch */
  double reynolds, length;          /* 0: no y+ */
  struct vg_layer_options options;
  struct vg_layers layers;
  struct vg_layer_report report;
  struct vg_layer_judgement judgement;
  struct vg_wall_fields fields;
  size_t n_wall;                     /* patches measured */
  struct vg_patch_layers *wall, all; /* wall: [n_wall] */
  size_t n_missed, cap_missed;
  struct vg_limit_missed *missed;
  struct vg_join_info join;
  double *top; /* [columns.n_face] volume ratio across
                  the top, of vg_layer_slices_tops */
  double time_measure;
};
#define VG_LAYER_STAGE_INIT                                                    \
  {                                                                            \
    .is_on = 0                                                                 \
  }

void vg_layer_stage_release(struct vg_layer_stage *s);

/** 4. Settle whether layers are grown, on which patches and by which laws, once
 * the boundary is closed. Walls without a condition get one. Notes tell what
 * was assumed or is missing. */
vg_status vg_layer_stage_plan(struct vg_layer_stage *s, struct vg_boundary *b,
                              struct vg_error *err);

/** Swap slivers of the surface as settings say, and make p->resolved: a run
 * with these settings makes the same mesh. */
vg_status vg_problem_settle(struct vg_problem *p,
                            const struct vg_layer_stage *s,
                            struct vg_error *err);

/** The triangles that say how large edges are before layers grow. All, but
 * for a VGRID front with layers: there VGRID has put the layers' points on
 * the patches beside the walls already, a thousandth of an edge apart, and
 * these patches are left out.
 * @param out  borrows points and patches of the surface; tri and tri_patch
 *             are its own: free them, nothing else */
vg_status vg_layer_stage_sizes(const struct vg_layer_stage *s,
                               const struct vg_boundary *b, struct vg_mesh *out,
                               struct vg_error *err);

/** What bounds the field: the front above the layers, or, without layers, the
 * surface. Borrowed from both. */
static inline struct vg_mesh vg_layer_stage_front(
  const struct vg_layer_stage *s, const struct vg_mesh *surface)
{
  return s->is_on ? vg_front_mesh(&s->layers.front, surface) : *surface;
}

/** Grow, judge and measure. s->layers.front bounds the void that is left.
 * VG_ERR_GEOMETRY when cells are wrong: a fault of the program. */
vg_status vg_layer_stage_grow(struct vg_layer_stage *s,
                              const struct vg_mesh *surface,
                              const struct vg_sizing *sizing,
                              struct vg_display *show, struct vg_error *err);

/** What needs the field too, once s->top is there: the measures of the tops;
 * limits. run/input/layer_limits.c. */
vg_status vg_layer_stage_finish(struct vg_layer_stage *s,
                                const struct vg_mesh *surface,
                                struct vg_error *err);

/** Triangles of the walls with, per point, levels, heights and causes, and
 * the volume ratio across their top. */
vg_status vg_layer_stage_write(const struct vg_layer_stage *s,
                               const struct vg_mesh *surface, const char *path,
                               struct vg_error *err);

#endif
