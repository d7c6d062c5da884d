/* core/wrap/wrap_parts.h: the adapter of CGAL, and what its wraps become. */
#ifndef VG_CORE_WRAP_WRAP_PARTS_H
#define VG_CORE_WRAP_WRAP_PARTS_H

#include "core/wrap/wrap.h"

#ifdef __cplusplus
extern "C" {
#endif

#define VG_WRAP_CLOSED 2.5 /* S44: triangles of a wrap over area / size^2 */

/** Points and triangles of the wrap into the empty *out, which the caller
 * releases on failure too. m is sound. expected: points of the wrap, for the
 * callback of progress. */
vg_status vg_wrap_cgal(const struct vg_mesh *m, const struct vg_wrap_options *o,
                       size_t expected, struct vg_mesh *out,
                       struct vg_error *err);

/** outside: out: [n] 1 where a point lies outside the closed surface m, by the
 * parity of a ray. */
vg_status vg_wrap_outside(const struct vg_mesh *m, size_t n,
                          const double (*x)[3], const struct vg_stop *stop,
                          uint8_t *outside, struct vg_error *err);

/** count: out: [n] triangles of m that the segment from a to b meets. */
vg_status vg_wrap_crossings(const struct vg_mesh *m, size_t n,
                            const double (*a)[3], const double (*b)[3],
                            const struct vg_stop *stop, uint32_t *count,
                            struct vg_error *err);

/** The places of m nearest to n points, and their triangles; of several alike
 * the same one each time. VG_ERR_INPUT: all triangles are degenerate. */
vg_status vg_wrap_nearest(const struct vg_mesh *m, size_t n,
                          const double (*x)[3], const struct vg_stop *stop,
                          double (*foot)[3], uint32_t *tri,
                          struct vg_error *err);

/** Points onto their places, where those are no farther away than `most` and no
 * triangle folds, gets flat or meets another one. n_fit: how many. */
vg_status vg_wrap_fit(struct vg_mesh *m, const double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n_fit,
                      struct vg_error *err);

/** At an edge as sharp as a knife a wrap has an end as wide as twice its
 * offset, all of whose points have their places on the edge. Its triangles are
 * removed, so that both sides meet there. near: in: place of each point; out:
 * of those that are left, which stay where they are if it is farther than
 * `most`. n: points removed. */
vg_status vg_wrap_zip(struct vg_mesh *m, double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n,
                      struct vg_error *err);

/** Keep the triangles with stays[i] != 0 and the points that they use, in
 * order. */
vg_status vg_wrap_select(struct vg_mesh *m, const uint8_t *stays,
                         struct vg_error *err);

/** Remove the shells of a wrap that lie inside others or enclose less than
 * offset^3; r counts them. */
vg_status vg_wrap_prune(struct vg_mesh *m, const struct vg_stop *stop,
                        struct vg_wrap_report *r, struct vg_error *err);

/* A part of the input, connected by edges. */
struct vg_wrap_part {
  double area;
  double lid;           /* area that closes its rims */
  double widest, at[3]; /* width and middle of its widest rim; 0: closed */
  int is_pocket;        /* it would bound a body if its rims were closed */
};

/* The input, points within a crack's width welded, and its rims: edges with one
 * triangle. A sheet whose triangles occur twice has none. */
struct vg_wrap_rims {
  struct vg_mesh m;  /* without patches */
  uint32_t *part_of; /* [m.n_tri] */
  size_t n_part;
  struct vg_wrap_part *part;
};

/** Fill the empty *r, which the caller releases on failure too. O(n log n). */
vg_status vg_wrap_rims_find(const struct vg_mesh *m, double size,
                            struct vg_wrap_rims *r, struct vg_error *err);

void vg_wrap_rims_release(struct vg_wrap_rims *r);

/** The forecast that follows from the rims. */
struct vg_wrap_forecast vg_wrap_count(const struct vg_wrap_rims *r,
                                      double size);

/** VG_ERR_GEOMETRY where a wrap of that size certainly goes through a hole: the
 * input is one part, and a ball stands free in its widest rim. */
vg_status vg_wrap_refuse_open(const struct vg_wrap_rims *r, double size,
                              const struct vg_stop *stop, struct vg_error *err);

/** Measure `missing`, `inside` and `sheet` of the wrap `out`. VG_ERR_GEOMETRY
 * when it is a hollow shell. */
vg_status vg_wrap_compare(const struct vg_wrap_rims *rims,
                          const struct vg_mesh *out, double size,
                          const struct vg_stop *stop, struct vg_wrap_report *r,
                          struct vg_error *err);

/** Append the kept triangles of m, and their points, to its wrap.
 * VG_ERR_GEOMETRY when the wrap meets them, or when they enclose a fluid and
 * the wrap lies outside of it. */
vg_status vg_wrap_join(const struct vg_mesh *m, const uint8_t *keep,
                       const struct vg_stop *stop, struct vg_mesh *out,
                       struct vg_error *err);

#ifdef __cplusplus
}
#endif

#endif
