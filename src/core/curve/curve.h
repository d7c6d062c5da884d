/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/curve/curve.h: closed plane curves through given points, and their
 * division into edges for a mesh in two dimensions. Uses core/geometry.
 *
 * Between corners the curve is a cubic spline, twice continuously
 * differentiable, over the chord length (de Boor, A Practical Guide to Splines,
 * 1978). At corners the pieces end with a constant second derivative in their
 * last interval; a curve without corners is periodic. A piece of two points is
 * straight. The curve passes through all points. */
#ifndef VG_CORE_CURVE_CURVE_H
#define VG_CORE_CURVE_CURVE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

struct vg_outline {
  size_t n_corner;
  size_t n;       /* Points, and intervals between them. */
  double (*x)[2]; /* [n] counter-clockwise. */
  double *s;      /* [n + 1] chord length up to each point; s[n]: of all. */
  /* [n] second derivatives of both coordinates at both ends of an interval. */
  double (*bend)[2][2];
  int8_t *corner; /* [n] 1: convex corner, -1: concave corner, 0: smooth. */
  double turn; /* Largest turn of the polygon at a smooth point, in radians, */
  size_t turns_at; /* and that point. */
  size_t nose;     /* Point farthest from point 0: the leading edge if that is
                      the trailing edge. */
  double chord;    /* Distance between the two. */
  /* Blunt trailing edge: intervals from point base[0] to base[1] around or next
   * to point 0; both SIZE_MAX: none. */
  size_t base[2];
};
#define VG_OUTLINE_INIT                                                        \
  {                                                                            \
    0                                                                          \
  } /* releasing this is a no-op */

void vg_outline_release(struct vg_outline *c);

/** Makes the curve through n >= 3 points, of which neighbours differ.
 *
 * A point is a corner where the polygon turns by 100 degrees or more; by 55
 * degrees, as at the next point; by 8 degrees, and its mean curvature is more
 * than 6 times that at both next points, of which one that is a corner does not
 * count; or by 60 degrees, and it is that at one of them, as on both sides of a
 * short base. A coarse polygon also turns at the points of a nose, but at all
 * of them. Few points show no curve: of 8 points or less, and between corners
 * that are at most 4 intervals apart, all points that turn by more than 0.6
 * degrees are corners. The ends of an interval are corners if the curve would
 * be farther from its segment than 0.3 of its length. Arithmetic without libm
 * other than sqrt. O(n), but for each repetition after the last rule.
 * VG_ERR_MEMORY. */
vg_status vg_outline_new(size_t n, const double (*x)[2], struct vg_outline *out,
                         struct vg_error *err);

/** Length of the base, which the curve must have. */
double vg_outline_base(const struct vg_outline *c);

/** Point at the chord length t in interval i, and the curvature there. */
void vg_outline_at(const struct vg_outline *c, size_t i, double t, double x[2],
                   double *curvature);

/** Requested edge lengths. */
struct vg_outline_sizes {
  double largest;  /* > 0 */
  double smallest; /* Lower limit of all others but sources; 0: none. */
  double per_turn; /* Edges per full circle, > 0. */
  double growth;   /* Largest ratio of neighbouring edges, > 1. */
  double corner;   /* At convex corners; 0: not given. */
  double nose;     /* At the nose; 0: not given. */
  size_t n_base;   /* Edges across a blunt trailing edge; 0: by length. */
  double (*at)(void *user, const double x[2]); /* Other requests at a point;
                                                  INFINITY: none. */
  void *user;
};

/** Divides the curve into edges. Corners are points of the division; between
 * them the length of the edges follows the least request at each place, limited
 * by the growth.
 *
 * @param n, x  out: points, counter-clockwise from the first corner, or from
 *              point 0; corners and the nose are among them; *x is owned by
 *              the caller
 * VG_ERR_INPUT: a request is below 1e-8 of the length. VG_ERR_MEMORY. */
vg_status vg_outline_divide(const struct vg_outline *c,
                            const struct vg_outline_sizes *sizes, size_t *n,
                            double (**x)[2], struct vg_error *err);

#endif
