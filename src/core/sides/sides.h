/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/sides.h: the two sides of the triangles of a surface on which any
 * number of triangles may share an edge.
 *
 * Half-face h = 2 t + s is side s of triangle t: side 0 is the one to which
 * the normal of the triangle points (right-hand rule), side 1 the other one.
 * Around an edge, triangles follow each other in radial order, and between two
 * of them lies a wedge of space to which one half-face of each looks:
 *
 *            |                 three triangles on an edge, seen along it:
 *       A    |    B            wedges A, B and C. Half-faces of different
 *     _______o_______          triangles that look into one wedge are
 *                              neighbours across the edge. At a free edge,
 *            C                 both sides of one triangle are neighbours.
 *
 * Half-faces that are neighbours belong to the same region. Their corners at
 * the ends of the common edge belong to the same sector: the part of the space
 * around a point that can be reached without crossing a triangle. A point
 * inside a sheet has two sectors, a point on its free edge one. If surfaces
 * touch in a single point, the triangles around it are not all connected by
 * edges; then such a part of the space may consist of several sectors. In the
 * same way, components of a surface that do not share an edge have regions of
 * their own. */
#ifndef VG_CORE_SIDES_SIDES_H
#define VG_CORE_SIDES_SIDES_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/mesh/edges.h"

struct vg_sides {
  size_t n_point, n_tri;
  const double (*x)[3];     /* [n_point] borrowed */
  const uint32_t (*tri)[3]; /* [n_tri] borrowed */
  struct vg_edges edge;     /* half[] of each edge in radial order, counter-
                               clockwise seen from its higher point */
  uint32_t *across;         /* [6 n_tri] for edge k (from corner k to the next
                               one) of half-face h, at 3 h + k: its neighbour g
                               and the edge l there, as 3 g + l */
  size_t n_sector, n_region;
  uint32_t *sector; /* [6 n_tri] sector of corner k of half-face h, at
                       3 h + k */
  uint32_t *region; /* [2 n_tri] region of each half-face */
  uint32_t *first;  /* [n_point + 1] */
  uint32_t *corner; /* [3 n_tri] corners 3 t + k at point p: those from
                       first[p] to first[p + 1] - 1, ascending */
};
#define VG_SIDES_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

/** The corner of half-edge h = 3 t + k on a side of triangle t: an index into
 * across[] and sector[]. */
static inline uint32_t vg_sides_corner(uint32_t h, int side)
{
  return 3 * (2 * (h / 3) + (uint32_t)side) + h % 3;
}

/** Find neighbours, sectors and regions. Sectors and regions are numbered in
 * the order of their first corners and half-faces.
 *
 * @param s       empty; stays empty on failure
 * @param x, tri  [n_point][3], [n_tri][3] triangles with three different
 *                points that are not on one line. Triangles on an edge must
 *                have different directions from it; if two have the same, the
 *                one with the lower number comes first
 *
 * O(n_point + n_tri), plus O(k^2) for an edge with k triangles. 156 bytes per
 * triangle. Same result for the same input. VG_ERR_MEMORY. */
vg_status vg_sides_build(struct vg_sides *s, size_t n_point,
                         const double (*x)[3], size_t n_tri,
                         const uint32_t (*tri)[3], struct vg_error *err);

void vg_sides_release(struct vg_sides *s);

/** Count the groups of triangles around each point that are connected by edges
 * at it. n_fan out: [n_point] 0 if no triangle has the point; more than 1 if
 * surfaces touch in it. O(n_tri). VG_ERR_MEMORY. */
vg_status vg_sides_fans(const struct vg_sides *s, uint32_t *n_fan,
                        struct vg_error *err);

/** The half-face corner, as 3 h + k, at point p whose sector contains a cell.
 *
 * @param at    points of the cell other than p, as points of the surface;
 *              UINT32_MAX: not a point of the surface
 * @param x     their coordinates
 *
 * The cell must have a volume, and no triangle may pass through it. Exact.
 * UINT32_MAX if no triangle has the point, or if the cell is so flat that the
 * rounding of coordinates leaves no point inside. Threads: re-entrant. O(k^2)
 * for a point with k triangles. */
uint32_t vg_sides_find(const struct vg_sides *s, uint32_t p,
                       const uint32_t at[3], const double *const x[3]);

#endif
