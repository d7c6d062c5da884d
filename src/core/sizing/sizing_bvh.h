/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_bvh.h: growth of the spacing from very many point
 * samples, by a bounding volume hierarchy. Internal to core/sizing. Uses base
 * only.
 *
 * Sample i with size h_i gives, with slope s and d = max(0, r_i - p h_i),
 *   from above  h_i + s d,  the minimum over i: sizes grow away from samples;
 *   from below  h_i - s d,  the maximum over i: nothing may undercut the
 *               samples nearby. Beyond VG_BVH_KNEE h_i, this value falls by
 *               VG_BVH_STEEP if s is less, and so ends after three h_i.
 * The plateau p h_i (VG_BVH_PLATEAU of h, s p <= VG_BVH_OFFSET) closes the
 * gaps between the samples of a triangle. It also flattens the kink at the
 * surface, which a coarse interpolation would round upwards.
 *
 * This module exists in addition to core/search/box_tree.h because it tests
 * eight samples or nodes at once: the smallest value at 200,000 points near
 * 577,602 samples takes 0.18 s, with the general tree 0.98 s (one thread,
 * 2026-11-26). */
#ifndef VG_CORE_SIZING_SIZING_BVH_H
#define VG_CORE_SIZING_SIZING_BVH_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#define VG_BVH_PLATEAU 0.25 /* H3 */
#define VG_BVH_OFFSET 0.05
#define VG_BVH_KNEE 1.5
#define VG_BVH_STEEP 0.5
#define VG_BVH_CLASSES                                                         \
  16 /* each class spans a factor of 4 in size; the last                       \
        holds all larger sizes */

struct vg_bvh;

/** s p, relative to h_i. */
static inline double vg_bvh_offset(double slope)
{
  return slope * VG_BVH_PLATEAU < VG_BVH_OFFSET ? slope * VG_BVH_PLATEAU
                                                : VG_BVH_OFFSET;
}

/** Slope from below beyond the knee, at least the slope before it. */
static inline double vg_bvh_steep(double slope)
{
  return slope > VG_BVH_STEEP ? slope : VG_BVH_STEEP;
}

/** Value from below of a sample of size h beyond the knee, plus vg_bvh_steep d,
 * relative to h. */
static inline double vg_bvh_rise(double slope)
{
  return 1 + vg_bvh_offset(slope) + (vg_bvh_steep(slope) - slope) * VG_BVH_KNEE;
}

/** Build the hierarchy over n >= 1 samples; p [n][3] and h [n] are copied.
 * threads: as for vg_parallel_for; the result does not depend on it. */
vg_status vg_bvh_new(size_t n, const double (*p)[3], const double *h,
                     double slope, int threads, struct vg_bvh **out,
                     struct vg_error *err);

/** Free; NULL is accepted. */
void vg_bvh_free(struct vg_bvh *t);

/** Bounds of the values at points in a box, computed when first needed. They
 * limit the searches there. is_known and has_start must be 0 initially, and
 * the functions below are called with one hierarchy each. */
struct vg_bvh_reach {
  double mid[3], half; /* centre of the box, which is a cube, and half its side
                        */
  float trifle; /* values from below that are smaller need not be known */
  float above;  /* lower bound of the values from above at the points */
  int is_known, has_start;
  float most[VG_BVH_CLASSES]; /* largest value from below of each size class at
                                 the centre */
  uint32_t start[VG_BVH_CLASSES]; /* group of each class with all samples that
                                     may have the smallest value from above */
  int8_t level[VG_BVH_CLASSES];   /* its level; -1: there is no such sample */
};

/** Use r for another box. */
static inline void vg_bvh_reach_clear(struct vg_bvh_reach *r, double half,
                                      float trifle)
{
  r->half = half;
  r->trifle = trifle;
  r->above = 0;
  r->is_known = r->has_start = 0;
}

/** Smallest "from above" value in the box lo..hi (a point: lo == hi).
 *
 * @param below   only smaller values are searched for; returned if there is no
 *                smaller value
 * @param reach   for speed, or NULL; lo..hi is within its box
 * @param hint    in/out: start of the search, and its end. Any value returned
 *                by an earlier call, initially 0. It only affects speed, not
 *                the result. */
double vg_bvh_above(const struct vg_bvh *t, const double lo[3],
                    const double hi[3], double below,
                    struct vg_bvh_reach *reach, uint32_t *hint);

/** Largest "from below" value at x. Returns `above` if no value exceeds it, or
 * any value that is at least `enough`.
 *
 * @param reach  for speed, or NULL
 * @param by     out: size of the sample with this value; 0 if no value exceeds
 *               `above` */
double vg_bvh_below(const struct vg_bvh *t, const double x[3], double above,
                    double enough, struct vg_bvh_reach *reach, double *by);

/** Let a sample of size `by` have the value v from below at some point. Returns
 * by how much more than s * far the value can fall over a distance of `far`. 0
 * if by is 0. */
double vg_bvh_falls(const struct vg_bvh *t, double by, double v, double far);

/** Value from below of a sample of size `by` at its knee. */
double vg_bvh_knee(const struct vg_bvh *t, double by);

#endif
