/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Searches in the hierarchy of samples with eight lanes, for processors with
 * AVX2. */
#include "base/wide.h"

#ifdef VG_WIDE
#define WIDTH 8
#define TARGET VG_WIDE
#define ABOVE vg_bvh_above_wide
#define BELOW vg_bvh_below_wide
#include "core/sizing/sizing_walk_lanes.h"
#else
typedef int vg_no_wide_walk; /* ISO C forbids an empty file. */
#endif
