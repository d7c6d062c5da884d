/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/wrap/wrap_parts.h: the requests to vanguard-wrap, and the steps that
 * follow it. */
#ifndef VG_CORE_WRAP_WRAP_PARTS_H
#define VG_CORE_WRAP_WRAP_PARTS_H

#include "base/helper/link.h"
#include "core/wrap/wrap.h"

#define VG_WRAP_CLOSED 2.5 /* S44: triangles of a wrap over area / size^2 */

/** Store points and triangles of the wrap in the empty *out, which the caller
 * releases, also on failure.
 *
 * @param m         a valid input
 * @param expected  expected number of points, for the progress callback */
vg_status vg_wrap_cgal(const struct vg_mesh *m, const struct vg_wrap_options *o,
                       size_t expected, struct vg_mesh *out,
                       struct vg_error *err);

/** Receive a wrap from vanguard-wrap, for which the head of the message was
 * received. VG_BLOCKED: the transfer failed; the link has the reason. */
vg_status vg_wrap_receive_surface(struct vg_link *l, uint64_t n_point,
                                  uint64_t n_tri, struct vg_mesh *out,
                                  struct vg_error *err);

/** Unite closed shells without common points that point outwards, or subtract
 * all others from the first.
 *
 * @param out   empty; released by the caller, also on failure
 * @param from  out: [out->n_tri] triangle of m; free() it
 * VG_BLOCKED: the surface of the union is not a manifold. */
vg_status vg_wrap_unite(const struct vg_mesh *m, int subtracts,
                        const struct vg_stop *stop, struct vg_mesh *out,
                        uint32_t **from, struct vg_error *err);

/** Divide surfaces without common points along the curves on which they meet.
 *
 * @param n_wall  the first triangles, which are one surface; each other set of
 *                triangles connected by points is one
 * @param out, from  as for vg_wrap_unite; the parts of walls come first
 * VG_BLOCKED: a surface is not a manifold. */
vg_status vg_wrap_imprint(const struct vg_mesh *m, size_t n_wall,
                          const struct vg_stop *stop, struct vg_mesh *out,
                          uint32_t **from, struct vg_error *err);

/** Classify points as inside or outside the closed surface m by the parity of a
 * ray.
 *
 * @param outside  out: [n] 1: outside */
vg_status vg_wrap_outside(const struct vg_mesh *m, size_t n,
                          const double (*x)[3], const struct vg_stop *stop,
                          uint8_t *outside, struct vg_error *err);

/** Count the triangles of m crossed by segments from a to b.
 *
 * @param count  out: [n] */
vg_status vg_wrap_crossings(const struct vg_mesh *m, size_t n,
                            const double (*a)[3], const double (*b)[3],
                            const struct vg_stop *stop, uint32_t *count,
                            struct vg_error *err);

/** Find the points of m nearest to n points, and their triangles; of several
 * nearest triangles it is the same one each time. VG_ERR_INPUT: all triangles
 * are degenerate. */
vg_status vg_wrap_nearest(const struct vg_mesh *m, size_t n,
                          const double (*x)[3], const struct vg_stop *stop,
                          double (*foot)[3], uint32_t *tri,
                          struct vg_error *err);

/** Move points to their targets `near`, if these are within `most` and no
 * triangle folds, becomes flat or intersects another one.
 *
 * @param n_fit  out: number of moved points */
vg_status vg_wrap_fit(struct vg_mesh *m, const double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n_fit,
                      struct vg_error *err);

/** Close the ends of a wrap. At a sharp edge of zero thickness a wrap has an
 * end twice its offset wide, whose points all have their targets on the edge.
 * The triangles of the end are removed, so that both sides meet there.
 *
 * @param near  in: target of each point; out: of the remaining points. Targets
 *              farther than `most` are replaced by the points themselves
 * @param n     out: number of removed points */
vg_status vg_wrap_zip(struct vg_mesh *m, double (*near)[3], double most,
                      const struct vg_stop *stop, size_t *n,
                      struct vg_error *err);

/** Keep the triangles with stays[i] != 0 and their points, in order. */
vg_status vg_wrap_select(struct vg_mesh *m, const uint8_t *stays,
                         struct vg_error *err);

/** Remove the shells of a wrap that are inside others or enclose less than
 * offset^3, and count them in r. */
vg_status vg_wrap_prune(struct vg_mesh *m, const struct vg_stop *stop,
                        struct vg_wrap_report *r, struct vg_error *err);

/* A part of the input, connected by edges. */
struct vg_wrap_part {
  double area;
  double lid;           /* Area of the lids that would close its rims. */
  double widest, at[3]; /* Width and centre of its widest rim; 0: the part is
                           closed. */
  int is_pocket;        /* 1: it would bound a body if its rims were closed. */
};

/* The input after points within the width of a crack were welded, and its rims:
 * edges with one triangle. A sheet whose triangles occur twice has no rims. */
struct vg_wrap_rims {
  struct vg_mesh m;  /* Without patches. */
  uint32_t *part_of; /* [m.n_tri] Part of each triangle. */
  size_t n_part;
  struct vg_wrap_part *part;
};

/** Fill the empty *r, which the caller releases, also on failure. O(n log
 * n). */
vg_status vg_wrap_rims_find(const struct vg_mesh *m, double size,
                            struct vg_wrap_rims *r, struct vg_error *err);

void vg_wrap_rims_release(struct vg_wrap_rims *r);

/** Forecast from the rims. */
struct vg_wrap_forecast vg_wrap_count(const struct vg_wrap_rims *r,
                                      double size);

/** VG_ERR_GEOMETRY if a wrap of that size certainly goes through a hole: if the
 * input is a single part, and a ball fits through its widest rim. */
vg_status vg_wrap_refuse_open(const struct vg_wrap_rims *r, double size,
                              const struct vg_stop *stop, struct vg_error *err);

/** Measure `missing`, `inside` and `sheet` of the wrap `out`. VG_ERR_GEOMETRY
 * if it is a hollow shell. */
vg_status vg_wrap_compare(const struct vg_wrap_rims *rims,
                          const struct vg_mesh *out, double size,
                          const struct vg_stop *stop, struct vg_wrap_report *r,
                          struct vg_error *err);

/** Append the kept triangles of m and their points to the wrap. VG_ERR_GEOMETRY
 * if the wrap intersects them, or if they enclose a fluid and the wrap is
 * outside it. */
vg_status vg_wrap_join(const struct vg_mesh *m, const uint8_t *keep,
                       const struct vg_stop *stop, struct vg_mesh *out,
                       struct vg_error *err);

#endif
