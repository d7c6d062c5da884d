/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/search/box_tree.h"

#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"

static void find_middle(const struct vg_box *b, double x[3])
{
  for (int k = 0; k < 3; k++) x[k] = .5 * b->lo[k] + .5 * b->hi[k];
}

static vg_status order_items(size_t n, const struct vg_box *box, uint32_t *item,
                             struct vg_error *err)
{
  double(*middle)[3] = vg_alloc(n, sizeof *middle);
  vg_status st;

  if (!middle) return vg_fail_memory(err, "a tree of boxes");
  for (size_t i = 0; i < n; i++) find_middle(&box[i], middle[i]);
  st = vg_hilbert_order(n, (const double(*)[3])middle, item, err);
  free(middle);
  return st;
}

/* Sort the boxes key[].index along the Hilbert curve through the bounding cube
 * of their centres, then recursively each run of boxes with equal keys. */
static vg_status order_run(const struct vg_box *box, size_t n,
                           struct vg_key *key, struct vg_error *err)
{
  struct vg_box all = VG_BOX_EMPTY;
  double x[3], side = 0;
  vg_status st;

  for (size_t i = 0; i < n; i++) {
    find_middle(&box[key[i].index], x);
    vg_box_add(&all, x);
  }
  for (int k = 0; k < 3; k++)
    if (all.hi[k] - all.lo[k] > side) side = all.hi[k] - all.lo[k];
  if (!(side > 0) || isinf(side)) return VG_OK;
  for (size_t i = 0; i < n; i++) {
    find_middle(&box[key[i].index], x);
    key[i].key = vg_hilbert_key(x, all.lo, (1 << 20) / side);
  }
  st = vg_sort_keys(n, key, err);
  for (size_t i = 0, end; i < n && st >= 0; i = end) {
    for (end = i + 1; end < n && key[end].key == key[i].key;) end++;
    if (end - i > VG_BOX_LEAF && end - i < n)
      st = order_run(box, end - i, key + i, err);
  }
  return st;
}

vg_status vg_box_order(size_t n, const struct vg_box *box, uint32_t *order,
                       struct vg_error *err)
{
  struct vg_key *key = vg_alloc(n, sizeof *key);
  vg_status st;

  if (!key) return vg_fail_memory(err, "a tree of boxes");
  for (size_t i = 0; i < n; i++) key[i] = (struct vg_key){ 0, (uint32_t)i };
  st = order_run(box, n, key, err);
  for (size_t i = 0; i < n && st >= 0; i++) order[i] = key[i].index;
  free(key);
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
  if (!made.item || !made.node) VG_TRY(vg_fail_memory(err, "a tree of boxes"));
  if (!order) VG_TRY(order_items(n, box, made.item, err));
  for (size_t i = 0; order && i < n; i++) made.item[i] = order[i];
  make_boxes(&made, box);
  *t = made;
  made = (struct vg_box_tree)VG_BOX_TREE_INIT;
done:
  vg_box_tree_release(&made);
  return st;
}

vg_status vg_box_tree_build_items(struct vg_box_tree *t, size_t n,
                                  const struct vg_box *box,
                                  const uint32_t *order, struct vg_error *err)
{
  struct vg_box *kept = vg_alloc(n, sizeof *kept);
  vg_status st;

  if (!kept) VG_TRY(vg_fail_memory(err, "a tree of boxes"));
  VG_TRY(vg_box_tree_build(t, n, box, order, sizeof *box, err));
  for (size_t i = 0; i < n; i++) kept[i] = box[t->item[i]];
  t->box = kept;
  return VG_OK;
done:
  free(kept);
  return st;
}

void vg_box_tree_release(struct vg_box_tree *t)
{
  free(t->item);
  free(t->box);
  free(t->node);
  *t = (struct vg_box_tree)VG_BOX_TREE_INIT;
}

/* Search for items whose boxes touch a given box. */
struct touched {
  const struct vg_box_tree *t;
  const struct vg_box *box;
  int (*visit)(void *context, uint32_t item);
  void *context;
};

static inline int enter_touched(void *context, size_t node)
{
  const struct touched *x = context;

  return vg_box_touch(vg_box_tree_node(x->t, node), x->box);
}

static inline int visit_leaf(void *context, size_t node)
{
  const struct touched *x = context;
  const size_t end = vg_box_tree_end(x->t, node);
  int found = 0;

  for (size_t i = vg_box_tree_first(x->t, node); i < end && !found; i++)
    if (vg_box_touch(&x->t->box[i], x->box))
      found = x->visit(x->context, x->t->item[i]);
  return found;
}

int vg_box_tree_touched(const struct vg_box_tree *t, const struct vg_box *box,
                        int (*visit)(void *context, uint32_t item),
                        void *context)
{
  struct touched x = { t, box, visit, context };

  return vg_box_tree_visit(t, enter_touched, visit_leaf, &x);
}
