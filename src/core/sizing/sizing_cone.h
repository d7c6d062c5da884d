/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_cone.h: sizes along the Mach cones of a body, for sonic
 * booms. Internal to core/sizing. Uses core/sizing/sizing.h.
 *
 * A source of kind VG_SOURCE_MACHCONE is a bundle of cones with the half angle
 * asin(1 / mach) that open along the axis p0 p1. Their apexes are on the axis
 * between p0 and p1, and they end at the radius r0:
 *
 *          /      /  r0
 *         /      /          n: normal to the cone, size h
 *        / n_   /           along the line from the apex: stretch * h
 *       /   |\ /            around the axis: stretch * h
 *      p0 ---- p1
 *
 * h is h0 on the axis and h1 at r0. The two large sizes are at most h plus the
 * growth over the distance r from the axis. The metric turns around the axis,
 * and a growth of 1 + s allows for that up to a size of about
 * sqrt(h (h + 2 s r)) around it. Such an edge along a tangent leaves the cone
 * by less than h / 2. No size is below h. Results are computed with + - * / and
 * sqrt only.
 *
 * Outside the cones, the sizes are those at the nearest point, grown; beyond r0
 * they are those on the same line at r0, grown. These sizes obey the law of
 * vg_size_grow: gradation changes them by a few per cent only. (If it had to
 * change them everywhere, the sizing field would take ten times as long.)
 * Threads: safe. */
#ifndef VG_CORE_SIZING_SIZING_CONE_H
#define VG_CORE_SIZING_SIZING_CONE_H

#include "core/sizing/sizing.h"
#include "core/sizing/sizing_tensor.h"

/** Defect of a source of this kind and how to correct it, or NULL. */
const char *vg_mach_cone_defect(const struct vg_source *s);

/** Cones that are prepared for many evaluations. */
struct vg_mach_cones {
  double p0[3], axis[3], length; /* line of apexes: from p0 along a unit vector
                                  */
  double sine, cosine, cot;      /* of the half angle */
  double r0, h0, h1, stretch;    /* as in the source */
  double slope;                  /* growth rate - 1 */
  double turn;                   /* bound on the turning of the axes, from
                                    slope and half angle */
};

void vg_mach_cones_prepare(const struct vg_source *s, double slope,
                           struct vg_mach_cones *c);

/** Distance of x from the cones.
 *
 * @param t    out: distance from the axis, as a fraction of r0, at most 1
 * @param way  out: vector to x from the nearest point of the cones; zero within
 *             them */
double vg_mach_cones_way(const struct vg_mach_cones *c, const double x[3],
                         double *t, double way[3]);

/** The same for cones that are not prepared. */
double vg_mach_cone_way(const struct vg_source *s, const double x[3], double *t,
                        double way[3]);

/** Size tensor at any point. */
void vg_mach_cones_axes(const struct vg_mach_cones *c, const double x[3],
                        struct vg_size_axes *a);

/** Box around the cones. */
void vg_mach_cone_bounds(const struct vg_source *s, double lo[3], double hi[3]);

#endif
