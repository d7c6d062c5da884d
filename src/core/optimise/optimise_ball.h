/* core/optimise/optimise_ball.h: the cells around a point, laid out for loops
 * over them: each is the face opposite the point, and what does not change as
 * the point moves. */
#ifndef VG_CORE_OPTIMISE_OPTIMISE_BALL_H
#define VG_CORE_OPTIMISE_OPTIMISE_BALL_H

#include "core/optimise/optimise_parts.h"

struct vg_ball_faces {
  size_t n;
  double x[3][3][VG_BALL_MAX];   /* [corner][axis][n] */
  double normal[3][VG_BALL_MAX]; /* twice the area, towards the point */
  double area2[VG_BALL_MAX];     /* its square */
  double edge2[3][VG_BALL_MAX];  /* squares of the edges, each opposite the
                                    corner of that number */
  double border2[VG_BALL_MAX];   /* their sum */
  double per;                    /* 1 / (6 squares of the length that edges
                                    should have); 0: any */
};

/** All but `per`. link: [n <= VG_BALL_MAX] 4 * cell + index of the point. */
void vg_ball_faces(const struct vg_tets *t, size_t n, const uint32_t *link,
                   struct vg_ball_faces *out);
/** The length that edges should have: what `sizing` says at x, where the point
 * is; NULL: any. */
void vg_ball_target(const struct vg_sizing *sizing, const double x[3],
                    struct vg_ball_faces *b);

/** The shapes (vg_shape) of the cells if the point stood at x. q out: [n]
 * Returns 0, and leaves q unfinished, as soon as one is not above `stop`. */
int vg_ball_shapes(const struct vg_ball_faces *b, const double x[3],
                   double stop, double *q);

/** What is to be said for the cells with the point at x besides their shapes,
 * by the squares of their volumes and the sums E of their squared edges: a
 * share of the sum of volume^2 / E^3, which large angles spoil as small ones
 * do, less one of the sum of (E / what the target makes it - 1)^2. */
double vg_ball_other(const struct vg_ball_faces *b, const double x[3]);

/** The mean of where the point would be of the best use to each cell: above
 * its face's middle, as high as in a regular tetrahedron. Weights are 1 - q.
 * q: [n] shapes of the cells as they are; x: where the point is */
void vg_ball_ideal(const struct vg_ball_faces *b, const double *q,
                   const double x[3], double to[3]);

/** Gradient, by the point at x, of half the sum of the logarithms of the shapes
 * of cells first ... end - 1, all of which are positive, and of as much of what
 * vg_ball_other sums up, of its first part likewise the logarithms. */
void vg_ball_slope(const struct vg_ball_faces *b, size_t first, size_t end,
                   const double x[3], double g[3]);

#endif
