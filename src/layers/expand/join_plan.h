/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/join_plan.h: numbering of the points of layers and field in the
 * mesh, and its boundary, for meshes made as a whole or in slices. Private to
 * join*.c and slices*.c. */
#ifndef VG_LAYERS_EXPAND_JOIN_PLAN_H
#define VG_LAYERS_EXPAND_JOIN_PLAN_H

#include "layers/expand/expand.h"
#include "layers/expand/join.h"

struct vg_join_plan {
  const struct vg_mesh *surface;
  const struct vg_columns *columns;
  const struct vg_front *front;
  enum vg_layer_cells cells;
  struct vg_expand expand;
  uint32_t *root; /* [surface->n_point] point of the mesh, or VG_NO_INDEX. */
  uint32_t *id;   /* [front n_point] point of the mesh. */
  /* First points of each kind: side faces, new points of remeshed patches,
   * inner points of layers, field; and the number of all points. */
  size_t first_flank, first_new, first_inner, first_field, n_point;
  struct vg_mesh boundary; /* Patches and faces; sheets. */
};

/** Checks that a mesh with these counts fills the front. VG_ERR_INPUT if it
 * does not. */
vg_status vg_join_check_field(const struct vg_front *f, uint64_t n_point,
                              uint64_t n_tri, uint64_t n_other_cell,
                              struct vg_error *err);

/** @param n_field_point  points of the field without those of the front
 *
 * Everything is borrowed until closed. After a failure there is nothing to
 * close. */
vg_status vg_join_plan_open(struct vg_join_plan *p,
                            const struct vg_mesh *surface,
                            const struct vg_layers *layers,
                            uint64_t n_field_point, enum vg_layer_cells cells,
                            int threads, struct vg_error *err);

void vg_join_plan_close(struct vg_join_plan *p);

/** Writes the points of the boundary, or of boundary and layers, to point. */
void vg_join_plan_points(const struct vg_join_plan *p, int boundary_only,
                         double (*point)[3]);

void vg_join_plan_describe(const struct vg_join_plan *p, double time,
                           struct vg_join_info *info);

/** The step of vg_join_plan_open that makes the boundary, once points are
 * numbered. */
vg_status vg_join_boundary(struct vg_join_plan *p, struct vg_error *err);

#endif
