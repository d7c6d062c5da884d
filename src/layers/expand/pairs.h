/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/expand/pairs.h: pairs of faces that become stacks of hexahedra.
 * Private to expand*.c, join*.c, pairs*.c and slices*.c.
 *
 * Pairs of virtual faces. Along a sharp edge with fans, the virtual faces
 * between the columns of two neighbouring roots A and B come in pairs, each a
 * quadrilateral of two columns of A and two of B. As prisms, they would be long
 * and split across their short side, with faces between their cells that are
 * nearly parallel to the line between the centres. A pair therefore becomes one
 * stack of cells:
 *
 *        a0------------b0    top: two triangles, as for single faces
 *        |\  M         |\    level n - 1: a point M in the middle, five
 *        | a1----------|-b1    pyramids and two tetrahedra
 *        |  |          |  |
 *        a0-|----------b0 |  levels 1 to n - 2: hexahedra
 *         \ |           \ |
 *          a1------------b1
 *             \  .         \ .
 *               A------------B    level 0: a prism on the edge from A to B
 *
 * n is the number of levels of the lowest column; the levels above are those of
 * the single faces. If A or B also has a virtual face that cannot be paired, or
 * a cell at the wall would be bad, its columns are raised one at a time at
 * level 0, and the prism is replaced by a pyramid and a tetrahedron.
 *
 * Pairs of wall faces, with VG_LAYER_HEX: two neighbouring wall triangles whose
 * four columns have different roots, without marks. They become a quadrilateral
 * of the wall, hexahedra on levels 0 to n - 2 and the same last level. All side
 * faces are those of the prisms that the pair replaces, so neighbours of any
 * kind conform. */
#ifndef VG_LAYERS_EXPAND_PAIRS_H
#define VG_LAYERS_EXPAND_PAIRS_H

#include "layers/expand/expand.h"

/** Finds the pairs among the virtual faces, each with positive cells only, and
 * removes the marks of columns that need not be raised one at a time. Sets
 * partner, middle and n_pair. VG_ERR_MEMORY. */
vg_status vg_pairs_find(struct vg_expand *e, const struct vg_mesh *surface,
                        struct vg_error *err);

/** Adds pairs of wall faces, after vg_pairs_find: those of a matching of large
 * weight, each with positive cells only. Sets wall_quads. O(n log n) in the
 * faces. VG_ERR_MEMORY. */
vg_status vg_pairs_find_wall(struct vg_expand *e, const struct vg_mesh *surface,
                             struct vg_error *err);

/** Whether a face is the first of a pair, which makes the cells of both. */
int vg_pair_is_first(const struct vg_expand *e, size_t face);

/** Columns of two neighbouring faces, counter-clockwise seen from the fluid. Of
 * virtual faces: two of one root, then two of the other. Of wall faces: the
 * second and the last are common to both. */
void vg_pair_ring(const struct vg_columns *c, const size_t pair[2],
                  uint32_t q[4]);

/** Columns of the pair with this first face, as vg_pair_ring. */
void vg_pair_corners(const struct vg_expand *e, size_t face, uint32_t q[4]);

/** Number of levels of its lowest column. */
unsigned vg_pair_levels(const struct vg_expand *e, const uint32_t q[4]);

/** Coordinates of the middle point of the pair to which a face belongs. */
void vg_pair_middle(const struct vg_expand *e, const struct vg_mesh *surface,
                    size_t face, double x[3]);

/** The same from the points of its columns, whose points at level 1 are base.
 * low: number of levels of the lowest column. */
void vg_pair_middle_of(const double (*x)[3], const uint32_t base[4],
                       unsigned low, double middle[3]);

/* How a pair begins at the wall: its columns together, or first those of the
 * first root of vg_pair_corners, or those of the second; or on a quadrilateral
 * of the wall. */
enum vg_pair_start {
  VG_PAIR_TOGETHER,
  VG_PAIR_FIRST_ROOT,
  VG_PAIR_SECOND_ROOT,
  VG_PAIR_ON_WALL
};

/** Makes the cells of a pair below the level where its lowest column ends.
 * pair: both faces. foot, base: as in vg_expand_face, for the columns q. */
void vg_expand_pair(const struct vg_expand *e, const size_t pair[2],
                    const uint32_t q[4], enum vg_pair_start start,
                    const uint32_t foot[4], const uint32_t base[4],
                    uint32_t middle, struct vg_cell_sink *s);

/** Whether the cells of the last level of two wall faces are of good shape. p:
 * points below it; the points above are p + 1. */
int vg_pair_level_is_sound(const double (*x)[3], const uint32_t p[4],
                           uint32_t middle);

/** Whether all cells of two neighbouring faces up to the level where their
 * lowest column ends would be positive, as the check of the mesh decides. */
int vg_pair_is_good(const struct vg_expand *e, const struct vg_mesh *surface,
                    const size_t pair[2]);

/** Makes the cells of a single face with columns f at level 0. */
void vg_expand_wall(const struct vg_expand *e, const uint32_t f[3],
                    const uint32_t foot[3], const uint32_t base[3],
                    struct vg_cell_sink *s);

#endif
