/* core/wrap/wrap.h: a closed surface around what cannot be repaired: parts that
 * overlap, holes, sheets, triangles without connections.
 *
 * CGAL's alpha wrap (Portaneri, Rouxel-Labbe, Hemmer, Cohen-Steiner, Alliez,
 * "Alpha wrapping with an offset", ACM Transactions on Graphics 41(4), 2022):
 * from outside, tetrahedra of a Delaunay triangulation are carved away as far
 * as a ball of radius `size` can go; points come to lie on the surface at a
 * small distance from the input. So the result is closed, oriented outward and
 * free of self-intersections whatever went in; what is narrower than `size` is
 * bridged. */
#ifndef VG_CORE_WRAP_WRAP_H
#define VG_CORE_WRAP_WRAP_H

#include <stddef.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Distance of the wrap from the input over its size. */
#define VG_WRAP_OFFSET (1.0 / 30)   /* S12 */
#define VG_WRAP_MOST 4e6            /* triangles; more are refused */

struct vg_wrap_report {
  double offset;             /* size * VG_WRAP_OFFSET */
  size_t n_before;           /* triangles that went in */
  size_t n_fit, n_point;     /* points that lie on the input; all */
  size_t n_zip;              /* points taken away where two sides of the wrap
                                meet in an edge of the input */
  size_t n_empty;            /* patches that have none any more */
  double distance;           /* largest distance from the input of corners and
                                centres of the new triangles */
  double at[3];              /* where */
};

/** 1 when this build can wrap. */
int vg_wrap_is_built(void);

/** Put a surface around the triangles of m in their place. CGAL's points lie
 * `offset` away from them; they are put onto the input, so that its ridges,
 * knives and corners come back, where they can without a fold or an
 * intersection.
 *
 * A new triangle has the patch of the old one nearest to its centre; patches
 * keep their order, also those that are left without triangles.
 *
 * @param m     triangles only; bodies, seen from outside: what lies within
 *              others, or within an outer boundary, is lost. Untouched on
 *              failure
 * @param size  > 0: the smallest gap that is entered, and about the longest
 *              edge, in the unit of m
 * VG_ERR_UNSUPPORTED in a build without CGAL; VG_ERR_INPUT for a size that is
 * not positive, or so small that more than VG_WRAP_MOST would come out, no
 * triangles, quadrilaterals or cells, an index out of range; VG_ERR_GEOMETRY
 * when nothing is left (an open sheet's holes are wider than size);
 * VG_ERR_STOPPED: stop, which may be NULL, is asked for every facet;
 * VG_ERR_MEMORY. One thread, about 0.1 to 0.5 ms for each triangle that comes
 * out. Re-entrant. */
vg_status vg_wrap(struct vg_mesh *m, double size, const struct vg_stop *stop,
                  struct vg_wrap_report *r, struct vg_error *err);

#ifdef __cplusplus
}
#endif

#endif
