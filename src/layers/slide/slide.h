/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/slide/slide.h: slide patches, the patches in which columns slide:
 * symmetry planes, inviscid walls, tunnel walls and farfields that touch a
 * wall. Uses core, columns.h.
 *
 * A slide patch is a patch without layers that shares an edge with a wall.
 * Columns on the shared edge stay in the patch. The area that they cover, their
 * footprint, is removed from the patch, and the remaining area is remeshed:
 *
 *     given slide patch         with layers on the wall
 *
 *     +-----+-----+-----+       +-----+-----+-----+
 *     | \   |   / | \   |       |  \  |   / | \   |
 *     |   \ | /   |   \ |       |   \ |  /  |  \  |    remeshed triangles
 *     +-----+-----+-----+       |    \| /   |   \ |
 *     | \   |   / | \   |       t-----t-----t-----t    t: tops of columns
 *     |   \ | /   |   \ |       |-----|-----|-----|    footprint: side faces
 *     r-----r-----r-----r       r-----r-----r-----r    r: roots, on the wall
 *
 * The tops are the new boundary of the patch. */
#ifndef VG_LAYERS_SLIDE_SLIDE_H
#define VG_LAYERS_SLIDE_SLIDE_H

#include "core/sizing/sizing.h"
#include "layers/columns/layers.h"
#include "layers/slide/twins.h"

struct vg_slide {
  uint32_t patch;   /* Index in surface->patch. */
  int is_plane;     /* 1: all its points lie in a plane. */
  int axis;         /* The plane is exactly x, y or z = const; otherwise -1. */
  double normal[3]; /* Unit normal into the fluid; the mean normal of a curved
                       patch. */
  double at;        /* normal . x. With an axis, the coordinate is exactly at *
                       normal[axis]. */
  /* Curved patches: normals at their points, sorted by point, in the block that
   * vg_slides_find returns. If n_vertex is 0, vg_slide_normal computes them
   * from the surface in O(n_tri). */
  size_t n_vertex;
  const uint32_t *vertex; /* [n_vertex] points of the surface. */
  const double (*vertex_normal)[3];
};

/** Finds the patches that share an edge with a wall, sorted by patch. Inner
 * surfaces are not among them: their two sides must keep the same triangles.
 * @param is_wall  [surface->n_patch]
 * @param out      one block, owned by the caller (free); NULL if n is 0
 *
 * A patch is plane if no point is farther from the plane than 1e-6 of the
 * extent of the patch (CAD surfaces are noisy) and no triangle is turned over.
 * It has an axis if all its coordinates along that axis are bitwise equal. A
 * plane that is normal to an axis except for noise has no `axis`, but the axis
 * as its normal. O(n log n). */
vg_status vg_slides_find(const struct vg_mesh *surface, const uint8_t *is_wall,
                         size_t *n, struct vg_slide **out,
                         struct vg_error *err);

/** Finds plane patches without layers over which the layers of a wall continue.
 * A column on the edge between the two cannot slide in such a patch, because
 * the wall is normal to it: a flat plate with a slip patch upstream, or a
 * window in a wall. Such a patch is plane, and at 10 % or more of its edges
 * with walls, by length, the surface turns by less than 18 degrees. Patches
 * that continue the patches found are found as well.
 * @param is_wall  [surface->n_patch]
 * @param may      [surface->n_patch] 0: patches that stay without layers
 * @param from     out: [surface->n_patch] wall from which the layers continue;
 *                 VG_NO_INDEX: none. On failure unspecified
 *
 * O(n log n) for each patch in the longest sequence of patches.
 * VG_ERR_MEMORY. */
vg_status vg_slides_extend(const struct vg_mesh *surface,
                           const uint8_t *is_wall, const uint8_t *may,
                           uint32_t *from, struct vg_error *err);

/** Normal of slide patch s at point p of the surface, into the fluid: that of
 * the plane, or the mean of the triangles of the patch at p weighted by angle.
 * The mean normal of the patch if p is not on it. O(log n). */
void vg_slide_normal(const struct vg_slide *s, const struct vg_mesh *surface,
                     uint32_t p, double normal[3]);

/** Where remeshing failed, so that columns can be lowered there. */
struct vg_slide_failure {
  size_t n;
  uint32_t *column;     /* [n] columns, sorted and unique; owned. */
  const uint8_t *never; /* [n] 1: not even the first layer fits, so the column
                           must have n = 0. In the block of column. */
  char text[200];       /* Description of the first failure, for the report. */
};

/** Builds the front: tops, remeshed slide patches and other patches.
 *
 * The boundary of a remeshed patch is its former boundary, with each edge
 * shared with a wall replaced by the edge between the tops. A column that
 * slides in two patches follows their common curve. The points of the curve
 * that it passes, and those closer to its top than half the local size, are
 * removed, and new points are placed along the curve up to the next remaining
 * point.
 *
 * New points in a plane with an axis have its coordinate to the last bit. A
 * curved patch is remeshed only around walls, up to a few edges beyond the
 * tops, in the plane that fits it best (no triangle may be inclined to it by
 * more than 60 degrees), and the new points are projected back onto the former
 * triangles. Columns that slide in a curved patch are bent (columns->path) onto
 * it, or along the curve if they slide in two patches. The target edge length
 * follows `sizing`, but is not smaller than the edges between nearby tops. A
 * patch whose columns all have n = 0 remains unchanged.
 *
 * The second patch of a periodic pair is the image of the first one: its
 * triangles, the points of its columns, and the curves that they follow.
 * Columns with twins are bent, also where they are straight, so that nothing
 * moves them later.
 *
 * @param twins    NULL: no patch is periodic. Twins must have the same number
 * of levels
 * @param columns  only bent and path change; both are recomputed in every call
 * @param front    out: previous contents are not released. Points: those of the
 *                 surface, in order; tops in the order of columns; new points.
 *                 Triangles: those of the surface in order, with tops in the
 *                 places of their faces; tops of virtual faces; remeshed
 *                 triangles by part
 * @param failure  out: columns at which a patch could not be remeshed
 *                 (intersecting loops, normals that turn over); *front is then
 *                 empty and the return value is VG_BLOCKED
 *
 * The same input gives the same bytes. Cost: about 1 us per column and 6 us per
 * triangle of a remeshed patch. */
vg_status vg_slide_front(const struct vg_mesh *surface, size_t n_slide,
                         const struct vg_slide *slide,
                         const struct vg_twins *twins,
                         struct vg_columns *columns,
                         const struct vg_sizing *sizing, struct vg_front *front,
                         struct vg_slide_failure *failure,
                         struct vg_error *err);

#endif
