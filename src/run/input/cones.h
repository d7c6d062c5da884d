/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* run/input/cones.h: places sources of kind machcone around the body. Private
 * to run/input. */
#ifndef VG_RUN_INPUT_CONES_H
#define VG_RUN_INPUT_CONES_H

#include "run/input/input.h"

/** Complete the sources of kind machcone in r->settings, and describe each of
 * them in a note. Values that are not given come from the farfield (Mach number
 * and radius) and from the extent of the body along the flow: of all patches
 * without the condition of a farfield or symmetry plane.
 *
 * VG_ERR_INPUT, naming the source, if a value is given in neither place. */
vg_status vg_read_place_cones(struct vg_read *r, struct vg_error *err);

/** Does the condition of a patch make it a farfield or symmetry plane, which
 * does not belong to the body? */
int vg_patch_is_outer(const struct vg_patch *p);

#endif
