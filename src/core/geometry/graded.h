/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/geometry/graded.h: division of a curve into steps of the local spacing.
 */
#ifndef VG_CORE_GEOMETRY_GRADED_H
#define VG_CORE_GEOMETRY_GRADED_H

#include <stddef.h>

#include "base/status.h"

/** Divide [0, len] into n steps. Each step has the local spacing, times a
 * common factor near 1 that makes the steps fit.
 *
 * @param size   returns the target edge length at distance s from the start, >
 *               0
 * @param least  smallest number of steps, >= 1
 * @param s      out: [n + 1], s[0] = 0 and s[n] = len exactly; owned by the
 *               caller
 *
 * VG_ERR_INPUT if a spacing is not a positive number, or below 1e-8 len. */
vg_status vg_graded_steps(double len, double (*size)(void *user, double s),
                          void *user, size_t least, size_t *n, double **s,
                          struct vg_error *err);

/** Sine and cosine of pi/2 * x, 0 <= x <= 1, computed with +, * and / only, so
 * that the result has the same bits on every machine. */
void vg_quarter_turn(double x, double *sine, double *cosine);

#endif
