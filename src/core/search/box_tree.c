#include "core/search/box_tree.h"

#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"

static vg_status order_items(size_t n, const struct vg_box *box,
                             uint32_t *item, struct vg_error *err)
{
  double (*middle)[3] = vg_alloc(n, sizeof *middle);
  vg_status st;

  if (!middle) return vg_fail_memory(err, "a tree of boxes");
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      middle[i][k] = (box[i].lo[k] + box[i].hi[k]) / 2;
  st = vg_hilbert_order(n, (const double (*)[3])middle, item, err);
  free(middle);
  return st;
}

static void make_boxes(struct vg_box_tree *t, const struct vg_box *box)
{
  for (size_t i = 2 * t->first_leaf + 1; i-- > 0;) {
    struct vg_box *b = vg_box_tree_node(t, i);

    *b = (struct vg_box)VG_BOX_EMPTY;
    if (i < t->first_leaf) {
      vg_box_join(b, vg_box_tree_node(t, 2 * i + 1));
      vg_box_join(b, vg_box_tree_node(t, 2 * i + 2));
    } else {
      for (size_t k = vg_box_tree_first(t, i); k < vg_box_tree_end(t, i); k++)
        vg_box_join(b, &box[t->item[k]]);
    }
  }
}

vg_status vg_box_tree_build(struct vg_box_tree *t, size_t n,
                            const struct vg_box *box, const uint32_t *order,
                            size_t stride, struct vg_error *err)
{
  struct vg_box_tree made = { .n = n, .stride = stride };
  size_t n_leaf = 1;
  vg_status st = VG_OK;

  while (VG_BOX_LEAF * n_leaf < n) n_leaf *= 2;
  made.first_leaf = n_leaf - 1;
  made.item = vg_alloc(n, sizeof *made.item);
  made.node = vg_alloc(2 * n_leaf - 1, stride);
  if (!made.item || !made.node)
    VG_TRY(vg_fail_memory(err, "a tree of boxes"));
  if (!order) VG_TRY(order_items(n, box, made.item, err));
  for (size_t i = 0; order && i < n; i++) made.item[i] = order[i];
  make_boxes(&made, box);
  *t = made;
  made = (struct vg_box_tree)VG_BOX_TREE_INIT;
done:
  vg_box_tree_release(&made);
  return st;
}

void vg_box_tree_release(struct vg_box_tree *t)
{
  free(t->item);
  free(t->node);
  *t = (struct vg_box_tree)VG_BOX_TREE_INIT;
}
