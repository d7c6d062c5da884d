/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/rim_planes.h: divides a rim that lies in two or three planes of
 * any orientation. Private to core/domain. */
#ifndef VG_CORE_DOMAIN_RIM_PLANES_H
#define VG_CORE_DOMAIN_RIM_PLANES_H

#include <stddef.h>
#include <stdint.h>

/** Closed loop of points. */
struct vg_rim_loop {
  size_t n;
  const double (*x)[3];
  const uint32_t *point; /* [n] Indices in x, caps on their left. */
  const uint32_t *apex;  /* Indexed by point: third point of the triangle of
                            the surface at the edge to the next point;
                            UINT32_MAX: unknown. */
};

/** Parts of a loop. Part i is that from at[i] to at[i + 1], the last one that
 * from at[n_part - 1] to at[0] + n. Two parts are separated by the chord
 * between their ends, three by chords from their ends to `foot`:
 *
 *         at[1] o-------. at[0]          at[1] o-------. at[0]
 *              /|      /                      / \  0  /|
 *             / | 0   /                      / 1 foot  |
 *            / 1|    /                      /   / 2    |
 *           o---'---'                      o---o at[2] '
 */
struct vg_rim_parts {
  int n_part;
  size_t at[4]; /* Ascending; indices beyond n continue at the start. at[n_part]
                   is at[0] + n. */
  double foot[3]; /* Of three parts. */
};

/** Whether each part lies in a plane to within `flatness` of its extent, and
 * does not lie on the surface next to it: the six edges of a rim of a cube
 * without three sides also bound the three sides that are there. */
int vg_rim_parts_are_flat(const struct vg_rim_loop *l,
                          const struct vg_rim_parts *parts, double flatness);

/** Find two or three such parts; two are preferred, and then those of which the
 * smallest is the longest. Parts begin at corners of the loop. Returns 0, with
 * *parts unchanged, if the loop cannot be divided or has more than 512
 * corners. O(n^2 log n) at worst. */
int vg_rim_parts_find(const struct vg_rim_loop *l, double flatness,
                      struct vg_rim_parts *parts);

#endif
