/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_probes.h: sample points in and around a source, and
 * whether they are in a void. For core/sizing/sizing_effect.c. */
#ifndef VG_CORE_SIZING_SIZING_PROBES_H
#define VG_CORE_SIZING_SIZING_PROBES_H

#include "core/sizing/sizing.h"

struct vg_probe {
  double x[3];
  uint32_t source;
  int32_t crossings; /* set by vg_probes_cross: negative in the void */
};

struct vg_probes {
  size_t n, cap;
  struct vg_probe *item;
  int refused; /* 1: memory was refused */
};
#define VG_PROBES_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

void vg_probes_release(struct vg_probes *p);

/** Append sample points in the shape of source `s`, number i. Some are on its
 * border, a thousandth of the radius inside. A VGRID source counts as a point
 * or a line. is_fine: add many points. */
void vg_probes_shape(struct vg_probes *p, const struct vg_source *s, uint32_t i,
                     int is_fine);

/** For each of the points from .. to, append points at a distance of `far`
 * along the axes. */
void vg_probes_around(struct vg_probes *p, size_t from, size_t to, double far);

/** Set crossings: number of triangles of the closed mesh m that a ray along x
 * from each point crosses from behind, minus the number crossed from the
 * front. Faces look into the void. Signs are exact. Cost: O(triangles log
 * points), plus the triangles near each ray. VG_ERR_MEMORY. */
vg_status vg_probes_cross(struct vg_probes *p, const struct vg_mesh *m,
                          struct vg_error *err);

#endif
