/* core/geometry/triangles.h: do two triangles meet? */
#ifndef VG_CORE_GEOMETRY_TRIANGLES_H
#define VG_CORE_GEOMETRY_TRIANGLES_H

#include <stdint.h>

/** Whether triangles a and b (nodes into point[], none degenerate) have a
 * point in common besides common corners and the edges between them. A node
 * of both is a common corner where its entries in fan_a and fan_b, by corner,
 * are the same: sheets of a surface that touch in a node have different
 * fans; where there are none, a and b themselves will do. Two with three
 * common corners meet. Exact; re-entrant. */
int vg_triangles_meet(const double (*point)[3], const uint32_t a[3],
                      const uint32_t b[3], const uint32_t fan_a[3],
                      const uint32_t fan_b[3]);

#endif
