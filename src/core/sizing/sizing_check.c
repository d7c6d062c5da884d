/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Check that the octree of spacings is a valid tree, and that every spacing is
 * a number (base/checks.h). */
#include "core/sizing/sizing_octree.h"

static size_t bad_entry(const struct vg_octree *t, uint32_t e, size_t above)
{
  if (e & VG_OCTREE_LEAF) return (e & ~VG_OCTREE_LEAF) >= t->n_leaf;
  return e >= t->n_split || (above != SIZE_MAX && e <= above);
}

size_t vg_octree_defects(const struct vg_octree *t)
{
  size_t bad = bad_entry(t, t->root, SIZE_MAX);

  for (size_t i = 0; i < t->n_split; i++) {
    bad += !(t->least[i] >= 0);
    for (int k = 0; k < 8; k++) bad += bad_entry(t, t->child[i][k], i);
  }
  for (size_t i = 0; i < t->n_leaf; i++)
    for (int k = 0; k < 8; k++) bad += !(t->leaf[i][k] >= 0);
  return bad;
}
