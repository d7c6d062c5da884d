/* core/sizing/sizing_bvh.h: growth of very many point samples, by a bounding
 * volume hierarchy. Internal to core/sizing. Uses base only.
 *
 * Sample i with size h_i gives, with slope s and d = max(0, r_i - p h_i),
 *   from above  h_i + s d,  the minimum over i: sizes grow away from samples;
 *   from below  h_i - s d,  the maximum over i: nothing may undercut them
 *               nearby. Beyond VG_BVH_KNEE h_i that falls by VG_BVH_STEEP
 *               if s is less, and so ends after three h_i.
 * The plateau p h_i (VG_BVH_PLATEAU of h, s p <= VG_BVH_OFFSET) closes the
 * gaps between samples of one triangle and flattens the kink that a coarse
 * interpolation across the surface would round upwards.
 *
 * It stays next to core/search/box_tree.h because it tests eight samples or
 * nodes at once: the least value at 200,000 points near 577,602 samples takes
 * 0.18 s, by the shared tree 0.98 s (one thread, 2026-11-26). */
#ifndef VG_CORE_SIZING_SIZING_BVH_H
#define VG_CORE_SIZING_SIZING_BVH_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#define VG_BVH_PLATEAU 0.25 /* H3 */
#define VG_BVH_OFFSET 0.05
#define VG_BVH_KNEE 1.5
#define VG_BVH_STEEP 0.5
#define VG_BVH_CLASSES 16 /* sizes within a factor of 4; the last: others */

struct vg_bvh;

/** s p, as a share of h_i. */
static inline double vg_bvh_offset(double slope)
{
  return slope * VG_BVH_PLATEAU < VG_BVH_OFFSET ? slope * VG_BVH_PLATEAU
                                                : VG_BVH_OFFSET;
}

/** The slope from below beyond the knee, at least that before it. */
static inline double vg_bvh_steep(double slope)
{
  return slope > VG_BVH_STEEP ? slope : VG_BVH_STEEP;
}

/** What size h gives from below beyond the knee, less vg_bvh_steep d, in h. */
static inline double vg_bvh_rise(double slope)
{
  return 1 + vg_bvh_offset(slope) + (vg_bvh_steep(slope) - slope) * VG_BVH_KNEE;
}

/** Build over n >= 1 samples; p [n][3] and h [n] are copied. threads: as
 * vg_parallel_for's; the same for any number. */
vg_status vg_bvh_new(size_t n, const double (*p)[3], const double *h,
                     double slope, int threads, struct vg_bvh **out,
                     struct vg_error *err);

/** Free; NULL is accepted. */
void vg_bvh_free(struct vg_bvh *t);

/** Least "from above" value in the box lo..hi (a point: lo == hi).
 *
 * @param below   only values under this matter; it is returned if none is
 * @param hint    in/out: where the search starts, and where it ended; any
 *                value that an earlier call returned, 0 at first. It is for
 *                speed: the result does not depend on it. */
double vg_bvh_above(const struct vg_bvh *t, const double lo[3],
                    const double hi[3], double below, uint32_t *hint);

/** What classes of samples give from below at some point near those where it
 * is asked for, which tells what they can give there; made when it is first
 * of use. is_known is 0 at first. */
struct vg_bvh_reach {
  double mid[3];
  float trifle; /* less than that need not be known */
  int is_known;
  float most[VG_BVH_CLASSES];
};

/** Greatest "from below" value at x; `above` if none exceeds it, or any that
 * is not below `enough`.
 *
 * @param reach  for speed, or NULL
 * @param by     out: the size of the sample that gives it, 0 where none
 *               exceeds `above` */
double vg_bvh_below(const struct vg_bvh *t, const double x[3], double above,
                    double enough, struct vg_bvh_reach *reach, double *by);

/** A sample of size `by` gives v from below somewhere: how much more than by
 * s `far` that falls over a distance of `far` at most. 0 if by is. */
double vg_bvh_falls(const struct vg_bvh *t, double by, double v, double far);

/** What a sample of size `by` gives from below at its knee. */
double vg_bvh_knee(const struct vg_bvh *t, double by);

#endif
