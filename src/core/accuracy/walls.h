/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/accuracy/walls.h: distance from the walls of a mesh, and its gradient.
 * Private to core/accuracy. */
#ifndef VG_CORE_ACCURACY_WALLS_H
#define VG_CORE_ACCURACY_WALLS_H

#include "core/accuracy/analytic.h"
#include "core/search/box_tree.h"

/** Triangles of the walls. A quadrilateral consists of four triangles around
 * its centre, as in core/judge/face_shape.h, so that the centre is on the wall.
 */
struct vg_wall_search {
  const struct vg_mesh *m; /* borrowed */
  size_t n, n_centre;
  double (*centre)[3];   /* [n_centre] of quadrilaterals */
  uint32_t (*tri)[3];    /* [n] points of m, then centres */
                         /* [n] */
  float (*normal)[3][3]; /* [n] unit normals of the wall at the corners */
  uint8_t *is_smooth;    /* [n] 1: they differ little from that of the
                            triangle */
  struct vg_box_tree tree;
  double least; /* smaller distances are rounding errors and become 0 */
};
#define VG_WALL_SEARCH_INIT                                                    \
  {                                                                            \
    .tree = VG_BOX_TREE_INIT                                                   \
  }

/** Prepare the search. is_wall: [n_patch]. Release also after a failure.
 * VG_ERR_MEMORY. */
vg_status vg_wall_search_open(struct vg_wall_search *s, const struct vg_mesh *m,
                              const uint8_t *is_wall, struct vg_error *err);
void vg_wall_search_release(struct vg_wall_search *s);

/** Position of a corner of a triangle. */
static inline const double *vg_wall_corner(const struct vg_wall_search *s,
                                           uint32_t v)
{
  return v < s->m->n_point ? s->m->point[v] : s->centre[v - s->m->n_point];
}

/** Distance of p->x from the nearest wall, INFINITY without walls, and its
 * gradient: the normal of the wall at the nearest point, interpolated between
 * the corners of a triangle. The normal is zero if the nearest triangle ends at
 * a sharp edge, and at positions beyond the rim of the walls. Threads: safe. */
void vg_wall_search_ask(const struct vg_wall_search *s, struct vg_place *p);

#endif
