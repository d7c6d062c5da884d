/* core/search/box_tree.h: a tree of boxes about items, for questions of overlap
 * and distance.
 *
 * The tree is a full binary tree in an array: the children of node i are
 * 2 i + 1 and 2 i + 2. Each leaf has the next VG_BOX_LEAF items of an order
 * that keeps near items together: the caller's, or the Hilbert curve through
 * the middles of the boxes. Tree and answers follow from the boxes and that
 * order alone. Leaves behind the last item have empty boxes.
 *
 * A user may keep more in a node than its box: a structure that begins with
 * the box, whose size the user gives to vg_box_tree_build and whose other
 * members the user fills.
 *
 * The searches are inline functions that take functions: the compiler makes
 * one loop of both. */
#ifndef VG_CORE_SEARCH_BOX_TREE_H
#define VG_CORE_SEARCH_BOX_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/search/box.h"

#define VG_BOX_LEAF 4   /* items of a leaf */
#define VG_BOX_DEPTH 64 /* levels at most */

struct vg_box_tree {
  size_t n;           /* items */
  size_t first_leaf;  /* nodes before the leaves: leaves less one */
  size_t stride;      /* bytes from node to node */
  void *node;         /* [2 first_leaf + 1] owned; each begins with a
                         struct vg_box */
  uint32_t *item;     /* [n] owned; items in the order of the leaves */
  struct vg_box *box; /* [n] owned; their boxes in that order, or NULL:
                         vg_box_tree_build_items keeps them */
};
#define VG_BOX_TREE_INIT                                                       \
  {                                                                            \
    0                                                                          \
  }

/** Box of node i. */
static inline struct vg_box *vg_box_tree_node(const struct vg_box_tree *t,
                                              size_t i)
{
  return (struct vg_box *)(void *)((char *)t->node + i * t->stride);
}

/** Index of the first item of leaf `node` in t->item. */
static inline size_t vg_box_tree_first(const struct vg_box_tree *t, size_t node)
{
  return VG_BOX_LEAF * (node - t->first_leaf);
}

/** Index behind its last item; not more than the first for an empty leaf. */
static inline size_t vg_box_tree_end(const struct vg_box_tree *t, size_t node)
{
  size_t end = vg_box_tree_first(t, node) + VG_BOX_LEAF;

  return end < t->n ? end : t->n;
}

/** Order boxes along the Hilbert curve through their middles, at any scale:
 * runs of boxes that the 2^20 cells per side of the curve do not tell apart
 * are ordered along a curve of their own, so that one box far away does not
 * spoil the order of the others. O(n log n) at the usual scales.
 *
 * @param box    [n] finite
 * @param order  out: [n] a permutation of 0 .. n - 1
 *
 * VG_ERR_MEMORY. */
vg_status vg_box_order(size_t n, const struct vg_box *box, uint32_t *order,
                       struct vg_error *err);

/** Build a tree over n boxes; 0 is allowed.
 *
 * @param t       out: the tree, which the caller releases
 * @param box     [n] finite; borrowed for the call
 * @param order   [n] items in the order of the leaves; NULL: along the Hilbert
 *                curve through the boxes' middles, equal places in the
 *                order given
 * @param stride  bytes of a node, sizeof(struct vg_box) or more
 *
 * Threads: a tree that is built can be searched by many. O(n log n).
 * VG_ERR_MEMORY. */
vg_status vg_box_tree_build(struct vg_box_tree *t, size_t n,
                            const struct vg_box *box, const uint32_t *order,
                            size_t stride, struct vg_error *err);

/** The same with nodes of boxes alone. The tree keeps the boxes of items in
 * t->box, for searches that test them. */
vg_status vg_box_tree_build_items(struct vg_box_tree *t, size_t n,
                                  const struct vg_box *box,
                                  const uint32_t *order, struct vg_error *err);

void vg_box_tree_release(struct vg_box_tree *t);

/** Visit the items whose boxes touch `box`, in the order of the leaves.
 *
 * @param t      built by vg_box_tree_build_items
 * @param visit  nonzero ends the search
 *
 * Returns what the last call of `visit` returned, 0 without one. */
int vg_box_tree_touched(const struct vg_box_tree *t, const struct vg_box *box,
                        int (*visit)(void *context, uint32_t item),
                        void *context);

/** Visit leaves depth first, left children before right ones.
 *
 * @param enter  is the node to be searched? 0 prunes it
 * @param leaf   gets a node that is a leaf; nonzero ends the search
 *
 * Returns what the last call of `leaf` returned. */
static inline __attribute__((always_inline)) int vg_box_tree_visit(
  const struct vg_box_tree *t, int (*enter)(void *context, size_t node),
  int (*leaf)(void *context, size_t node), void *context)
{
  size_t stack[VG_BOX_DEPTH];
  int top = 0, found = 0;

  if (t->n) stack[top++] = 0;
  while (top && !found) {
    const size_t i = stack[--top];

    if (!enter(context, i)) continue;
    if (i < t->first_leaf) {
      stack[top++] = 2 * i + 2;
      stack[top++] = 2 * i + 1;
    } else {
      found = leaf(context, i);
    }
  }
  return found;
}

/** Visit leaves, of the two children of a node the one nearer to x first, the
 * left one if both are as near.
 *
 * @param enter  is the node, at the squared distance d2 from x, to be searched?
 *               It is asked when its turn comes, so that it can compare with
 *               the best that was found meanwhile
 * @param leaf   gets a node that is a leaf */
static inline __attribute__((always_inline)) void vg_box_tree_approach(
  const struct vg_box_tree *t, const double x[3],
  int (*enter)(void *context, size_t node, double d2),
  void (*leaf)(void *context, size_t node), void *context)
{
  struct {
    size_t i;
    double d2;
  } stack[VG_BOX_DEPTH];
  int top = 0;

  if (!t->n) return;
  stack[top].i = 0;
  stack[top++].d2 = vg_box_distance2(vg_box_tree_node(t, 0), x);
  while (top) {
    const size_t i = stack[--top].i;

    if (!enter(context, i, stack[top].d2)) continue;
    if (i < t->first_leaf) {
      const double l = vg_box_distance2(vg_box_tree_node(t, 2 * i + 1), x);
      const double r = vg_box_distance2(vg_box_tree_node(t, 2 * i + 2), x);
      const int left = l <= r;

      stack[top].i = 2 * i + (left ? 2 : 1);
      stack[top++].d2 = left ? r : l;
      stack[top].i = 2 * i + (left ? 1 : 2);
      stack[top++].d2 = left ? l : r;
    } else {
      leaf(context, i);
    }
  }
}

#endif
