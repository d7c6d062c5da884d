/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/optimise/optimise_ball.h: the cells around a point, stored as arrays
 * for fast loops. Each cell is represented by the face opposite the point,
 * with all quantities that do not change when the point moves. */
#ifndef VG_CORE_OPTIMISE_OPTIMISE_BALL_H
#define VG_CORE_OPTIMISE_OPTIMISE_BALL_H

#include "core/optimise/optimise_parts.h"

struct vg_ball_faces {
  size_t n;
  double x[3][3][VG_BALL_MAX];   /* [corner][axis][n] */
  double normal[3][VG_BALL_MAX]; /* towards the point; length is twice the
                                    area */
  double area2[VG_BALL_MAX];     /* squared length of the normal */
  double edge2[3][VG_BALL_MAX];  /* squared edge lengths; each edge is
                                    opposite the corner of that index */
  double border2[VG_BALL_MAX];   /* sum of the squared edge lengths */
  double per;                    /* 1 / (6 h^2) for target edge length h; 0:
                                    no target */
};

/** Fill all members except `per`. link: [n] 4 * cell + index of the point, with
 * 0 < n <= VG_BALL_MAX. */
void vg_ball_faces(const struct vg_tets *t, size_t n, const uint32_t *link,
                   struct vg_ball_faces *out);
/** Set the target edge length to the value of `sizing` at x, the position of
 * the point; NULL: no target. */
void vg_ball_target(const struct vg_sizing *sizing, const double x[3],
                    struct vg_ball_faces *b);

/** Shapes (vg_shape) of the cells with the point at x. q out: [VG_BALL_MAX], of
 * which n are meaningful. Returns 0, and leaves q unfinished, as soon as one
 * shape is not above `stop`. */
int vg_ball_shapes(const struct vg_ball_faces *b, const double x[3],
                   double stop, double *q);

/** Shapes (vg_shape) of cells first to first + n - 1. q out: [n <=
 * VG_BALL_MAX]. */
void vg_ball_cells(const struct vg_tets *t, uint32_t first, size_t n, float *q);

/** Terms of the rating of position x in addition to the shapes. E is the sum of
 * the squared edges of a cell. The first term is a weighted sum of volume^2 /
 * E^3, which large angles reduce as small angles do. A weighted sum of (E /
 * E_target - 1)^2 is subtracted from it. */
double vg_ball_other(const struct vg_ball_faces *b, const double x[3]);

/** Weighted mean of the ideal positions of the point for each cell: above the
 * centroid of its face, at the height of a regular tetrahedron. Weights are 1
 * - q. q: [n] present shapes of the cells; x: present position of the point. */
void vg_ball_ideal(const struct vg_ball_faces *b, const double *q,
                   const double x[3], double to[3]);

/** Volume-weighted mean of the centroids of the cells, sum (V_i (x + y1 + y2 +
 * y3) / 4) / V; x: present position of the point. The volume V of the ball
 * does not depend on x. */
void vg_ball_centre(const struct vg_ball_faces *b, const double x[3],
                    double to[3]);

/** Gradient with respect to x of half the sum of the logarithms of the shapes
 * of all cells, which must be positive, plus the same terms as in
 * vg_ball_other, with logarithms in the first one. */
void vg_ball_slope(const struct vg_ball_faces *b, const double x[3],
                   double g[3]);
/** The part of cell k in this gradient. */
void vg_ball_slope_of(const struct vg_ball_faces *b, size_t k,
                      const double x[3], double g[3]);

#endif
