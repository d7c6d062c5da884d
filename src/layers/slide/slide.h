/* layers/slide/slide.h: patches that columns slide in: symmetry planes,
 * inviscid walls, tunnel walls and farfields that touch a wall. Uses core,
 * columns.h.
 *
 * A slide patch is a patch without layers that shares an edge with a wall.
 * Columns on the common edge stay in it, and the patch is re-meshed around
 * what they cover. */
#ifndef VG_LAYERS_SLIDE_SLIDE_H
#define VG_LAYERS_SLIDE_SLIDE_H

#include "core/sizing/sizing.h"
#include "layers/columns/layers.h"

struct vg_slide {
  uint32_t patch;   /* index in surface->patch */
  int is_plane;     /* its points lie in a plane */
  int axis;         /* the plane is x, y or z = at, exactly; else -1 */
  double normal[3]; /* unit, into the fluid; mean for curved patches */
  double at;        /* normal . x; with an axis the coordinate is
                       at * normal[axis], exactly */
  /* Curved patches: normals at their points, by rising point. Kept in the
   * block that vg_slides_find returns. 0: vg_slide_normal looks them up in
   * the surface, O(n_tri). */
  size_t n_vertex;
  const uint32_t *vertex; /* [n_vertex] */
  const double (*vertex_normal)[3];
};

/** Patches touched by walls, by rising patch.
 * @param is_wall  [surface->n_patch]
 * @param out      one block, owned by the caller (free); NULL when there are
 *                 none
 * A patch is plane when no point is farther from the plane than 1e-6 of its
 * extent (surfaces from CAD are noisy) and no triangle faces the other way;
 * with an axis when all coordinates are equal bit by bit. Planes normal to an
 * axis but for noise have no `axis`, but the axis as normal. O(n log n). */
vg_status vg_slides_find(const struct vg_mesh *surface, const uint8_t *is_wall,
                         size_t *n, struct vg_slide **out,
                         struct vg_error *err);

/** Normal of slide s at point p of the surface, into the fluid: the plane's,
 * or the mean of its triangles at p, weighted by angle; the patch's mean
 * where p is not on it. O(log n). */
void vg_slide_normal(const struct vg_slide *s, const struct vg_mesh *surface,
                     uint32_t p, double normal[3]);

/** Where re-meshing failed, so that columns can be lowered there. */
struct vg_slide_failure {
  size_t n;
  uint32_t *column;     /* [n] sorted, unique; owned */
  const uint8_t *never; /* [n] 1: not even its first layer fits, so that
                           only n = 0 helps; in the block of column */
  char text[200];       /* the first failure, for the report */
};

/** Build the front: tops, re-meshed slide patches, other patches.
 *
 * Boundary of a re-meshed patch: its former boundary with each border edge
 * replaced by the edge between the tops. Where a column slides in two patches
 * at once, it runs along their common curve: the points of the curve that it
 * swallows (and those closer to its top than half the local size) go, and the
 * rest of the curve is marched anew up to the next point that stays.
 * New points of a plane with an axis have its coordinate to the last bit. Of
 * a curved patch the surroundings of walls are re-meshed, as far as a few
 * edges beyond the tops, in the plane that fits them best (no triangle may be
 * tilted by more than 60 degrees against it), and lifted back onto the former
 * triangles; columns that slide in a curved patch are bent (columns->path)
 * onto it, or along the curve where they slide in two. Triangles are no finer
 * than the edges between tops near by, else as `sizing` says.
 * A patch whose border columns all have n = 0 stays as it is.
 *
 * @param columns  only bent and path change: made anew in every call
 * @param front    out: what it held is not released. Points: those of the
 *                 surface, rising; tops by rising column; new ones. Triangles:
 *                 the surface's in their order with tops in the places of
 *                 their faces, tops of virtual faces, re-meshed ones by part
 * @param failure  out: columns at which a patch could not be re-meshed (loops
 *                 that cross, normals that turn over); *front is then empty
 *                 and the return is VG_BLOCKED
 * Same bytes for the same input. Cost: about 1 us per column, 6 us per
 * triangle of a re-meshed patch. */
vg_status vg_slide_front(const struct vg_mesh *surface, size_t n_slide,
                         const struct vg_slide *slide,
                         struct vg_columns *columns,
                         const struct vg_sizing *sizing, struct vg_front *front,
                         struct vg_slide_failure *failure,
                         struct vg_error *err);

#endif
