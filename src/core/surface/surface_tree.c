/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Tree of the bounding boxes of surface triangles. */
#include "core/surface/surface_parts.h"

#include <stdlib.h>

#include "base/memory.h"

vg_status vg_faces_tree(struct vg_box_tree *t, const struct vg_faces *s,
                        struct vg_error *err)
{
  struct vg_box *box = vg_alloc(s->n, sizeof *box);
  uint32_t *face = vg_alloc(s->n, sizeof *face);
  uint32_t *order = vg_alloc(s->n, sizeof *order);
  size_t n = 0;
  vg_status st;

  if (!box || !face || !order)
    VG_TRY(vg_fail_memory(err, "the search tree of the surface"));
  for (size_t f = 0; f < s->n; f++) {
    if (s->state[f]) continue;
    box[n] = (struct vg_box)VG_BOX_EMPTY;
    for (int k = 0; k < 3; k++) vg_box_add(&box[n], s->point[s->node[f][k]]);
    face[n++] = (uint32_t)f;
  }
  VG_TRY(vg_box_order(n, box, order, err));
  VG_TRY(vg_box_tree_build_items(t, n, box, order, err));
  for (size_t i = 0; i < n; i++) t->item[i] = face[t->item[i]];
done:
  free(box);
  free(face);
  free(order);
  return st;
}
