/* A tree of boxes in the plane. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>

#include "base/memory.h"
#include "core/geometry/hilbert.h"
#include "layers/slide/slide_parts.h"

enum { GROUP = 4, DEPTH = 64 };

struct key { uint64_t code; uint32_t item; };

static int compare(const void *a, const void *b)
{
  const struct key *p = a, *q = b;

  if (p->code != q->code) return p->code < q->code ? -1 : 1;
  return (p->item > q->item) - (p->item < q->item);
}

static void enclose(struct vg_box2 *a, const struct vg_box2 *b)
{
  for (int k = 0; k < 2; k++) {
    if (b->lo[k] < a->lo[k]) a->lo[k] = b->lo[k];
    if (b->hi[k] > a->hi[k]) a->hi[k] = b->hi[k];
  }
}

static const struct vg_box2 nothing = { { INFINITY, INFINITY },
                                        { -INFINITY, -INFINITY } };

/* Morton codes of the boxes' centres. */
static void make_keys(size_t n, const struct vg_box2 *box, struct key *key)
{
  struct vg_box2 all = nothing;
  double scale[2];

  for (size_t i = 0; i < n; i++) enclose(&all, &box[i]);
  for (int k = 0; k < 2; k++)
    scale[k] = all.hi[k] > all.lo[k]
               ? 4294967295. / (all.hi[k] - all.lo[k]) : 0;
  for (size_t i = 0; i < n; i++) {
    uint64_t c[2];

    for (int k = 0; k < 2; k++)
      c[k] = (uint64_t)((0.5 * (box[i].lo[k] + box[i].hi[k]) - all.lo[k])
                        * scale[k]);
    key[i].code = vg_interleave2(c[0]) | vg_interleave2(c[1]) << 1;
    key[i].item = (uint32_t)i;
  }
}

int vg_aabb_tree2_build(struct vg_aabb_tree2 *t, size_t n,
                        const struct vg_box2 *box)
{
  assert(box || !n);

  struct key *key = vg_alloc(n, sizeof *key);
  size_t n_leaf = 1;

  while (n_leaf * GROUP < n) n_leaf *= 2;
  t->node = vg_alloc(2 * n_leaf, sizeof *t->node);
  t->item = vg_alloc(n, sizeof *t->item);
  if (!key || !t->node || !t->item) {
    free(key);
    vg_aabb_tree2_release(t);
    return -1;
  }
  t->n = n;
  t->n_leaf = n_leaf;
  t->box = box;
  make_keys(n, box, key);
  qsort(key, n, sizeof *key, compare);
  for (size_t i = 0; i < 2 * n_leaf; i++) t->node[i] = nothing;
  for (size_t i = 0; i < n; i++) {
    t->item[i] = key[i].item;
    enclose(&t->node[n_leaf + i / GROUP], &box[key[i].item]);
  }
  for (size_t i = n_leaf - 1; i > 0; i--) {
    enclose(&t->node[i], &t->node[2 * i]);
    enclose(&t->node[i], &t->node[2 * i + 1]);
  }
  free(key);
  return 0;
}

void vg_aabb_tree2_release(struct vg_aabb_tree2 *t)
{
  free(t->node);
  free(t->item);
  *t = (struct vg_aabb_tree2)VG_TREE2_INIT;
}

static int overlap(const struct vg_box2 *a, const struct vg_box2 *b)
{
  return a->lo[0] <= b->hi[0] && b->lo[0] <= a->hi[0] && a->lo[1] <= b->hi[1]
         && b->lo[1] <= a->hi[1];
}

void vg_aabb_tree2_query(const struct vg_aabb_tree2 *t,
                         const struct vg_box2 *box,
                         void (*visit)(void *user, uint32_t item), void *user)
{
  size_t stack[DEPTH], n = 0;

  assert(box && visit);
  stack[n++] = 1;
  while (n && t->n) {
    const size_t i = stack[--n];

    if (!overlap(&t->node[i], box)) continue;
    if (i < t->n_leaf) {
      stack[n++] = 2 * i + 1;
      stack[n++] = 2 * i;
      continue;
    }
    for (size_t j = (i - t->n_leaf) * GROUP, k = 0; k < GROUP && j < t->n;
         j++, k++)
      if (overlap(&t->box[t->item[j]], box)) visit(user, t->item[j]);
  }
}
