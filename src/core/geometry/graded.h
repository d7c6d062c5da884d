/* core/geometry/graded.h: division of a curve into steps of the local size. */
#ifndef VG_CORE_GEOMETRY_GRADED_H
#define VG_CORE_GEOMETRY_GRADED_H

#include <stddef.h>

#include "base/status.h"

/** Divide [0, len] into n steps, each as long as the size around it but for
 * one common factor near 1.
 *
 * @param size   edge length wanted at distance s from the start, > 0
 * @param least  smallest number of steps, >= 1
 * @param s      out: [n + 1], s[0] = 0 and s[n] = len exactly; caller's
 * VG_ERR_INPUT when a size is not a positive number, or when more than 1e8
 * steps would be needed. */
vg_status vg_graded_steps(double len, double (*size)(void *user, double s),
                          void *user, size_t least, size_t *n, double **s,
                          struct vg_error *err);

/** Sine and cosine of pi/2 * x, 0 <= x <= 1, by +, * and / alone: the same
 * bits on every machine. */
void vg_quarter_turn(double x, double *sine, double *cosine);

#endif
