/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* io/cgns/cgns_block.h: converts faces of a structured zone to triangles.
 * Private to its module.
 *
 * A quadrilateral is split along its shorter diagonal, or along the one from
 * its first vertex (of lowest indices) if both are equal. A collapsed
 * quadrilateral gives one triangle or none. Points with equal coordinates are
 * merged. */
#ifndef VG_IO_CGNS_BLOCK_H
#define VG_IO_CGNS_BLOCK_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "io/stream/soup.h"

struct vg_cgns_block {
  int64_t n[3];    /* points along each index, 1 for an index that the zone
                      lacks; less than 2^32 in total */
  double *x[3];    /* coordinates, first index fastest; owned */
  uint32_t *point; /* number of each point in the soup; UINT32_MAX: not added
                      yet; owned */
};

/* Range of points lo to hi, both inclusive and counted from 1, within the
 * block. */
struct vg_cgns_range {
  int64_t lo[3], hi[3];
};

void vg_cgns_block_release(struct vg_cgns_block *b);

/** Does the range contain no face normal to this axis? */
int vg_cgns_range_is_thin(const struct vg_cgns_range *range, int axis);

/** Number of faces of a block with a single layer of points normal to the
 * axis. */
size_t vg_cgns_block_cells(const struct vg_cgns_block *b, int axis);

/** Set cell[] = patch for the faces of such a block that are in a range. */
void vg_cgns_block_mark(const struct vg_cgns_block *b,
                        const struct vg_cgns_range *range, int axis,
                        uint32_t patch, uint32_t *cell);

/** Add all faces of such a block. Their normals are along the cross product of
 * the two other index directions, in cyclic order.
 * @param cell  [vg_cgns_block_cells] patch of each face */
vg_status vg_cgns_block_surface(struct vg_cgns_block *b, int axis,
                                const uint32_t *cell, struct vg_soup *soup,
                                struct vg_error *err);

/** Add the faces of a range that is the first or last layer along the axis.
 * They point into the block. The next layer of points determines this
 * direction, so the block's indices may be left- or right-handed. */
vg_status vg_cgns_block_boundary(struct vg_cgns_block *b,
                                 const struct vg_cgns_range *range, int axis,
                                 uint32_t patch, struct vg_soup *soup,
                                 struct vg_error *err);

#endif
