/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Limits of shapes for repairs. */
#include <assert.h>

#include "partition/repair/repair_parts.h"

/* Values of vg_shape, with the dihedral angles that they correspond to. */
static const struct vg_repair_levels euclidean = { 0.45F, /* R1: 42 degrees */
                                                   0.55F, /* R2: 48 */
                                                   0.4F,  /* R3: 39 */
                                                   VG_SHAPE_TARGET,
                                                   0.0955, /* R4: 18 and 162 */
                                                   0.0076, /* R7: 5 and 175 */
                                                   { 0.0076, 0.03,
                                                     VG_SHAPE_TARGET } };

/* R11: in a metric, cubes of the mean ratio. */
static const struct vg_repair_levels in_metric = { 1,
                                                   0.614F,
                                                   0.614F,
                                                   VG_METRIC_TARGET,
                                                   0.091,
                                                   0.008,
                                                   { 0.008, 0.064,
                                                     VG_METRIC_TARGET } };

const struct vg_repair_levels *vg_repair_levels(const struct vg_sizing *sizing)
{
  assert(sizing);
  return vg_sizing_is_stretched(sizing) ? &in_metric : &euclidean;
}
