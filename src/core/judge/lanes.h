/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/judge/lanes.h: products of vectors for the lanes of base/wide.h. Private
 * to core/judge. */
#ifndef VG_CORE_JUDGE_LANES_H
#define VG_CORE_JUDGE_LANES_H

#include "base/wide.h"

VG_WITHIN double vg_lane_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

VG_WITHIN void vg_lane_cross(const double a[3], const double b[3], double c[3])
{
  c[0] = a[1] * b[2] - a[2] * b[1];
  c[1] = a[2] * b[0] - a[0] * b[2];
  c[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
