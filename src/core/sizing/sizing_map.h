/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_map.h: spacings given at points, as a map for
 * vg_sizing_options. Uses core/sizing/sizing.h. */
#ifndef VG_CORE_SIZING_SIZING_MAP_H
#define VG_CORE_SIZING_SIZING_MAP_H

#include "core/sizing/sizing.h"

struct vg_size_samples; /* opaque, read-only */

/** Point i of the values `name` must lie within VG_COORDINATE_MAX
 * (core/mesh/mesh.h). VG_ERR_INPUT. */
vg_status vg_size_place_check(const char *name, size_t i, const double x[3],
                              struct vg_error *err);

/** Check samples: VG_ERR_INPUT names the first point (counted from 1) that is
 * not finite, or whose spacing is not positive and finite. */
vg_status vg_size_samples_check(const char *name, size_t n,
                                const double (*x)[3], const double *h,
                                struct vg_error *err);

/** Spacings that grow from each of n >= 1 checked points at a given rate; the
 * minimum over all points.
 *
 * @param x, h    [n] copied
 * @param growth  rate > 1
 * @param out     release with vg_size_samples_free
 *
 * Cost: O(n log n); an evaluation O(log n). The result does not depend on
 * threads. */
vg_status vg_size_samples_new(size_t n, const double (*x)[3], const double *h,
                              double growth, int threads,
                              struct vg_size_samples **out,
                              struct vg_error *err);

/** Accepts NULL. */
void vg_size_samples_free(struct vg_size_samples *s);

/** The map of the samples; valid as long as they are. Threads: safe. */
const struct vg_size_map *vg_size_samples_map(const struct vg_size_samples *s);

#endif
