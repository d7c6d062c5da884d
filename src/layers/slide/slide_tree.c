/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A tree of boxes in the plane, ordered along a Morton curve. The order
 * determines which of several faults of a boundary is found first and thus
 * reported. */
#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "layers/slide/slide_parts.h"

/* Morton codes of the centres of the boxes. */
static void make_keys(size_t n, const struct vg_box *box, struct vg_key *key)
{
  struct vg_box all = VG_BOX_EMPTY;
  double scale[2];

  for (size_t i = 0; i < n; i++) vg_box_join(&all, &box[i]);
  for (int k = 0; k < 2; k++)
    scale[k] = all.hi[k] > all.lo[k] ? 4294967295. / (all.hi[k] - all.lo[k])
                                     : 0;
  for (size_t i = 0; i < n; i++) {
    uint64_t c[2];

    for (int k = 0; k < 2; k++)
      c[k] = (uint64_t)((0.5 * (box[i].lo[k] + box[i].hi[k]) - all.lo[k]) *
                        scale[k]);
    key[i].key = vg_interleave2(c[0]) | vg_interleave2(c[1]) << 1;
    key[i].index = (uint32_t)i;
  }
}

vg_status vg_slide_tree(struct vg_box_tree *t, size_t n,
                        const struct vg_box *box, struct vg_error *err)
{
  assert(box || !n);

  struct vg_key *key = vg_alloc(n, sizeof *key);
  uint32_t *order = vg_alloc(n, sizeof *order);
  vg_status st;

  if (!key || !order) VG_TRY(vg_fail_memory(err, "a slide patch"));
  make_keys(n, box, key);
  if (n) VG_TRY(vg_sort_keys(n, key, err));
  for (size_t i = 0; i < n; i++) order[i] = key[i].index;
  VG_TRY(vg_box_tree_build_items(t, n, box, order, err));
done:
  free(key);
  free(order);
  return st;
}
