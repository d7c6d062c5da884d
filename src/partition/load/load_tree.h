/* partition/load/load_tree.h: an octree that carries triangles down to where
 * they are, and tells at each node's lower corner which void it is in. For
 * load.c and load_split.c.
 *
 * Coordinates are whole numbers, 31 bits across the root octant, whose side is
 * a power of two and whose corner is a multiple of the unit: so a point of the
 * lattice is a double without error, and boxes can be compared as integers. */
#ifndef VG_PARTITION_LOAD_LOAD_TREE_H
#define VG_PARTITION_LOAD_LOAD_TREE_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "core/front/front.h"
#include "partition/load/load.h"

enum { VG_LOAD_BITS = 31, VG_LOAD_LEVELS = 24, VG_LOAD_SAMPLES = 8 };

struct vg_load_tri {
  uint32_t lo[3], hi[3]; /* box, rounded down */
  uint32_t child, face;
};

struct vg_load_tree {
  double lo[3], unit;
  const struct vg_front *child;
  size_t n_tri;
  struct vg_load_tri *tri; /* [n_tri] of all children */
};

/** A node, the triangles that touch it and who owns its lower corner: 0
 * nobody, c + 1 child c. (Voids do not overlap; a sum over crossings, so
 * anything else shows that a front is not closed.) */
struct vg_load_node {
  uint32_t at[3];
  int level; /* side: 1 << (VG_LOAD_BITS - level) */
  int32_t owner;
  size_t first, n; /* triangles: in the stack */
};

/** Lists of triangles of the nodes that are open. */
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

/** Volume that a front encloses: 0 for an empty one. Box: of its points. */
double vg_load_volume(const struct vg_front *v);
void vg_load_box(const struct vg_front *v, double lo[3], double hi[3]);

/** Take in the fronts of n voids; t->lo and unit are given. */
vg_status vg_load_tree_new(struct vg_load_tree *t, size_t n,
                           const struct vg_front *child, int threads,
                           struct vg_error *err);
void vg_load_tree_release(struct vg_load_tree *t);

void vg_load_stack_release(struct vg_load_stack *s);

/** The eight parts of a node; lists are pushed: restore s->n afterwards.
 * Returns -1 when memory is refused. */
int vg_load_octants(const struct vg_load_tree *t, struct vg_load_stack *s,
                    const struct vg_load_node *node, struct vg_load_node out[8],
                    int threads);

/** Who owns each of 2 x 2 x 2 points of a node. They are shifted by an amount
 * that follows from the node, so that errors of neighbours along a plane wall
 * do not add up. at out: the first of them; the others are half a node on,
 * x first. */
void vg_load_sample(const struct vg_load_tree *t, const struct vg_load_stack *s,
                    const struct vg_load_node *node,
                    int32_t owner[VG_LOAD_SAMPLES], uint32_t at[3]);

/** All but the octants. */
void vg_load_copy_frame(const struct vg_load *from, struct vg_load *to);

/** Volume of all parts. */
double vg_load_parts(const struct vg_load *l);

/** Let the parts, as sampled, make up `volume`, and set the sum of cells. */
void vg_load_fit(struct vg_load *l, double volume);

#endif
