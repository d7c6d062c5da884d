/* core/sizing/sizing_probes.h: places in and around a source, and which of them
 * are in a void. For core/sizing/sizing_effect.c. */
#ifndef VG_CORE_SIZING_SIZING_PROBES_H
#define VG_CORE_SIZING_SIZING_PROBES_H

#include "core/sizing/sizing.h"

struct vg_probe {
  double x[3];
  uint32_t source;
  int32_t crossings; /* of vg_probes_cross: below 0 in the void */
};

struct vg_probes {
  size_t n, cap;
  struct vg_probe *item;
  int refused; /* memory was, once */
};
#define VG_PROBES_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

void vg_probes_release(struct vg_probes *p);

/** Append places in the shape of source `s`, number i: on its border too, a
 * thousandth within. A VGRID source is a point or a line. is_fine: many. */
void vg_probes_shape(struct vg_probes *p, const struct vg_source *s, uint32_t i,
                     int is_fine);

/** Append, for the places from .. to, those at a distance of `far` along the
 * axes. */
void vg_probes_around(struct vg_probes *p, size_t from, size_t to, double far);

/** Set crossings: triangles of the closed m that a ray from each place along x
 * passes from behind, less those that it passes from the front. Faces look
 * into the void. Signs are exact. Cost: O(triangles log places), and the
 * triangles that a ray comes near. VG_ERR_MEMORY. */
vg_status vg_probes_cross(struct vg_probes *p, const struct vg_mesh *m,
                          struct vg_error *err);

#endif
