/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/search/box_tree.h: a tree of the bounding boxes of items, for overlap
 * and distance queries.
 *
 * The tree is a full binary tree in an array: the children of node i are nodes
 * 2 i + 1 and 2 i + 2. Each leaf holds the next VG_BOX_LEAF items of an order
 * that keeps neighbouring items together: an order given by the caller, or the
 * Hilbert curve through the centres of the boxes. The tree and the query
 * results depend only on the boxes and that order. Leaves after the last item
 * have empty boxes.
 *
 * A node may hold more data than its box. It is then a struct that begins with
 * the box. The caller passes the size of the struct to vg_box_tree_build and
 * fills its other members.
 *
 * The searches are inline functions that take callbacks, so that the compiler
 * merges both into one loop. */
#ifndef VG_CORE_SEARCH_BOX_TREE_H
#define VG_CORE_SEARCH_BOX_TREE_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/search/box.h"

#define VG_BOX_LEAF 4   /* items per leaf */
#define VG_BOX_DEPTH 64 /* maximum number of levels */

struct vg_box_tree {
  size_t n;           /* number of items */
  size_t first_leaf;  /* index of the first leaf: number of leaves less one */
  size_t stride;      /* bytes from one node to the next */
  void *node;         /* [2 first_leaf + 1] owned; each node begins with a
                         struct vg_box */
  uint32_t *item;     /* [n] owned; items in the order of the leaves */
  struct vg_box *box; /* [n] owned; boxes of the items in that order, stored
                         by vg_box_tree_build_items; else NULL */
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

/** Index after the last item of leaf `node`; not more than that of the first
 * item if the leaf is empty. */
static inline size_t vg_box_tree_end(const struct vg_box_tree *t, size_t node)
{
  size_t end = vg_box_tree_first(t, node) + VG_BOX_LEAF;

  return end < t->n ? end : t->n;
}

/** Order boxes along the Hilbert curve through their centres, at any scale.
 * Boxes with centres in the same one of the 2^20 cells per side of the curve
 * are ordered along a curve of their own. A single box far away therefore does
 * not spoil the order of the other boxes. O(n log n) for typical
 * distributions.
 *
 * @param box    [n] finite
 * @param order  out: [n] a permutation of 0 .. n - 1
 *
 * VG_ERR_MEMORY. */
vg_status vg_box_order(size_t n, const struct vg_box *box, uint32_t *order,
                       struct vg_error *err);

/** Build a tree over n boxes; n = 0 is allowed.
 *
 * @param t       out: the tree, released by the caller
 * @param box     [n] finite; borrowed for the call
 * @param order   [n] items in the order of the leaves; NULL: along the Hilbert
 *                curve through the centres of the boxes, items in the same
 *                cell of the curve in their given order
 * @param stride  bytes per node, at least sizeof(struct vg_box)
 *
 * Threads: many threads may search a tree once it is built. O(n log n).
 * VG_ERR_MEMORY. */
vg_status vg_box_tree_build(struct vg_box_tree *t, size_t n,
                            const struct vg_box *box, const uint32_t *order,
                            size_t stride, struct vg_error *err);

/** As vg_box_tree_build, with nodes that hold only a box. The tree keeps the
 * boxes of the items in t->box, for searches that test them. */
vg_status vg_box_tree_build_items(struct vg_box_tree *t, size_t n,
                                  const struct vg_box *box,
                                  const uint32_t *order, struct vg_error *err);

void vg_box_tree_release(struct vg_box_tree *t);

/** Visit the items whose boxes touch `box`, in the order of the leaves.
 *
 * @param t      built by vg_box_tree_build_items
 * @param visit  a nonzero return value ends the search
 *
 * Returns the value of the last call of `visit`, 0 if it was never called. */
int vg_box_tree_touched(const struct vg_box_tree *t, const struct vg_box *box,
                        int (*visit)(void *context, uint32_t item),
                        void *context);

/** Visit leaves depth first, left children before right ones.
 *
 * @param enter  decides whether a node is searched; 0 prunes it
 * @param leaf   called for each leaf that was entered; nonzero ends the search
 *
 * Returns the value of the last call of `leaf`. */
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

/** Visit leaves, the child nearer to x first. If both children are equally
 * near, the left one comes first.
 *
 * @param enter  decides whether the node at squared distance d2 from x is
 *               searched. It is called just before the node would be entered,
 *               so that it can compare d2 with the best result so far
 * @param leaf   called for each leaf that was entered */
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
