/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/load/load_tree.h: an octree that distributes triangles to its
 * nodes, and determines for the lower corner of each node which void
 * contains it. For load.c and load_split.c.
 *
 * Coordinates are integers with 31 bits across the root octant, whose side is
 * a power of two and whose corner is a multiple of the unit. A point of
 * this lattice is therefore an exact double, and boxes can be compared as
 * integers. */
#ifndef VG_PARTITION_LOAD_LOAD_TREE_H
#define VG_PARTITION_LOAD_LOAD_TREE_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "core/front/front.h"
#include "partition/load/load.h"

enum { VG_LOAD_BITS = 31, VG_LOAD_LEVELS = 24, VG_LOAD_SAMPLES = 8 };

struct vg_load_tri {
  uint32_t lo[3], hi[3]; /* Bounding box, rounded down. */
  uint32_t child, face;
};

struct vg_load_tree {
  double lo[3], unit;
  const struct vg_front *child;
  size_t n_tri;
  struct vg_load_tri *tri; /* [n_tri] Triangles of all children. */
};

/** A node, the triangles that touch it, and the owner of its lower corner: 0 no
 * void, c + 1 child c. (Voids do not overlap. The owner is a sum over
 * crossings, so any other value shows that a front is not closed.) */
struct vg_load_node {
  uint32_t at[3];
  int level; /* side: 1 << (VG_LOAD_BITS - level) */
  int32_t owner;
  size_t first, n; /* Triangles in the stack. */
};

/** Triangle lists of the open nodes. */
struct vg_load_stack {
  size_t n, cap, cap_mask;
  uint32_t *item;
  uint8_t *mask;
};
#define VG_LOAD_STACK_INIT                                                     \
  {                                                                            \
    0, 0, 0, NULL, NULL                                                        \
  }

static inline uint32_t vg_load_side(const struct vg_load_node *node)
{
  assert(node->level >= 0 && node->level <= VG_LOAD_BITS);
  return (uint32_t)1 << (VG_LOAD_BITS - node->level);
}

/** Volume that a front encloses (0 for an empty front), and the bounding box of
 * its points. */
double vg_load_volume(const struct vg_front *v);
void vg_load_box(const struct vg_front *v, double lo[3], double hi[3]);

/** Adds the fronts of n voids; the caller sets t->lo and unit. */
vg_status vg_load_tree_new(struct vg_load_tree *t, size_t n,
                           const struct vg_front *child, int threads,
                           struct vg_error *err);
void vg_load_tree_release(struct vg_load_tree *t);

void vg_load_stack_release(struct vg_load_stack *s);

/** Makes the eight octants of a node. Their lists are pushed on the stack:
 * restore s->n afterwards. Returns -1 when memory is refused. */
int vg_load_octants(const struct vg_load_tree *t, struct vg_load_stack *s,
                    const struct vg_load_node *node, struct vg_load_node out[8],
                    int threads);

/** Determines the owner of each of 2 x 2 x 2 points of a node. The points are
 * shifted by an amount that depends on the node, so that errors of neighbours
 * along a plane wall do not add up. at out: the first point; the others are
 * half a node further, x first. */
void vg_load_sample(const struct vg_load_tree *t, const struct vg_load_stack *s,
                    const struct vg_load_node *node,
                    int32_t owner[VG_LOAD_SAMPLES], uint32_t at[3]);

/** Copies everything except the octants. */
void vg_load_copy_frame(const struct vg_load *from, struct vg_load *to);

/** Volume of all octants' fractions in the void. */
double vg_load_parts(const struct vg_load *l);

/** Scales the sampled fractions to `volume` in total, and sets the sum of
 * cells. */
void vg_load_fit(struct vg_load *l, double volume);

#endif
