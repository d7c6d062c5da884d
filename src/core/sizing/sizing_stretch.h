/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_stretch.h: sources whose sizes depend on the direction.
 * Internal to core/sizing. Uses core/sizing/sizing.h.
 *
 * A stretched source has the size h across its axis u, and `ratio` times h
 * along it: a ratio above 1 requests needles along u, a ratio below 1 thin
 * cells normal to u. Mach cones have other axes at each point (sizing_cone.h).
 * In its shape, the size tensor is H = h (I + (ratio - 1) u u'), and it grows
 * outside as in vg_size_grow. */
#ifndef VG_CORE_SIZING_SIZING_STRETCH_H
#define VG_CORE_SIZING_SIZING_STRETCH_H

#include "core/sizing/sizing.h"
#include "core/sizing/sizing_cone.h"

/** A prepared source. */
struct vg_stretched {
  struct vg_source law; /* source with scaled spacings; corners of a box are
                           ordered */
  double axis[3][3];    /* unit vector u, and two unit vectors normal to it and
                           to each other */
  double ratio[2];      /* at p0 and p1 */
  double slope;         /* rate of growth - 1 */
  struct vg_mach_cones cones; /* of this kind of source only */
  double least;               /* smallest size */
  double rise;         /* smallest growth of the smallest size per distance */
  double lo[3], hi[3]; /* box around all points of the shape */
};

/** Does the source stretch? Gives its axis and the ratios at p0 and p1. For
 * VGRID's sources with the stretching flag 1, the ratio is the secondary
 * spacing SP over S, and the axis is the vector P. */
int vg_source_stretch(const struct vg_source *s, double axis[3],
                      double ratio[2]);

/** Defect of the stretching of a source and how to correct it, or NULL. */
const char *vg_source_stretch_defect(const struct vg_source *s);

/** Complete s, whose law, slope and box are set. */
void vg_stretched_prepare(struct vg_stretched *s);

/** Size tensor of the source at x. */
void vg_stretched_at(const struct vg_stretched *s, const double x[3],
                     struct vg_size_axes *a);

/** Smallest size of the source in the box lo..hi, or less. */
double vg_stretched_floor(const struct vg_stretched *s, const double lo[3],
                          const double hi[3]);

/** Point of the box lo..hi where the source is near, by projections from the
 * shape to the box and back, with which the distance falls. Returns whether it
 * is the centre, because that is in the shape. */
int vg_stretched_near(const struct vg_stretched *s, const double lo[3],
                      const double hi[3], double x[3]);

#endif
