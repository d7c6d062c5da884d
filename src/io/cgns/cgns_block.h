/* io/cgns/cgns_block.h: faces of a structured zone as triangles. Private to its
 * module.
 *
 * A quadrilateral becomes two triangles along its shorter diagonal, along that
 * from its first corner (of lowest indices) where both are equal. A collapsed
 * one gives one triangle or none. Points with equal coordinates become one. */
#ifndef VG_IO_CGNS_BLOCK_H
#define VG_IO_CGNS_BLOCK_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "io/stream/soup.h"

struct vg_cgns_block {
  int64_t n[3];    /* points along each index, 1 for one that the zone
                      lacks; less than 2^32 in all */
  double *x[3];    /* coordinates, the first index running fastest;
                      owned */
  uint32_t *point; /* the same in the soup, UINT32_MAX: not in it yet;
                      owned */
};

/* Points from lo to hi, both included, from 1 on, within the block. */
struct vg_cgns_range {
  int64_t lo[3], hi[3];
};

void vg_cgns_block_release(struct vg_cgns_block *b);

/** Does the range hold no face normal to this axis? */
int vg_cgns_range_is_thin(const struct vg_cgns_range *range, int axis);

/** Faces of a block that has a single layer of points normal to the axis. */
size_t vg_cgns_block_cells(const struct vg_cgns_block *b, int axis);

/** cell[] = patch for the faces in a range of such a block. */
void vg_cgns_block_mark(const struct vg_cgns_block *b,
                        const struct vg_cgns_range *range, int axis,
                        uint32_t patch, uint32_t *cell);

/** All faces of such a block. Their normals are along the product of the two
 * other indices, in cyclic order.
 * @param cell  [vg_cgns_block_cells] patches */
vg_status vg_cgns_block_surface(struct vg_cgns_block *b, int axis,
                                const uint32_t *cell, struct vg_soup *soup,
                                struct vg_error *err);

/** The faces in a range that is the first or last layer along the axis. They
 * point into the block, by the points of the next layer, whether its indices
 * are right-handed or not. */
vg_status vg_cgns_block_boundary(struct vg_cgns_block *b,
                                 const struct vg_cgns_range *range, int axis,
                                 uint32_t patch, struct vg_soup *soup,
                                 struct vg_error *err);

#endif
