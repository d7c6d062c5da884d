/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sides/zone_line.h: straight lines through a surface. Private to
 * core/sides. */
#ifndef VG_CORE_SIDES_ZONE_LINE_H
#define VG_CORE_SIDES_ZONE_LINE_H

#include <stddef.h>
#include <stdint.h>

enum { VG_LINE_TRIES = 64 }; /* lines; nearly always the first one decides */

/** 1: the straight line from a to b crosses the triangle with corners x, 0: it
 * does not, -1: it meets its border or its plane. Exact. */
int vg_line_crosses(const double *const x[3], const double *a, const double *b);

/** Where it crosses: 0 at a, 1 at b. Rounded. */
double vg_line_at(const double *const x[3], const double *a, const double *b);

/** Place number i in a triangle. None is a special one such as the centroid, so
 * that few lines through it meet corners and edges. */
void vg_line_place(const double *const x[3], int i, double at[3]);

#endif
