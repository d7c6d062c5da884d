/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/topology/topology_wall.h: the triangles of the walls and their
 * adjacency. Private to topology*.c and fan*.c. Uses core, slide.h. */
#ifndef VG_LAYERS_TOPOLOGY_TOPOLOGY_WALL_H
#define VG_LAYERS_TOPOLOGY_TOPOLOGY_WALL_H

#include <assert.h>

#include "core/mesh/edges.h"
#include "layers/slide/slide.h"

/* Half-edge 3 * face + k goes from corner k of the face to the next corner, so
 * its number also identifies the corner at which it starts. */
struct vg_wall {
  const struct vg_mesh *surface;
  size_t n_point, n_face, n_border;
  uint32_t *point;     /* [n_point] points of the surface, sorted. */
  uint32_t *tri;       /* [n_face] triangles of the surface, sorted. */
  uint32_t (*face)[3]; /* [n_face] wall points (indices into point[]). */
  uint32_t *opposite;  /* [3 * n_face] half-edge of the neighbouring wall face;
                          VG_NO_INDEX at the edge of the walls. */
  uint32_t *border;    /* [n_border] half-edges along slide patches, sorted. */
  uint32_t *border_patch; /* [n_border] slide patch of each. */
  uint32_t (*slide)[2];   /* [n_point] as vg_column.slide. */
  uint32_t *start;        /* [n_point] a corner at the point. In an open ring of
                             faces it is the corner of the first face,
                             counter-clockwise. */
  uint8_t *cause;         /* [n_point] as vg_column.cause. */
};
#define VG_WALL_INIT                                                           \
  {                                                                            \
    NULL, 0, 0, 0, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL        \
  }

void vg_wall_release(struct vg_wall *w);

/** Finds the walls; *w must be empty. Returns VG_ERR_MEMORY or
 * VG_ERR_UNSUPPORTED (too large). */
vg_status vg_wall_build(const struct vg_mesh *surface, const uint8_t *is_wall,
                        size_t n_slide, const struct vg_slide *slide,
                        struct vg_wall *w, struct vg_error *err);

/** Next corner counter-clockwise around the point of corner h. */
static inline uint32_t vg_wall_turn(const struct vg_wall *w, uint32_t h)
{
  assert(h < 3 * w->n_face);
  return w->opposite[vg_half_prev(h)];
}

#endif
