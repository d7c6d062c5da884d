/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/hessian/multiscale.h: the metric of a given complexity in which linear
 * interpolation of a solution has the least error.
 *
 * The least error in the norm L^p belongs to the metric
 *     M = D det(|H|)^(-1 / (2 p + 3)) |H|,
 * where |H| has the absolute eigenvalues of the Hessian H and D sets the
 * complexity (Loseille and Alauzet, SIAM J. Numer. Anal. 49, 2011). Several
 * solutions are intersected after each has been scaled to the same
 * complexity. */
#ifndef VG_CORE_HESSIAN_MULTISCALE_H
#define VG_CORE_HESSIAN_MULTISCALE_H

#include "core/hessian/hessian.h"

/* Norm of the largest error. */
#define VG_NORM_MAX 0

struct vg_multiscale_options {
  double complexity;   /* > 0, integral of sqrt(det M) over the estimate */
  int norm;            /* p from 1 to 16, or VG_NORM_MAX */
  double growth;       /* > 1, ratio of edge lengths across one unit of the
                          metric */
  double h_min, h_max; /* bounds of the edge lengths; 0 and INFINITY: none */
  double aspect_max;   /* >= 1, largest ratio of two edge lengths at a point */
};

struct vg_multiscale_report {
  double complexity;      /* reached */
  double h_least, h_most; /* edge lengths */
  double aspect_most;
  size_t n_min;    /* points with an edge length of h_min */
  size_t n_aspect; /* points with the largest aspect */
  size_t n_grown;  /* points refined by the growth */
};

/** Add the metric of one solution to those of others.
 *
 * @param hessian  [n_point] of vg_hessian
 * @param is_first 1: `metric` has none yet
 * @param metric   [n_point] intersection so far, each of complexity 1
 *
 * @param value    [n_point] the solution
 *
 * VG_ERR_INPUT: nowhere does the solution differ from a linear function, over
 * the length of a cell, by more than the rounding of 4-byte reals. */
vg_status vg_multiscale_add(const struct vg_estimate *e, const double *value,
                            const double (*hessian)[6], int norm, int is_first,
                            double (*metric)[6], struct vg_error *err);

/** Scale the metric to the complexity, within the bounds and the growth.
 *
 * @param metric  [n_point] in: of vg_multiscale_add; out: positive
 *
 * The growth: the edge length in each direction grows at most by the factor
 * `growth` over each unit of the metric (Alauzet, Finite Elem. Anal. Des. 46,
 * 2010), along all edges of the mesh. If bounds and growth do not admit the
 * complexity, the nearest one is reached, which is for the caller to report.
 * VG_ERR_MEMORY. Deterministic, as vg_hessian. */
vg_status vg_multiscale_scale(const struct vg_estimate *e,
                              const struct vg_multiscale_options *o,
                              double (*metric)[6],
                              struct vg_multiscale_report *r,
                              struct vg_error *err);

#endif
