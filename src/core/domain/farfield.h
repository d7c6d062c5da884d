/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/farfield.h: spheres and boxes, whole or cut in half by a
 * coordinate plane, appended to a surface. Used by vg_domain_complete and the
 * examples. */
#ifndef VG_CORE_DOMAIN_FARFIELD_H
#define VG_CORE_DOMAIN_FARFIELD_H

#include "core/domain/planar.h"
#include "core/domain/planar_patch.h"

/* Directed edges in one plane; the closing surface is on their left. */
struct vg_border {
  size_t n, cap;
  uint32_t (*edge)[2];
};
#define VG_BORDER_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

void vg_border_release(struct vg_border *r);
vg_status vg_border_add(struct vg_border *r, uint32_t a, uint32_t b,
                        struct vg_error *err);

/** Append a sphere.
 *
 * @param half    -1: whole; else 2 * axis + side: the half above (side 1) or
 *                below (side 0) the centre
 * @param inward  1: normals point to the centre
 * @param border  out: open edges of a half sphere are appended; not used for
 *                a whole sphere
 * Points on the equator of a half sphere have the coordinate of the centre
 * exactly. On failure m is unchanged except for points without triangles. */
vg_status vg_add_sphere(struct vg_mesh *m, const double centre[3],
                        double radius, int half, int inward,
                        const struct vg_size_function *size, uint32_t patch,
                        struct vg_border *border, struct vg_error *err);

/** Append a box with normals that point into it.
 *
 * @param open    face left out: 2 * axis + side, or -1
 * @param patch   index in m->patch for the faces x-, x+, y-, y+, z-, z+
 * @param border  out: edges of the open face are appended */
vg_status vg_add_box(struct vg_mesh *m, const double lo[3], const double hi[3],
                     int open, const struct vg_size_function *size,
                     const uint32_t patch[6], struct vg_border *border,
                     struct vg_error *err);

/** vg_domain_complete with any size law instead of a sizing field; law may be
 * NULL if farfield->spacing is given. */
vg_status vg_domain_complete_by(struct vg_mesh *surface,
                                const struct vg_farfield *farfield,
                                const struct vg_size_function *law,
                                struct vg_domain_report *report,
                                struct vg_error *err);

#endif
