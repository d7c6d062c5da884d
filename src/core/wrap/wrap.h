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
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Distance of the wrap from the input over its size. */
#define VG_WRAP_OFFSET (1.0 / 30) /* S12 */
#define VG_WRAP_MOST 4e6          /* triangles; more are refused */

struct vg_wrap_options {
  double size;         /* > 0: the smallest gap that the wrap enters, and
                          about its longest edge, in the unit of m */
  const uint8_t *keep; /* [n_tri] 1: the triangle belongs to an outer
                          boundary, which stays as it is; NULL: all
                          triangles are wrapped */
  uint8_t *empty;      /* out: [n_patch] 1: the patch had triangles and
                          has none after the wrap; may be NULL */
  struct vg_stop stop; /* asked for every facet */
  void (*progress)(void *user, size_t done, size_t expected);
  /* points inserted, and their forecast; may be
     NULL */
  void *user; /* for progress */
};

struct vg_wrap_report {
  double offset;         /* size * VG_WRAP_OFFSET */
  size_t n_before;       /* triangles that were wrapped */
  size_t n_kept;         /* triangles of outer boundaries, as they were */
  size_t n_fit, n_point; /* points that lie on the input; all */
  size_t n_zip;          /* points removed where two sides of the wrap meet
                            in an edge of the input */
  size_t n_cavity;       /* shells removed because they lie inside the
                            wrap */
  size_t n_crumb;        /* shells removed because they enclose less than
                            offset^3 */
  size_t n_empty;        /* patches that had triangles and have none */
  double distance;       /* largest distance of the wrap from the input,
                            over its corners and the centroids of its
                            triangles */
  double at[3];          /* place of that distance */
  double missing;        /* largest distance of the input outside the wrap,
                            over its points, middles of edges and centroids
                            of pieces no longer than size */
  double missing_at[3];  /* place of that distance */
  double inside;         /* share of the input's area that lies deeper than
                            1.5 offsets inside the wrap */
  double sheet;          /* share of the other area that has fluid on both
                            sides and no thickness */
  double widest;         /* as in vg_wrap_forecast */
  double widest_at[3];   /* middle of that rim */
};

/** The cost of a wrap, and the rims of its input. */
struct vg_wrap_forecast {
  double area; /* of the triangles to wrap */
  double triangles, seconds;
  double widest;         /* width of the widest rim of a surface that would
                            bound a body if its rims were closed; 0: no
                            surface is such a one */
  double at[3];          /* middle of that rim */
  size_t n_part, n_open; /* parts connected by edges; those with rims */
};

enum vg_wrap_reason {
  VG_WRAP_FITS,  /* the surface closes at the size */
  VG_WRAP_HOLES, /* finer wraps go through its holes */
  VG_WRAP_SHEETS /* no size will do: the surface consists of sheets
                    without thickness that bound no body */
};

/** 1 when this build can wrap. */
int vg_wrap_is_built(void);

/** Put a surface around the triangles of m in their place. CGAL's points lie
 * `offset` away from them. The points move onto the input, so that its ridges,
 * knives and corners come back, unless the move makes a fold or an
 * intersection. The result is closed and points outward, no shell lies inside
 * another one, and the kept triangles follow behind the others.
 *
 * A new triangle has the patch of the old one nearest to its centroid; patches
 * keep their order, also those that are left without triangles.
 *
 * @param m  triangles only; untouched on failure. Whatever lies inside a part
 *           that is wrapped is lost
 * VG_ERR_UNSUPPORTED in a build without CGAL; VG_ERR_INPUT for a size that is
 * not positive, or so small that more than VG_WRAP_MOST would come out, no
 * triangles, quadrilaterals or cells, an index out of range; VG_ERR_GEOMETRY
 * when the wrap goes through holes and becomes a hollow shell, or when it meets
 * or leaves the kept boundary; VG_ERR_STOPPED; VG_ERR_MEMORY. One thread, about
 * 0.1 to 0.5 ms for each triangle that comes out. Re-entrant. */
vg_status vg_wrap(struct vg_mesh *m, const struct vg_wrap_options *o,
                  struct vg_wrap_report *r, struct vg_error *err);

/** The forecast of vg_wrap with the same arguments. O(n log n); fails as
 * vg_wrap does for inputs that it does not take. */
vg_status vg_wrap_foresee(const struct vg_mesh *m,
                          const struct vg_wrap_options *o,
                          struct vg_wrap_forecast *f, struct vg_error *err);

/** A size at which vg_wrap takes the surface: about 10,000 triangles, or fewer
 * where a finer wrap goes through holes. The size is tried, on a copy.
 *
 * @param stop    may be NULL
 * @param size    out: 0 for VG_WRAP_SHEETS
 * @param reason  out: what determined the size
 * Some seconds; fails as vg_wrap does for inputs that it does not take. */
vg_status vg_wrap_suggest(const struct vg_mesh *m, const struct vg_stop *stop,
                          double *size, enum vg_wrap_reason *reason,
                          struct vg_error *err);

#ifdef __cplusplus
}
#endif

#endif
