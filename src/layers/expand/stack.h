/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/stack.h: shape of the layer cells on one face. Uses core,
 * layers/columns/columns.h, join.h. */
#ifndef VG_LAYERS_EXPAND_STACK_H
#define VG_LAYERS_EXPAND_STACK_H

#include <stddef.h>
#include <stdint.h>

#include "layers/columns/columns.h"

/** Scratch of one thread, and the points of the three columns of a face. */
struct vg_stack {
  const struct vg_column *c[3];
  int order[3]; /* Corners by increasing column number. */
  double d[3][VG_LEVELS_MAX + 1];
  double x[3][VG_LEVELS_MAX + 1][3];
};

/** First level below an inverted or too flat cell of face f, whether the cells
 * are written as tetrahedra or mixed; -1 if all cells are sound.
 * @param faulty  out, if there is such a level: bit k: corner k is at fault */
int vg_stack_first_bad(struct vg_stack *s, const struct vg_columns *c,
                       const struct vg_mesh *m, size_t f, uint8_t *faulty);

#endif
