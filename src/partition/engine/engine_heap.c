/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <assert.h>
#include <string.h>

#include "partition/engine/engine_parts.h"

int vg_heap_before(const struct vg_heap *a, const struct vg_heap *b)
{
  assert(a && b);
  if (a->key != b->key) return a->key > b->key;
  return strcmp(a->path, b->path) < 0;
}

static struct vg_heap *meld(struct vg_heap *a, struct vg_heap *b)
{
  struct vg_heap *first = a, *second = b;

  if (!a || !b) return a ? a : b;
  if (vg_heap_before(b, a)) first = b, second = a;
  second->next = first->child;
  first->child = second;
  return first;
}

void vg_heap_push(struct vg_heap **heap, struct vg_heap *item)
{
  assert(item && item->path);
  item->child = item->next = NULL;
  *heap = meld(*heap, item);
}

struct vg_heap *vg_heap_pop(struct vg_heap **heap)
{
  struct vg_heap *top = *heap, *pairs = NULL, *left;

  if (!top) return NULL;
  left = top->child;
  while (left) {
    struct vg_heap *a = left, *b = a->next, *pair;

    left = b ? b->next : NULL;
    a->next = NULL;
    if (b) b->next = NULL;
    pair = meld(a, b);
    pair->next = pairs;
    pairs = pair;
  }
  for (*heap = NULL; pairs; pairs = left) {
    left = pairs->next;
    pairs->next = NULL;
    *heap = meld(*heap, pairs);
  }
  assert(!*heap || !vg_heap_before(*heap, top));
  top->child = top->next = NULL;
  return top;
}
