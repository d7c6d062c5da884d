/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/copies.h: points that a mesh has more than once because it has
 * inner surfaces. Uses mesh.h. */
#ifndef VG_CORE_MESH_COPIES_H
#define VG_CORE_MESH_COPIES_H

#include "core/mesh/mesh.h"

/** 1 if a patch is part of an inner surface. */
static inline int vg_mesh_has_inner(const struct vg_mesh *m)
{
  for (size_t i = 0; i < m->n_patch; i++)
    if (m->patch[i].inner) return 1;
  return 0;
}

/** The front of patch i if this is the back of an inner surface that has one,
 * otherwise i.
 * Backs of baffles are in the order of their fronts, and so are those of
 * sheets. O(n_patch). */
size_t vg_mesh_front_patch(const struct vg_mesh *m, size_t i);

/** first[p]: for a point p with on[p], the first such point with the same
 * coordinates; for others p. [n_point] each. VG_ERR_MEMORY. */
vg_status vg_mesh_first_points(const struct vg_mesh *m, const uint8_t *on,
                               uint32_t *first, struct vg_error *err);

/** first[p]: for a point p of an inner surface, the first such point with the
 * same coordinates; for others p. Sets *first, [m->n_point], to be freed; NULL
 * if no patch is inner. VG_ERR_MEMORY. */
vg_status vg_mesh_inner_points(const struct vg_mesh *m, uint32_t **first,
                               struct vg_error *err);

/** other[t]: for a triangle of an inner surface the triangle of its other side,
 * which has the same places as corners; UINT32_MAX for others, and where layers
 * have separated the sides. first: of vg_mesh_inner_points. other: [m->n_tri].
 * VG_ERR_MEMORY. */
vg_status vg_mesh_inner_pairs(const struct vg_mesh *m, const uint32_t *first,
                              uint32_t *other, struct vg_error *err);

/** same[p]: the first of the points that are one with p in the complete mesh:
 * corners of both sides of sheets with layers (is_split). Sets *same,
 * [m->n_point], to be freed; NULL without such sheets. VG_ERR_MEMORY.
 * O(n_point + n_tri). */
vg_status vg_mesh_joined_points(const struct vg_mesh *m, uint32_t **same,
                                struct vg_error *err);

/** Count the points that have the coordinates of an earlier one, both being
 * corners of faces that lie back to back on another face: the sides of
 * an inner surface, between which there is nothing. Other points that coincide
 * are defects.
 *
 * @param m  triangles and quadrilaterals of a boundary; cells are ignored. Node
 *           indices are in range
 * @param n  out, unchanged on failure
 * O(n_point + n_tri + n_quad). VG_ERR_MEMORY. */
vg_status vg_mesh_copies(const struct vg_mesh *m, uint64_t *n,
                         struct vg_error *err);

#endif
