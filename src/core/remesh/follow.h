/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/follow.h: the metric of a sizing field on a surface. Private to
 * core/remesh.
 *
 * The metric of the field is restricted to the tangent plane: the size normal
 * to the surface has no influence, since the shape of the surface determines
 * how far an edge may deviate from it. Points of feature curves have no tangent
 * plane and take the metric in all directions. The sizes that the surface
 * requests (curvature, gaps, strips) are then intersected with it. */
#ifndef VG_CORE_REMESH_FOLLOW_H
#define VG_CORE_REMESH_FOLLOW_H

#include "core/remesh/metric.h"
#include "core/sizing/sizing.h"

/** Intersect *m with the metric of the field at x.
 *
 * @param n         unit normal of the surface, to whose plane the metric of
 *                  the field is restricted; NULL: not restricted
 * @param factor    on the sizes of the field
 * @param has_form  0: m->form is not set, and lengths are equal in all
 *                  directions
 * @param m         in: the size and form that the surface requests; out: the
 *                  same, with the form set. Normal to the surface, edges have
 *                  the largest length within it.
 * Threads: safe. */
void vg_follow_field(const struct vg_sizing *field, const double x[3],
                     const double *n, double factor, int has_form,
                     struct vg_metric *m);

#endif
