/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/mesh/edges.h: the edges of a triangulation, with the half-edges that
 * lie on each.
 *
 * Half-edge 3 t + k runs from corner k of triangle t to the next corner. A
 * boundary edge has one half-edge, a manifold edge two, a non-manifold edge
 * more. */
#ifndef VG_CORE_MESH_EDGES_H
#define VG_CORE_MESH_EDGES_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

/** The next half-edge of the same triangle. */
static inline uint32_t vg_half_next(uint32_t h)
{
  return h % 3 == 2 ? h - 2 : h + 1;
}

/** The previous half-edge of the same triangle. */
static inline uint32_t vg_half_prev(uint32_t h)
{
  return h % 3 ? h - 1 : h + 2;
}

/** The point that a half-edge starts from. */
static inline uint32_t vg_half_from(const uint32_t (*tri)[3], uint32_t h)
{
  return tri[h / 3][h % 3];
}

/** The point that a half-edge ends at. */
static inline uint32_t vg_half_to(const uint32_t (*tri)[3], uint32_t h)
{
  return vg_half_from(tri, vg_half_next(h));
}

/* Edges, sorted by their lower node, then by their higher node. Edge i has the
 * half-edges half[start[i]] .. half[start[i + 1] - 1], in ascending order. */
struct vg_edges {
  size_t n;
  uint32_t *start;   /* [n + 1] */
  uint32_t *half;    /* [start[n]] */
  uint32_t *of_half; /* [half-edges] edge of each; UINT32_MAX for half-edges
                        of excluded triangles */
};
#define VG_EDGES_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

/** Find the edges of n_tri triangles.
 *
 * @param e      empty; stays empty on failure
 * @param tri    [n_tri][3] points below n_point; a point may repeat within a
 *               triangle
 * @param state  [n_tri] triangles with state[t] & out are excluded; NULL: all
 *               triangles are used
 *
 * O(n_point + n_tri), plus O(k log k) for a point with k edges. 16 bytes per
 * half-edge during the call, 12 afterwards. VG_ERR_MEMORY. */
vg_status vg_edges_build(struct vg_edges *e, size_t n_point, size_t n_tri,
                         const uint32_t (*tri)[3], const uint8_t *state,
                         uint8_t out, struct vg_error *err);

/** As vg_edges_build, for n_side lines between points instead of half-edges of
 * triangles: sides of other polygons, or of some triangles. */
vg_status vg_edges_build_sides(struct vg_edges *e, size_t n_point,
                               size_t n_side, const uint32_t (*side)[2],
                               struct vg_error *err);

void vg_edges_release(struct vg_edges *e);

/** Number of half-edges of edge i. */
static inline uint32_t vg_edges_count(const struct vg_edges *e, size_t i)
{
  return e->start[i + 1] - e->start[i];
}

/** The half-edges of edge i. */
static inline const uint32_t *vg_edges_at(const struct vg_edges *e, size_t i)
{
  return e->half + e->start[i];
}

/** Do the two half-edges of edge i run the same way, so that its triangles are
 * inconsistently oriented? The edge must have two half-edges. */
static inline int vg_edges_disagree(const struct vg_edges *e,
                                    const uint32_t (*tri)[3], size_t i)
{
  const uint32_t *h = vg_edges_at(e, i);

  return vg_half_from(tri, h[0]) == vg_half_from(tri, h[1]);
}

#endif
