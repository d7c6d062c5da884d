/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/triangles.h: intersection test of two triangles. */
#ifndef VG_CORE_GEOMETRY_TRIANGLES_H
#define VG_CORE_GEOMETRY_TRIANGLES_H

#include <stdint.h>

/** Do triangles a and b (nodes into point[], none degenerate) intersect at any
 * point other than their shared corners and the edges between them?
 *
 * A node of both triangles counts as a shared corner if its entries in fan_a
 * and fan_b (umbrella of each corner) are equal. Sheets of a surface that
 * touch in a node have different umbrellas there. Callers without umbrellas
 * pass a and b themselves. Two triangles with three shared corners always
 * intersect. Exact; re-entrant. */
int vg_triangles_meet(const double (*point)[3], const uint32_t a[3],
                      const uint32_t b[3], const uint32_t fan_a[3],
                      const uint32_t fan_b[3]);

#endif
