/* layers/clear/clear_ahead.h: the steps of vg_clear_ahead, each in the file
 * named above its functions. Private to it. */
#ifndef VG_LAYERS_CLEAR_CLEAR_AHEAD_H
#define VG_LAYERS_CLEAR_CLEAR_AHEAD_H

#include "layers/clear/clear_parts.h"

/* Of the children of a node: half the diagonals, and boxes about the unit
 * normals of what is in them. */
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
  uint32_t *face_of;   /* [n_tri] its face, or VG_NO_INDEX */
  uint32_t *column_of; /* [n_point + 1] first column of each point */
  uint8_t *slid;       /* [n_patch] columns slide in it */
  struct vg_boxes boxes;
  struct vg_normal_boxes *sides; /* [nodes] */
  float (*normal)[3];            /* [boxes.n] unit, 0 without an area */
  uint32_t *order;               /* [n_column] neighbours close together */
};

/* clear_cone.c ------------------------------------------------------------*/

/** Does the line from o along u pass through a triangle (corners p, unit normal
 * n), or nearly so, nearer than *along? Where: *along. The slack closes the
 * gaps between triangles. */
int vg_line_hits(const double o[3], const double u[3], const double (*p)[3],
                 const double n[3], double *along);

/** Least u . x over x in the triangle (corners p relative to the apex, unit
 * normal n, facing the apex) within the cone; INFINITY: none below `most`. */
double vg_nearest_in_cone(const double u[3], const double (*p)[3],
                          const double n[3], double most);

/* clear_prepare.c -----------------------------------------------------------*/

/** What all columns ask of, from the borrowed members of *x. Call
 * vg_ahead_release in any case. */
vg_status vg_ahead_prepare(struct vg_ahead *x, int threads,
                           struct vg_error *err);

void vg_ahead_release(struct vg_ahead *x);

/** sum += the column's direction, as a unit vector. */
void vg_add_direction(const struct vg_column *c, double sum[3]);

#endif
