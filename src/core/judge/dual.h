/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/dual.h: orthogonality of the median dual. Private to core/judge.
 *
 * The definitions are those of struct vg_dual_quality. A sweep belongs to one
 * mesh or slice. It visits the edges at one point after the other. Each cell
 * adds the area vector of its part of the dual face, and each dual face adds
 * its area and angle to both of its points. These sums are exact on a grid
 * (struct vg_grid_sum), so that slices can add their parts in any order: the
 * figures are the same, bit by bit, for any division into slices. */
#ifndef VG_CORE_JUDGE_DUAL_H
#define VG_CORE_JUDGE_DUAL_H

#include "base/rendezvous.h"
#include "core/judge/quality_parts.h"

/** A sum of vectors that does not depend on their order: multiples of
 * 2^(40 top) and of 2^(40 (top - 1)), where the largest component of all
 * addends is below 2^(40 (top + 1)). Smaller parts of the addends are cut off,
 * which is less than 2^-40 of the largest component for each of them. Zero if
 * zeroed. Holds 2^22 addends. */
struct vg_grid_sum {
  int64_t part[2][3];
  int32_t top, is_used;
};

void vg_grid_sum_add(struct vg_grid_sum *b, const double x[3]);
void vg_grid_sum_join(struct vg_grid_sum *b, const struct vg_grid_sum *more);
void vg_grid_sum_value(const struct vg_grid_sum *b, double out[3]);

/** A dual face, or the part of it in a slice; an item of a rendezvous. */
struct vg_dual_face {
  uint32_t node[2];        /* points of the mesh: lower, higher */
  double x[2][3];          /* their positions */
  struct vg_grid_sum area; /* area vector, from the lower to the higher point */
};

/** A control volume, or the part of it in a slice; an item of a rendezvous. */
struct vg_dual_point {
  uint32_t node, unused;
  float range[2]; /* least and largest sub-volume; INFINITY, 0: none */
  double x[3];
  struct vg_grid_sum sum; /* of angle times area, and of areas */
};

/** Sink of the parts that a slice shares with others; VG_ERR_MEMORY. */
struct vg_dual_shared {
  const uint8_t *is_open; /* [n_point] points of faces between slices */
  const uint32_t *id;     /* [n_point] point of the mesh */
  struct vg_item_blocks *face, *point; /* of these, and of the points */
};

/** Measure all dual faces and control volumes of m, and count them in f.
 *
 * @param shared  NULL: m is a whole mesh. Otherwise m is a slice: dual faces
 *                between two open points, and open points, are listed instead
 *                of counted
 *
 * O(n) time. Memory: 4 bytes per corner of a cell and 72 per point.
 * VG_ERR_MEMORY. */
vg_status vg_dual_measure(const struct vg_mesh *m,
                          const struct vg_dual_shared *shared,
                          struct vg_stats *f, struct vg_error *err);

/** Memory of the arrays of vg_dual_measure. */
size_t vg_dual_bytes(const struct vg_mesh *m);

/** Count a complete dual face. sum out: what it adds to both of its points. */
void vg_dual_count_face(struct vg_stats *f, const struct vg_dual_face *face,
                        double sum[3]);

/** Count a complete control volume. */
void vg_dual_count_point(struct vg_stats *f, const struct vg_dual_point *p);

#endif
