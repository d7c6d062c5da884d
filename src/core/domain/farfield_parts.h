/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/farfield_parts.h: curves and charts from which the farfields are
 * made. Private to core/domain. */
#ifndef VG_CORE_DOMAIN_FARFIELD_PARTS_H
#define VG_CORE_DOMAIN_FARFIELD_PARTS_H

#include "core/domain/farfield.h"

/** Make room for n more points. */
vg_status vg_farfield_points(struct vg_mesh *m, size_t n, struct vg_error *err);

/** Call vg_graded_steps. When the caller has asked to stop, sizes are 0, which
 * ends the division with VG_ERR_STOPPED. */
vg_status vg_farfield_divide(double len, double (*size)(void *user, double s),
                             void *user, const struct vg_size_function *law,
                             size_t least, size_t *n, double **s,
                             struct vg_error *err);

/** Point of the unit circle; turn is in quarters of the circle, 0 <= turn <=
 * 4. */
void vg_on_circle(double turn, double p[2]);

/** A map from the plane to a curved surface. */
struct vg_chart {
  struct vg_planar_law law; /* Edge length in the plane. */
  void (*to_space)(void *user, const double p[2], double x[3]); /* user:
                                                     that of the law. */
};

/** Append the triangles of a chart whose boundary is one loop.
 *
 * @param loop   [n] counter-clockwise in the plane
 * @param id     [n] the points of m at the loop
 * @param swap   1: normals are those of clockwise triangles of the plane
 * On failure m is unchanged except for points without triangles. */
vg_status vg_farfield_chart(struct vg_mesh *m, const struct vg_chart *chart,
                            size_t n, const double (*loop)[2],
                            const uint32_t *id, int swap, uint32_t patch,
                            struct vg_error *err);

#endif
