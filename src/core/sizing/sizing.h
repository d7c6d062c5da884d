/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing.h: target edge length (spacing) in space. Uses base and
 * core/mesh/mesh.h.
 *
 * A source with `stretch`, and a map with a metric, request spacings that
 * depend on the direction. The field is then one of metrics
 * (core/geometry/tensor.h): the intersection of those of all sources with the
 * spacing described below, limited by the growth in the metric's own directions
 * (sizing_gradation.c). The bounds of the boundary apply to the spacing in each
 * direction. The octree interpolates size tensors, with errors of a few per
 * cent of an edge. Where a thin sheet of small spacings would take more octants
 * than the mesh has points, the octants are larger, and the spacing at the
 * sheet is larger than requested, by up to the growth over half an octant.
 *
 * There are two families of sources (formats.md 1.7; deck.md, "Table
 * sources"):
 *   inverse square: VGRID's nodal and line sources,
 *     S(x) = sum(a_i S_i / r_i^2) / sum(a_i / r_i^2);
 *   bounded growth: h(d) = h0 inside the shape, h0 + (g - 1) d outside at
 *     distance d; the minimum over all sources.
 * The edges of the boundary triangulation are sources of the second family.
 * The function S = min(VGRID's mean, bounded sources) is lowered until its
 * gradient is at most (growth - 1). With spacing h_v at each point v of the
 * boundary and growth rate g, the sizing field is
 *   min( min_v(h_v + (g-1) r_v), max( S, max_v(h_v - (g-1) r_v) ) ).
 * On the boundary, the spacing is that of the boundary itself, since the cells
 * must fit it. Away from the boundary it changes at the growth rate, upwards,
 * or downwards to a source that is finer than the boundary nearby. Beyond 1.5
 * h_v it falls by 0.5 r_v if g is less than 1.5, so that sources are fully
 * effective at a distance of three lengths h_v from any face. Where the
 * spacing of the boundary itself changes faster than the growth rate, it is
 * lowered in the same way.
 *
 * Evaluation uses an octree that depends on the input only. It interpolates
 * trilinearly, with errors of a few per cent; it is continuous, and its
 * gradient is bounded by vg_sizing_slope. */
#ifndef VG_CORE_SIZING_SIZING_H
#define VG_CORE_SIZING_SIZING_H

#include <stddef.h>
#include <stdint.h>

#include "base/comm.h"
#include "core/mesh/mesh.h"

enum vg_source_kind {
  VG_SOURCE_VGRID_NODE, /* at p0; spacing h0, weight a */
  VG_SOURCE_VGRID_LINE, /* from p0 to p1; spacing h0 to h1, weight a */
  VG_SOURCE_POINT,      /* at p0; h0 within radius r0 */
  VG_SOURCE_LINE,       /* segment p0 p1; h0 to h1, within radius r0 */
  VG_SOURCE_TRIANGLE,   /* p0 p1 p2; h0 within distance r0 */
  VG_SOURCE_BOX,        /* corners p0, p1 (axis-aligned); h0 inside */
  VG_SOURCE_SPHERE,     /* centre p0, radius r0; h0 inside */
  VG_SOURCE_CYLINDER,   /* axis p0 p1, radii r0 at p0 and r1 at p1 (a cone if
                           they differ); h0 to h1 along the axis */
  VG_SOURCE_MACHCONE    /* Mach cones with apexes from p0 to p1, up to radius
                           r0; across them h0 on the axis to h1 at r0, along
                           them `stretch` times that size (sizing_cone.h) */
};

struct vg_source {
  enum vg_source_kind kind;
  double p0[3], p1[3], p2[3];
  double h0, h1;        /* spacing, length unit of the input, > 0; of a
                           stretched source, across its direction */
  double r0, r1;        /* radii, >= 0 */
  double growth;        /* growth rate of this source, > 1; 0: global rate */
  double an, bn, alpha; /* VGRID intensities; an > 0; bn, alpha as in the
                           file */
  double stretch; /* spacing along u over that across it; 0 or 1: isotropic. 1
                     in a VGRID source is the flag of the file: the spacing
                     along p is sp0 at p0 and sp1 at p1 */
  double u[3];    /* direction of stretch, of any length > 0 */
  double sp0, sp1, p[3];       /* VGRID stretching data, as in the file */
  double layer0[3], layer1[3]; /* delta1 rate1 rate2 at p0 and p1 (grid=2) */
  double mach;                 /* Mach number of Mach cones, > 1 */
  char group[32];
};

/** Additional spacings from another origin: a function of position (callback),
 * or samples (sizing_map.h). They are limited by the growth rate like sources,
 * but not scaled. */
struct vg_size_map {
  /* Returns the spacing at x, > 0; INFINITY: no requirement. Called by several
   * threads at once; the result must depend on x only. */
  double (*at)(void *user, const double x[3]);
  /* Lower bound within the box lo..hi. NULL: no bound is known; features
   * smaller than 1/32 of the domain's box are then only found where another
   * source makes the spacing small. */
  double (*least)(void *user, const double lo[3], const double hi[3]);
  /* Metric M at x (core/geometry/tensor.h), which replaces at(); positive
   * and finite, or all zero: no requirement. NULL: the map is isotropic.
   * Called as at() is. */
  void (*metric)(void *user, const double x[3], double m[6]);
  double most; /* largest spacing of the map; 0: not known */
  void *user;
};

struct vg_sizing_options {
  double h_min;         /* lower limit of the spacing; 0: no limit */
  double h_max;         /* upper limit of the spacing; INFINITY: no limit; 0:
                           if there is a surface, the largest spacing of the
                           surface and the sources, otherwise no limit */
  double growth;        /* growth rate g > 1 of neighbouring edges away from
                           the surface; default 1.2 */
  double scale;         /* factor on h_min, h_max, growth - 1, and on spacing
                           and growth - 1 of every source (VGRID's ifact).
                           Gives a similar sizing field, except for the
                           spacing of the surface */
  int from_surface;     /* 1: boundary edges are sources (default) */
  int threads;          /* 0: one per core; default 1 */
  double coarseness;    /* >= 1: factor on the size of the finest octree
                           cells; default 1 */
  struct vg_team *team; /* processes that build the field together
                           (base/team.h), or NULL */
  const struct vg_size_map *map; /* NULL: no map; borrowed for the call */
  double aspect_max;  /* largest ratio of two target edge lengths at a point, >=
                         1; larger lengths are reduced; 0: default,
                         VG_ASPECT_MAX */
  double most_points; /* a field of size tensors that requests more points in
                         its box is refused; 0: 2^36 */
};
#define VG_ASPECT_MAX 100
#define VG_SIZING_OPTIONS_INIT                                                 \
  {                                                                            \
    0, 0, 1.2, 1, 1, 1, 1, NULL, NULL, VG_ASPECT_MAX, 0                        \
  }

/** Growth rate of a sizing field that is scaled by `scale`. */
static inline double vg_scaled_growth(double growth, double scale)
{
  return 1 + scale * (growth - 1);
}

struct vg_sizing; /* opaque, read-only after vg_sizing_new */

/** Build the sizing field over the bounding box of `surface` (and of the
 * sources).
 *
 * @param surface  may be NULL or without triangles; borrowed for the call
 * @param n        number of sources; may be 0 if there is a surface
 * @param out      owned by the caller, vg_sizing_free; unchanged on failure
 *
 * Returns VG_ERR_INPUT, naming the source, for non-finite data, spacing <= 0,
 * growth <= 1; also if a map gives an invalid spacing at some point, or if
 * nothing defines a spacing. The result depends on the arguments only, bit by
 * bit, and not on threads. */
vg_status vg_sizing_new(const struct vg_sizing_options *options, size_t n,
                        const struct vg_source *source,
                        const struct vg_mesh *surface, struct vg_sizing **out,
                        struct vg_error *err);

/** Create a new field: the spacing of another field times a factor >= 1,
 * limited by the isotropic field `most`. Cost: a copy, and one evaluation of
 * `most` per corner of a leaf. VG_ERR_MEMORY. */
vg_status vg_sizing_coarsened(const struct vg_sizing *s, double factor,
                              const struct vg_sizing *most,
                              struct vg_sizing **out, struct vg_error *err);

/** Free a field; NULL is accepted. */
void vg_sizing_free(struct vg_sizing *s);

/** Share the field of the first rank of a node with all ranks of the node, as a
 * single copy if the ranks can share memory (base/comm.h). Collective over the
 * node.
 *
 * @param s  the field, or NULL on other ranks; replaced by the shared field,
 *           which has the same values bit by bit. Unchanged on failure */
vg_status vg_sizing_share(struct vg_comm *c, struct vg_sizing **s,
                          struct vg_error *err);

/** Pass all data that determine the values of the field to `look`, part by
 * part. The bytes are equal if and only if the fields are. */
void vg_sizing_show(const struct vg_sizing *s,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user);

/** Number of bytes of the field that the ranks of a node share. */
size_t vg_sizing_shmem(const struct vg_sizing *s);

/** Does the source request sizes that depend on the direction? */
int vg_source_is_stretched(const struct vg_source *s);

/** Does the field depend on the direction anywhere? If not, the functions
 * below that take a direction give the values of vg_sizing_at. */
int vg_sizing_is_stretched(const struct vg_sizing *s);

/** Stretch T = M^(1/2) of the metric at x (core/geometry/tensor.h): the
 * vector T e has the length of the edge e in the metric. Returns
 * vg_sizing_at(s, x) = det(T)^(-1/3). Threads: safe on a shared field. */
double vg_sizing_stretch_at(const struct vg_sizing *s, const double x[3],
                            double t[6]);

/** Target edge length at x along the unit vector n. */
double vg_sizing_along(const struct vg_sizing *s, const double x[3],
                       const double n[3]);

/** Size tensor H = M^(-1/2) of the metric at x (core/geometry/tensor.h). */
void vg_sizing_tensor_at(const struct vg_sizing *s, const double x[3],
                         double h[6]);

/** Distance of x from a plane with the unit normal n that has the length 1 in
 * the metric: |H n|, the extent of a cell at x across the plane. It exceeds
 * vg_sizing_along where the axes of the metric are oblique to the plane,
 * because the shortest way to the plane in the metric is not normal to it. */
double vg_sizing_across(const struct vg_sizing *s, const double x[3],
                        const double n[3]);

/** Target edge length at x, > 0. In a metric: the geometric mean of the target
 * edge lengths along its axes, so that the integral of 1 / h^3 is the
 * complexity. Outside the root cube: the value at the
 * nearest point of the cube, grown with the distance, up to h_max if it is
 * given, or up to the largest source if there are VGRID sources. Threads: safe
 * on a shared field. Cost: below 0.2 us. */
double vg_sizing_at(const struct vg_sizing *s, const double x[3]);

/** Gradient at x of the interpolated field within the octree. g out. Not if the
 * field is stretched. Threads: safe on a shared field. */
void vg_sizing_gradient_at(const struct vg_sizing *s, const double x[3],
                           double g[3]);

/** As vg_sizing_at, for n points. h out: [n]. */
void vg_sizing_eval(const struct vg_sizing *s, size_t n, const double (*x)[3],
                    double *h);

/** Smallest spacing within the cube lo, side, and a point x where it occurs.
 * For a cube outside the root cube, a lower bound and the point from which it
 * grows. Threads: safe on a shared field. Cost: a few evaluations. */
double vg_sizing_least(const struct vg_sizing *s, const double lo[3],
                       double side, double x[3]);

/** A lower bound of vg_sizing_at within the cube lo, side: the least value in
 * octants of about half its side that intersect it. Threads: safe on a shared
 * field. Cost: at most about 100 octants. */
double vg_sizing_bound(const struct vg_sizing *s, const double lo[3],
                       double side);

/** Smallest and largest value of vg_sizing_at within the root cube. Cost O(1).
 */
void vg_sizing_range(const struct vg_sizing *s, double *h_min, double *h_max);

/** Bound on the gradient of vg_sizing_at, except for errors of the octree:
 * growth - 1, or 0.5 if that is larger and sources are limited by the surface
 * somewhere. */
double vg_sizing_slope(const struct vg_sizing *s);

/** Bounds of the target edge length along any direction within the root cube,
 * and of the distance across any plane.
 * Cost O(1). */
void vg_sizing_range_along(const struct vg_sizing *s, double *h_min,
                           double *h_max);

/** As vg_sizing_slope, for the target edge length along any fixed direction, or
 * the distance across any fixed plane;
 * INFINITY if the field is stretched, since its axes may turn. */
double vg_sizing_slope_along(const struct vg_sizing *s);

/** Bounds of vg_sizing_across for n unit normals in the box lo..hi, in a
 * stretched field. They hold exactly, errors of the octree included, and are
 * narrow where sizes and axes change little within the box and half its size
 * around it.
 *
 * @param least, most  out: [n]; most is INFINITY outside of the root cube if
 *                     there is no largest size
 * Threads: safe. Cost: some evaluations. */
void vg_sizing_bounds_across(const struct vg_sizing *s, const double lo[3],
                             const double hi[3], int n,
                             const double (*normal)[3], double *least,
                             double *most);

/** The scaled value of growth - 1. */
double vg_sizing_growth(const struct vg_sizing *s);

/** Smallest spacing that a boundary edge of length h allows at distance d (see
 * the top of this file): the bound from below, 0 if no bound applies. */
double vg_sizing_below(double growth, double h, double d);

/** Longest edge for which vg_sizing_below is at most h. */
double vg_sizing_below_edge(double growth, double h, double d);

/** Number of leaves of the octree. A leaf takes 32 bytes, and 5.1 bytes of
 * tree; in a stretched field, its share of the tensors and
 * their bounds about 41 bytes more. */
size_t vg_sizing_leaves(const struct vg_sizing *s);

/** Exact spacing of the sources at x, within h_min and h_max, without octree,
 * surface or gradient limit. Cost O(n) and an allocation. INFINITY if n is 0.
 */
double vg_sizing_sources_at(const struct vg_sizing_options *options, size_t n,
                            const struct vg_source *source, const double x[3]);

#endif
