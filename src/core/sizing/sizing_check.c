/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Check that the octree of spacings is a valid tree, and that every spacing is
 * a number (base/checks.h). */
#include "core/geometry/tensor.h"
#include "core/sizing/sizing_octree.h"

static size_t bad_entry(const struct vg_octree *t, uint32_t e, size_t above)
{
  if (e & VG_OCTREE_LEAF) return (e & VG_OCTREE_LEAF_INDEX) >= t->n_leaf;
  return e >= t->n_split || (above != SIZE_MAX && e <= above);
}

/* Defects of the leaf of entry e, if it is one. */
static size_t bad_leaf(const struct vg_octree *t, uint32_t e)
{
  const union vg_octree_leaf *leaf = t->leaf + (e & VG_OCTREE_LEAF_INDEX);
  size_t bad = 0;

  if (!(e & VG_OCTREE_LEAF)) return 0;
  for (int k = 0; k < 8; k++)
    bad += e & VG_OCTREE_TENSOR ? leaf->corner[k] >= t->n_tensor
                                : !(leaf->h[k] >= 0);
  return bad;
}

size_t vg_octree_defects(const struct vg_octree *t)
{
  size_t bad = bad_entry(t, t->root, SIZE_MAX);

  for (size_t i = 0; i < t->n_split; i++) {
    bad += !(t->least[i] >= 0);
    for (int k = 0; k < 8; k++)
      bad += bad_entry(t, t->child[i][k], i) || bad_leaf(t, t->child[i][k]);
  }
  if (t->root & VG_OCTREE_LEAF) bad += bad_leaf(t, t->root);
  for (size_t i = 0; i < t->n_tensor; i++) {
    double h[6];

    for (int k = 0; k < 6; k++) h[k] = (double)t->tensor[i][k];
    bad += !(h[0] > 0 && h[0] * h[3] > h[1] * h[1] && vg_tensor_det(h) > 0);
  }
  return bad;
}
