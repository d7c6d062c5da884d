/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "layers/clear/clear_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"
#include "core/geometry/hilbert.h"

enum { GRAIN = 4096, STACK = 96 };

struct build {
  struct vg_boxes *b;
  const double (*point)[3];
  const uint32_t (*tri)[3];
  const uint32_t *id;
  struct vg_key *key;
  double grow, lo[3], scale;
  int level;
};

void vg_boxes_release(struct vg_boxes *b)
{
  free(b->item);
  free(b->tri);
  free(b->node);
  memset(b, 0, sizeof *b);
}

static inline void tri_box(const double (*point)[3], const uint32_t t[3],
                           double box[6])
{
  const double *p = point[t[0]], *q = point[t[1]], *r = point[t[2]];

  for (int k = 0; k < 3; k++) {
    double lo = p[k] < q[k] ? p[k] : q[k], hi = p[k] < q[k] ? q[k] : p[k];

    box[k] = lo < r[k] ? lo : r[k];
    box[k + 3] = hi > r[k] ? hi : r[k];
  }
}

static inline void tri_box_float(const struct vg_boxes *b,
                                 const double (*point)[3], const uint32_t t[3],
                                 double grow, float box[6])
{
  double x[6], side = 0;

  tri_box(point, t, x);
  if (grow > 0)
    for (int k = 0; k < 3; k++)
      if (x[k + 3] - x[k] > side) side = x[k + 3] - x[k];
  for (int k = 0; k < 3; k++) {
    box[k] = (float)(x[k] - grow * side - b->origin[k]);
    box[k + 3] = (float)(x[k + 3] + grow * side - b->origin[k]);
  }
}

/* --- building ------------------------------------------------------------ */

static void make_keys(void *context, size_t first, size_t end, int worker)
{
  struct build *x = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    uint32_t t = x->id ? x->id[i] : (uint32_t)i;
    uint64_t key = 0;
    double box[6];

    tri_box(x->point, x->tri[t], box);
    for (int k = 0; k < 3; k++) {
      double q = (0.5 * (box[k] + box[k + 3]) - x->lo[k]) * x->scale;

      /* 18 bits each, which saves one round of sorting. Items closer than 4e-6
       * of the extent may stay in their given order. */
      key |= vg_interleave3(!(q > 0)      ? 0
                            : q >= 262143 ? 262143
                                          : (uint64_t)q)
          << k;
    }
    x->key[i] = (struct vg_key){ key, t };
  }
}

static void find_bounds(struct build *x, size_t n)
{
  double lo[3] = { 0, 0, 0 }, hi[3] = { 0, 0, 0 }, side = 0;

  for (size_t i = 0; i < n; i++) {
    double box[6];

    tri_box(x->point, x->tri[x->id ? x->id[i] : i], box);
    for (int k = 0; k < 3; k++) {
      if (!i || box[k] < lo[k]) lo[k] = box[k];
      if (!i || box[k + 3] > hi[k]) hi[k] = box[k + 3];
    }
  }
  x->b->extent = 0;
  for (int k = 0; k < 3; k++) {
    x->lo[k] = lo[k];
    x->b->origin[k] = 0.5 * lo[k] + 0.5 * hi[k];
    if (hi[k] - lo[k] > side) side = hi[k] - lo[k];
  }
  x->b->extent = (float)(0.5 * side);
  x->scale = side > 0 ? 262144 / side : 0;
}

static void make_leaves(void *context, size_t first, size_t end, int worker)
{
  struct build *x = context;
  struct vg_boxes *b = x->b;

  (void)worker;
  for (size_t j = first; j < end; j++)
    for (size_t i = 0; i < 8; i++) {
      float box[6] = { INFINITY,  INFINITY,  INFINITY,
                       -INFINITY, -INFINITY, -INFINITY };

      if (8 * j + i < b->n) {
        uint32_t t = x->key[8 * j + i].index;

        b->item[8 * j + i] = t;
        memcpy(b->tri[8 * j + i], x->tri[t], sizeof *b->tri);
        tri_box_float(b, x->point, x->tri[t], x->grow, box);
      }
      for (int k = 0; k < 3; k++) {
        b->node[j].lo[k].f[i] = box[k];
        b->node[j].hi[k].f[i] = box[k + 3];
      }
    }
}

static void node_box(const struct vg_box8 *n, float box[6])
{
  for (int k = 0; k < 3; k++) {
    float lo = n->lo[k].f[0], hi = n->hi[k].f[0];

    for (int i = 1; i < 8; i++) {
      if (n->lo[k].f[i] < lo) lo = n->lo[k].f[i];
      if (n->hi[k].f[i] > hi) hi = n->hi[k].f[i];
    }
    box[k] = lo;
    box[k + 3] = hi;
  }
}

static void make_parents(void *context, size_t first, size_t end, int worker)
{
  struct build *x = context;
  struct vg_boxes *b = x->b;
  size_t below = b->first[x->level - 1], own = b->first[x->level];

  (void)worker;
  for (size_t j = first; j < end; j++)
    for (size_t i = 0; i < 8; i++) {
      float box[6] = { INFINITY,  INFINITY,  INFINITY,
                       -INFINITY, -INFINITY, -INFINITY };

      if (below + 8 * j + i < own) node_box(&b->node[below + 8 * j + i], box);
      for (int k = 0; k < 3; k++) {
        b->node[own + j].lo[k].f[i] = box[k];
        b->node[own + j].hi[k].f[i] = box[k + 3];
      }
    }
}

vg_status vg_boxes_build(struct vg_boxes *b, const double (*point)[3],
                         const uint32_t (*tri)[3], size_t n, const uint32_t *id,
                         double grow, int threads, struct vg_error *err)
{
  struct build x = { b, point, tri, id, NULL, grow, { 0 }, 0, 0 };
  size_t count = n, total = 0, size[12];
  vg_status st = VG_OK;

  assert(!b->item && !b->node);
  assert(point && tri && grow >= 0 && threads >= 0);
  memset(b, 0, sizeof *b);
  b->n = n;
  if (!n) return VG_OK;
  do {
    count = (count + 7) / 8;
    size[b->n_level] = count;
    b->first[b->n_level++] = total;
    total += count;
  } while (count > 1);
  x.key = vg_alloc(n, sizeof *x.key);
  b->item = vg_alloc(n, sizeof *b->item);
  b->tri = vg_alloc(n, sizeof *b->tri);
  b->node = vg_alloc(total, sizeof *b->node);
  if (!x.key || !b->item || !b->tri || !b->node) {
    st = vg_fail_memory(err, "boxes about triangles");
    goto done;
  }
  find_bounds(&x, n);
  vg_parallel_for(threads, n, GRAIN, make_keys, &x);
  VG_TRY(vg_sort_keys(n, x.key, err));
  vg_parallel_for(threads, size[0], GRAIN / 8, make_leaves, &x);
  for (x.level = 1; x.level < b->n_level; x.level++)
    vg_parallel_for(threads, size[x.level], GRAIN / 8, make_parents, &x);
done:
  free(x.key);
  if (st < 0) vg_boxes_release(b);
  return st;
}

/* --- queries ------------------------------------------------------------- */

static inline vg_i4 touch4(const struct vg_box8 *n, int h, const float q[6])
{
  vg_f4 lo[3], hi[3];

  for (int k = 0; k < 3; k++) {
    lo[k] = (vg_f4){ q[k], q[k], q[k], q[k] };
    hi[k] = (vg_f4){ q[k + 3], q[k + 3], q[k + 3], q[k + 3] };
  }
  return (n->lo[0].v[h] <= hi[0]) & (n->hi[0].v[h] >= lo[0]) &
         (n->lo[1].v[h] <= hi[1]) & (n->hi[1].v[h] >= lo[1]) &
         (n->lo[2].v[h] <= hi[2]) & (n->hi[2].v[h] >= lo[2]);
}

/* Bit i: child i touches the box. */
static inline unsigned touch8(const struct vg_box8 *n, const float q[6])
{
  return vg_lanes(touch4(n, 0, q), touch4(n, 1, q));
}

struct pairs {
  const struct vg_boxes *b;
  vg_boxes_visit visit;
  void *context;
};

/* Pairs of items of leaf l with those of leaf m >= l. */
static void leaf_pairs(const struct pairs *p, size_t l, size_t m)
{
  const struct vg_box8 *own = &p->b->node[l], *other = &p->b->node[m];

  for (size_t i = 0; i < 8 && 8 * l + i < p->b->n; i++) {
    float q[6] = { own->lo[0].f[i], own->lo[1].f[i], own->lo[2].f[i],
                   own->hi[0].f[i], own->hi[1].f[i], own->hi[2].f[i] };
    unsigned mask = touch8(other, q);

    if (l == m) mask &= ~0u << (i + 1);
    for (; mask; mask &= mask - 1)
      p->visit(p->context, 8 * l + i, 8 * m + (size_t)__builtin_ctz(mask));
  }
}

static void pairs_of_leaves(void *context, size_t first, size_t end, int worker)
{
  const struct pairs *p = context;
  const struct vg_boxes *b = p->b;

  (void)worker;
  for (size_t l = first; l < end; l++) {
    struct {
      int level;
      size_t at;
    } stack[STACK] = { { b->n_level - 1, 0 } };
    int depth = 1;
    float q[6];

    node_box(&b->node[l], q);
    while (depth--) {
      int level = stack[depth].level;
      size_t at = stack[depth].at;
      unsigned mask;

      /* The leaves below are at .. at + 1 times 8^level; skip if all are before
       * l. */
      if (((at + 1) << 3 * level) <= l) continue;
      if (!level) {
        leaf_pairs(p, l, at);
        continue;
      }
      mask = touch8(&b->node[b->first[level] + at], q);
      for (; mask; mask &= mask - 1) {
        stack[depth].level = level - 1;
        stack[depth++].at = 8 * at + (size_t)__builtin_ctz(mask);
      }
    }
  }
}

void vg_boxes_pairs(const struct vg_boxes *b, int threads, vg_boxes_visit visit,
                    void *context)
{
  struct pairs p = { b, visit, context };

  assert(visit && threads >= 0);
  vg_parallel_for(threads, (b->n + 7) / 8, 256, pairs_of_leaves, &p);
}

void vg_boxes_touch(const struct vg_boxes *b, const double (*point)[3],
                    const uint32_t t[3], vg_boxes_visit visit, void *context,
                    size_t tag)
{
  assert(visit);
  struct {
    int level;
    size_t at;
  } stack[STACK] = { { b->n_level - 1, 0 } };
  int depth = 1;
  float q[6];

  if (!b->n) return;
  tri_box_float(b, point, t, 0, q);
  while (depth--) {
    int level = stack[depth].level;
    size_t at = stack[depth].at;
    unsigned mask = touch8(&b->node[b->first[level] + at], q);

    for (; mask; mask &= mask - 1) {
      size_t child = 8 * at + (size_t)__builtin_ctz(mask);

      if (level) {
        stack[depth].level = level - 1;
        stack[depth++].at = child;
      } else {
        visit(context, child, tag);
      }
    }
  }
}
