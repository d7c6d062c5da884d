/* layers/clear/clear_parts.h: boxes about triangles, for clear*.c. Not for
 * users of the library.
 *
 * A tree with eight children per node, filled from items in Morton order, so
 * that neither pointers nor a search for the best split are needed: built in
 * linear time, twice the memory of the boxes of single precision.
 *
 * It stays next to core/search/box_tree.h because it tests eight boxes at once:
 * on 1,155,200 triangles it is built in 0.08 s and finds the 7.0 million pairs
 * in 0.13 s, where the shared tree takes 0.30 and 0.28 s (one thread,
 * 2026-11-26). */
#ifndef VG_LAYERS_CLEAR_CLEAR_PARTS_H
#define VG_LAYERS_CLEAR_CLEAR_PARTS_H

#include <assert.h>

#include "layers/clear/clear.h"

/* Four lanes at a time, as GCC and Clang spell it for any processor. */
typedef float vg_f4 __attribute__((vector_size(16)));
typedef int32_t vg_i4 __attribute__((vector_size(16)));

union vg_f8 {
  float f[8];
  vg_f4 v[2];
};

/* Children of a node, side by side so that all eight are tested at once.
 * Those that do not exist are empty: lo > hi. */
struct vg_box8 {
  union vg_f8 lo[3], hi[3];
};

/* Bit i: lane i of a (4 .. 7: of b) is true. */
static inline unsigned vg_lanes(vg_i4 a, vg_i4 b)
{
  vg_i4 m = (a & (vg_i4){ 1, 2, 4, 8 }) | (b & (vg_i4){ 16, 32, 64, 128 });

  return (unsigned)(m[0] | m[1] | m[2] | m[3]);
}

/* Coordinates are those of the input minus `origin`, rounded to float.
 * Rounding is monotone, so boxes that touch do so after it as well: queries
 * that compare bounds alone miss nothing. */
struct vg_boxes {
  size_t n;
  double origin[3];
  float extent;         /* largest |coordinate| */
  uint32_t *item;       /* [n] triangle */
  uint32_t (*tri)[3];   /* [n] its nodes */
  struct vg_box8 *node; /* leaves first, then their parents, ... */
  size_t first[12];     /* node with which a level starts; node j of level
                           l has as children nodes 8 j ... of l - 1, or
                           items 8 j ... for l = 0 */
  int n_level;
};
#define VG_BOXES_INIT                                                          \
  {                                                                            \
    0                                                                          \
  }

typedef void (*vg_boxes_visit)(void *context, size_t i, size_t j);

/** Over triangles tri[id[0 .. n - 1]] (id NULL: 0 .. n - 1) with nodes in
 * point, all finite. Each box is widened by `grow` times its longest side. */
vg_status vg_boxes_build(struct vg_boxes *b, const double (*point)[3],
                         const uint32_t (*tri)[3], size_t n, const uint32_t *id,
                         double grow, int threads, struct vg_error *err);

void vg_boxes_release(struct vg_boxes *b);

/** visit(context, i, j), i < j, for all pairs of positions (index into item)
 * whose boxes touch, once each, from several threads. */
void vg_boxes_pairs(const struct vg_boxes *b, int threads, vg_boxes_visit visit,
                    void *context);

/** visit(context, i, tag) for all positions whose box touches that about
 * triangle t. */
void vg_boxes_touch(const struct vg_boxes *b, const double (*point)[3],
                    const uint32_t t[3], vg_boxes_visit visit, void *context,
                    size_t tag);

/* clear_sides.c ----------------------------------------------------------*/

/* Tops and the surface in one numbering: a column without a level is its
 * root, others are n_point + column. */
struct vg_tops {
  const struct vg_mesh *surface;
  const struct vg_columns *columns;
  const uint8_t *active; /* [n_column], or NULL */
  size_t n_point;        /* of the surface */
  double (*point)[3];    /* [n_point + n_column] */
  uint32_t *node;        /* [n_column] */
  uint8_t *bad;          /* [n_column] set by any thread */
  int threads;
};

static inline int vg_tops_active(const struct vg_tops *t, uint32_t c)
{
  assert(c < t->columns->n_column);
  return !t->active || t->active[c];
}

/** Columns that can be lowered only: one that has no level is no culprit. */
static inline void vg_tops_mark(const struct vg_tops *t, uint32_t c)
{
  assert(c < t->columns->n_column);
  if (t->columns->column[c].n)
    __atomic_store_n(&t->bad[c], 1, __ATOMIC_RELAXED);
}

/** Mark borders of one patch whose flanks overlap within it. */
vg_status vg_clear_flanks(const struct vg_tops *t, struct vg_error *err);

#endif
