/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* layers/clear/clear_ahead.h: the steps of vg_clear_ahead; the file of each
 * step is named above its functions. Private to clear*.c. */
#ifndef VG_LAYERS_CLEAR_CLEAR_AHEAD_H
#define VG_LAYERS_CLEAR_CLEAR_AHEAD_H

#include "layers/clear/clear_parts.h"

/* For the children of a node: half the diagonals of their boxes, and the
 * bounding boxes of the unit normals in them. */
struct vg_normal_boxes {
  union vg_f8 radius, mid[3], half[3];
};

struct vg_ahead {
  const struct vg_mesh *surface;
  const struct vg_columns *columns;
  const struct vg_topology *topology;
  double gap;
  const double *reach;
  double *allowed;
  uint32_t *face_of;   /* [n_tri] face of the columns on each triangle, or
                          VG_NO_INDEX. */
  uint32_t *column_of; /* [n_point + 1] first column of each point. */
  uint32_t *first;     /* [n_point] first copy of each point on an inner
                          surface, or NULL: no inner surface. */
  uint8_t *slid;       /* [n_patch] 1: columns slide in the patch. */
  struct vg_boxes boxes;
  struct vg_normal_boxes *sides; /* [nodes] normals in each node. */
  float (*normal)[3];            /* [boxes.n] unit normals, 0 for a triangle
                                    without area. */
  uint32_t *order;               /* [n_column] columns ordered so that
                                    neighbours are close together. */
};

/* clear_cone.c ------------------------------------------------------------*/

/** Whether the line from o along u passes through a triangle (corners p, unit
 * normal n) at a distance of less than *along, which is then updated. A
 * tolerance closes the gaps between triangles. */
int vg_line_hits(const double o[3], const double u[3], const double (*p)[3],
                 const double n[3], double *along);

/** Least u . x for points x of the triangle (corners p relative to the apex,
 * unit normal n, facing the apex) within the cone; INFINITY if it is not below
 * `most`. */
double vg_nearest_in_cone(const double u[3], const double (*p)[3],
                          const double n[3], double most);

/* clear_prepare.c -----------------------------------------------------------*/

/** Prepares the data for all queries from the borrowed members of *x. Call
 * vg_ahead_release even on failure. */
vg_status vg_ahead_prepare(struct vg_ahead *x, int threads,
                           struct vg_error *err);

void vg_ahead_release(struct vg_ahead *x);

/** Adds the direction of the column, as a unit vector, to sum. */
void vg_add_direction(const struct vg_column *c, double sum[3]);

#endif
