/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/wrap/wrap.h: makes a closed surface around an input that cannot be
 * repaired: overlapping parts, holes, sheets, triangles without connectivity.
 *
 * CGAL's alpha wrap (Portaneri, Rouxel-Labbe, Hemmer, Cohen-Steiner, Alliez,
 * "Alpha wrapping with an offset", ACM Transactions on Graphics 41(4), 2022):
 * from outside, tetrahedra of a Delaunay triangulation are carved away as far
 * as a ball of radius `size` can pass. Points are inserted at a small distance
 * from the input. The result is therefore closed, oriented outwards and free of
 * self-intersections for any input; gaps narrower than `size` are bridged. */
#ifndef VG_CORE_WRAP_WRAP_H
#define VG_CORE_WRAP_WRAP_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

/* Distance of the wrap from the input, divided by its size. */
#define VG_WRAP_OFFSET (1.0 / 30) /* S12 */
#define VG_WRAP_MOST 4e6          /* triangles: larger wraps are refused */

struct vg_wrap_options {
  double size;         /* > 0: width of the smallest gap that the wrap enters,
                          and approximately its longest edge, in the unit of
                          m. */
  const uint8_t *keep; /* [n_tri] 1: the triangle belongs to an outer
                          boundary and is not changed; NULL: all triangles
                          are wrapped. */
  uint8_t *empty;      /* out: [n_patch] 1: the patch had triangles and has none
                          after the wrap; may be NULL. */
  size_t most;         /* Points that CGAL may insert; 0: VG_WRAP_MOST / 2. */
  struct vg_stop stop; /* Polled for every facet. */
  /* Called with the number of inserted points and its forecast; may be NULL. */
  void (*progress)(void *user, size_t done, size_t expected);
  void *user; /* Context of progress. */
};

struct vg_wrap_report {
  double offset;         /* size * VG_WRAP_OFFSET. */
  size_t n_before;       /* Triangles that were wrapped. */
  size_t n_kept;         /* Unchanged triangles of outer boundaries. */
  size_t n_fit, n_point; /* Points on the input; all points. */
  size_t n_zip;          /* Points removed where two sides of the wrap meet in a
                            sharp edge of the input. */
  size_t n_cavity;       /* Shells removed because they are inside the wrap. */
  size_t n_crumb;        /* Shells removed because they enclose less than
                            offset^3. */
  size_t n_empty;        /* Patches that had triangles and have none. */
  double distance;       /* Largest distance of the wrap from the input, over
                            its points and the centroids of its triangles. */
  double at[3];          /* Location of that distance. */
  double missing;        /* Largest distance of input outside the wrap from it,
                            over input points, edge midpoints and centroids of
                            pieces no longer than size. */
  double missing_at[3];  /* Location of that distance. */
  double inside;         /* Fraction of the area of the input that is deeper
                            than 1.5 offsets inside the wrap. */
  double sheet;          /* Fraction of the remaining area that has fluid on
                            both sides and no thickness. */
  double widest;         /* As in vg_wrap_forecast. */
  double widest_at[3];   /* Centre of that rim. */
};

/** The cost of a wrap, and the rims of its input. */
struct vg_wrap_forecast {
  double area; /* Area of the triangles to wrap. */
  double triangles, seconds;
  double widest;         /* Width of the widest rim of a part that would bound a
                            body if its rims were closed; 0: there is no such
                            part. */
  double at[3];          /* Centre of that rim. */
  size_t n_part, n_open; /* Number of parts connected by edges; number of those
                            with rims. */
};

enum vg_wrap_reason {
  VG_WRAP_FITS,  /* The surface closes at this size. */
  VG_WRAP_HOLES, /* Smaller sizes go through its holes. */
  VG_WRAP_SHEETS /* No size works: the surface consists of sheets without
                    thickness that bound no body. */
};

/** Returns 1 if the helper program vanguard-wrap, which contains CGAL, is
 * available (base/helper/helper.h). why out: otherwise the reason and a remedy;
 * may be NULL. */
int vg_wrap_is_available(char *why, size_t size);

/** Replace the triangles of m by a surface around them. CGAL places points at a
 * distance of `offset` from the triangles. The points are then moved onto the
 * input, which restores its sharp edges, edges of zero thickness and corners,
 * unless a move causes a fold or an intersection. The result is closed and
 * points outwards, and no shell is inside another one. The kept triangles come
 * last.
 *
 * A new triangle gets the patch of the input triangle nearest to its centroid.
 * Patches keep their order, including those left without triangles.
 *
 * @param m  triangles only; untouched on failure. Everything inside a wrapped
 *           part is lost
 * VG_ERR_UNSUPPORTED without vanguard-wrap; VG_ERR_INPUT for a size that is
 * not positive or would give more than VG_WRAP_MOST triangles, for an input
 * without triangles, with quadrilaterals or cells, or with an index out of
 * range; VG_ERR_GEOMETRY if the wrap goes through holes and becomes a hollow
 * shell, or intersects or leaves the kept boundary; VG_ERR_STOPPED;
 * VG_ERR_MEMORY. One thread, about 0.1 to 0.5 ms per resulting triangle.
 * Re-entrant. */
vg_status vg_wrap(struct vg_mesh *m, const struct vg_wrap_options *o,
                  struct vg_wrap_report *r, struct vg_error *err);

/** Forecast vg_wrap with the same arguments. O(n log n); returns the errors of
 * vg_wrap for invalid input. */
vg_status vg_wrap_foresee(const struct vg_mesh *m,
                          const struct vg_wrap_options *o,
                          struct vg_wrap_forecast *f, struct vg_error *err);

/** Find a point of a triangle that is farther from all others than 20 times
 * their extent, or one of two or three such points.
 *
 * @param point  out: its index
 * @param tri    out: a triangle with it
 * Returns 1, 0 without such a point, or -1 if memory is refused. O(n). */
int vg_wrap_far_point(const struct vg_mesh *m, uint32_t *point, size_t *tri);

/** Find a size at which vg_wrap succeeds: about 10,000 triangles, or fewer if
 * finer wraps go through holes. Sizes are tried on a copy, each with 15,000
 * inserted points at most (VG_ERR_INPUT: they are not enough).
 *
 * @param stop    may be NULL
 * @param size    out: 0 for VG_WRAP_SHEETS
 * @param reason  out: the criterion that determined the size
 * Takes some seconds; returns the errors of vg_wrap for invalid input. */
vg_status vg_wrap_suggest(const struct vg_mesh *m, const struct vg_stop *stop,
                          double *size, enum vg_wrap_reason *reason,
                          struct vg_error *err);

#endif
