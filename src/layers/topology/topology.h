/* layers/topology/topology.h: which columns, faces and borders a wall has. Uses
 * core, columns.h, slide.h. */
#ifndef VG_LAYERS_TOPOLOGY_TOPOLOGY_H
#define VG_LAYERS_TOPOLOGY_TOPOLOGY_H

#include "layers/slide/slide.h"

struct vg_topology {
  uint32_t *first;      /* [n_column + 1] into corner[] */
  uint32_t *corner;     /* 3 * face + k with face[k] the column, real and
                           virtual faces, by rising face */
  uint32_t *near_first; /* [n_column + 1] into near[] */
  uint32_t *near;       /* columns that share an edge, rising */
  uint8_t *preset;      /* [n_column] 1: dir is given (a column inside a
                           fan, without a triangle of its own) */
  uint8_t *blocked;     /* [n_column] 1: no levels can stand here (n must
                           be 0): several sheets of wall meet in the
                           point, or it touches more than two slide
                           patches, or a patch that is neither wall nor
                           slide patch */
};
#define VG_TOPOLOGY_INIT                                                       \
  {                                                                            \
    NULL, NULL, NULL, NULL, NULL, NULL                                         \
  }

void vg_topology_release(struct vg_topology *t);

/** Columns, faces, borders and their neighbourhoods. n, dir, cap, law of the
 * columns are 0 but for the dir (unit) of preset columns.
 *
 * slide[] of a column: the slide patches that its point touches, by an edge
 * or by the point alone, by rising patch; the first two of them.
 *
 * Without fans: one column per wall point. With them: an edge between two
 * wall triangles whose normals differ by more than fan_angle degrees (convex)
 * is a ridge; the triangles around a point, cut at its ridges, form sectors;
 * each sector has a column, and between neighbouring sectors lie as many
 * preset columns that the turning between directions is at most 40 degrees.
 * A point that one direction serves well, or that lies on one ridge end only,
 * keeps one column. With a fan_angle of 0 only points that no one direction
 * sees have fans. Virtual faces close the gaps along ridges and at points. A
 * ridge that ends at a slide patch ends in a border there.
 *
 * All columns of one root should get the same levels and heights. Then cells
 * of virtual faces are positive as long as no column of the face is 90 degrees
 * or more away from the middle of the two others; else a fan that tapers onto
 * one column makes flat or inverted ones.
 *
 * @param slide    [n_slide] as from vg_slides_find
 * @param columns  in: empty; untouched on failure, as is *t
 * Cost: O(points + triangles). Same bytes for the same input. */
vg_status vg_topology_build(const struct vg_mesh *surface,
                            const uint8_t *is_wall, size_t n_slide,
                            const struct vg_slide *slide, double fan_angle,
                            struct vg_columns *columns, struct vg_topology *t,
                            struct vg_error *err);

#endif
