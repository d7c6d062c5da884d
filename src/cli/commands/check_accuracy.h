/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* cli/commands/check_accuracy.h: discretisation errors of the mesh that is
 * checked. */
#ifndef VG_CLI_COMMANDS_CHECK_ACCURACY_H
#define VG_CLI_COMMANDS_CHECK_ACCURACY_H

#include "core/accuracy/accuracy.h"
#include "run/settings/settings.h"

/** Measure a valid mesh. Walls are the patches in the list `walls` or, without
 * it, with a viscous condition, but not those in the list `slip`. The wall
 * distance of y+ 1 follows from `reynolds` and `reference_length`; otherwise it
 * is `first`, or the median first height of the mesh.
 *
 * @param r  out: released with vg_accuracy_release
 * VG_ERR_INPUT for patches that do not exist; errors of vg_accuracy_measure. */
vg_status vg_check_accuracy(const struct vg_settings *asked,
                            const struct vg_mesh *m,
                            struct vg_accuracy_report *r, struct vg_error *err);

#endif
