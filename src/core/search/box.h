/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/search/box.h: axis-parallel boxes. An empty box has lo > hi. */
#ifndef VG_CORE_SEARCH_BOX_H
#define VG_CORE_SEARCH_BOX_H

#include <math.h>

struct vg_box {
  double lo[3], hi[3];
};

#define VG_BOX_EMPTY                                                           \
  {                                                                            \
    { INFINITY, INFINITY, INFINITY },                                          \
    {                                                                          \
      -INFINITY, -INFINITY, -INFINITY                                          \
    }                                                                          \
  }

/** Enlarge the box so that it contains the point x. */
static inline void vg_box_add(struct vg_box *b, const double x[3])
{
  for (int k = 0; k < 3; k++) {
    if (x[k] < b->lo[k]) b->lo[k] = x[k];
    if (x[k] > b->hi[k]) b->hi[k] = x[k];
  }
}

/** Enlarge box a so that it contains box b, which may be empty. */
static inline void vg_box_join(struct vg_box *a, const struct vg_box *b)
{
  for (int k = 0; k < 3; k++) {
    if (b->lo[k] < a->lo[k]) a->lo[k] = b->lo[k];
    if (b->hi[k] > a->hi[k]) a->hi[k] = b->hi[k];
  }
}

/** Do the boxes share a point? Empty boxes touch nothing. */
static inline int vg_box_touch(const struct vg_box *a, const struct vg_box *b)
{
  return a->lo[0] <= b->hi[0] && b->lo[0] <= a->hi[0] && a->lo[1] <= b->hi[1] &&
         b->lo[1] <= a->hi[1] && a->lo[2] <= b->hi[2] && b->lo[2] <= a->hi[2];
}

/** Squared distance of the point x from the box, INFINITY if the box is empty.
 * Rounding is monotone: a box within another one is never nearer to x. */
static inline double vg_box_distance2(const struct vg_box *b, const double x[3])
{
  double sum = 0;

  for (int k = 0; k < 3; k++) {
    double below = b->lo[k] - x[k], above = x[k] - b->hi[k];
    double d = below > 0 ? below : above > 0 ? above : 0;

    sum += d * d;
  }
  return sum;
}

/** Squared distance between two boxes. */
static inline double vg_box_gap2(const struct vg_box *a, const struct vg_box *b)
{
  double sum = 0;

  for (int k = 0; k < 3; k++) {
    double below = a->lo[k] - b->hi[k], above = b->lo[k] - a->hi[k];
    double d = below > 0 ? below : above > 0 ? above : 0;

    sum += d * d;
  }
  return sum;
}

#endif
