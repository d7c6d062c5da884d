/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/topology/topology.h: columns, faces and boundary edges of a wall. Uses
 * core, columns.h, slide.h. */
#ifndef VG_LAYERS_TOPOLOGY_TOPOLOGY_H
#define VG_LAYERS_TOPOLOGY_TOPOLOGY_H

#include "layers/slide/slide.h"

struct vg_topology {
  uint32_t *first;      /* [n_column + 1] offsets into corner[]. */
  uint32_t *corner;     /* 3 * face + k, where face[k] is the column; real and
                           virtual faces, sorted by face. */
  uint32_t *near_first; /* [n_column + 1] offsets into near[]. */
  uint32_t *near;       /* Columns that share an edge with the column,
                           sorted. */
  uint8_t *preset;      /* [n_column] 1: the direction is given (a column inside
                           a fan, without a triangle of its own). */
};
#define VG_TOPOLOGY_INIT                                                       \
  {                                                                            \
    NULL, NULL, NULL, NULL, NULL                                               \
  }

void vg_topology_release(struct vg_topology *t);

/** Builds columns, faces, boundary edges and their adjacency from the fluid
 * sides of the surface. The members n, dir, cap and law of the columns are 0,
 * except for the unit direction of preset columns.
 *
 * The columns of a point stand in its sector (core/sides/sides.h); a doubled
 * inner surface (core/sides/inner.h) has a point for each sector. `cause` of a
 * column is VG_CAUSE_NONE, or why it cannot have levels (n must be 0):
 * VG_CAUSE_INNER: the point is on the free edge of an inner surface, or touches
 * one without layers. VG_CAUSE_SLIDE: the point has several sectors, or several
 * sheets of walls in its sector, or it touches more than two slide patches or a
 * patch that is neither a wall nor a slide patch.
 *
 * slide[] of a column contains the first two slide patches, by index, that its
 * point touches by an edge or only by the point.
 *
 * Without fans there is one column per wall point. With fans, a convex edge
 * between two wall triangles whose normals differ by more than fan_angle
 * degrees is a ridge. The ridges at a point divide its triangles into sectors.
 * Each sector has a column, and between neighbouring sectors there are enough
 * preset columns that consecutive directions differ by at most 40 degrees. A
 * point keeps one column if one direction serves it well, or if it is the end
 * of a single ridge. With a fan_angle of 0, only points at which no direction
 * sees all faces have fans. Virtual faces close the gaps along ridges and at
 * points. Where a ridge ends at a slide patch, the fan has boundary edges.
 *
 * All columns of one root should get the same levels and heights. The cells of
 * virtual faces then have positive volume as long as no column of the face is
 * 90 degrees or more from the middle of the other two. Otherwise a fan that
 * tapers onto one column makes flat or inverted cells.
 *
 * @param slide        [n_slide] from vg_slides_find
 * @param is_reversed  [surface->n_point] 1: the columns of the point are in the
 *                     reverse order around it; NULL: none
 * @param columns  in: empty; untouched on failure, as is *t
 *
 * Cost: O(points + triangles). The same input gives the same bytes. */
vg_status vg_topology_build(const struct vg_mesh *surface,
                            const uint8_t *is_wall, size_t n_slide,
                            const struct vg_slide *slide, double fan_angle,
                            const uint8_t *is_reversed,
                            struct vg_columns *columns, struct vg_topology *t,
                            struct vg_error *err);

#endif
