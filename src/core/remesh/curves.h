/* core/remesh/curves.h: the lines of a surface that stay: ridges, hard borders
 * of patches, open rims. Private to core/remesh. */
#ifndef VG_CORE_REMESH_CURVES_H
#define VG_CORE_REMESH_CURVES_H

#include "core/remesh/reference.h"

/* A line from corner to corner, or round to where it began. */
struct vg_feature_curve {
  size_t first, n; /* its points among those of all */
};

struct vg_curves {
  uint32_t *line;  /* [3 n_tri] half-edges on lines, both sides:
                      number + 1 of the piece from a point to the
                      next, curve by curve; 0: on none */
  uint8_t *corner; /* [n_point] */
  size_t n_curve, cap_curve, n_point, cap_point, cap_at;
  struct vg_feature_curve *curve;
  uint32_t *point; /* [n_point] points of the surface, in order */
  double *at;      /* [n_point] length of the line up to there */
  size_t n_corner;
  double length;         /* of all */
  const uint8_t *closed; /* as in the options, borrowed */
};
#define VG_CURVES_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

struct vg_curves_options {
  double angle;              /* degrees between faces, from which on an edge is
                                a ridge */
  double tolerance;          /* jags smaller than this make no corner */
  const uint32_t *tri_patch; /* [n_tri] */
  const struct vg_patch *patch;
  const uint8_t *hard;   /* [n_patch] whose borders are lines; or NULL.
                            So are those between different conditions */
  const double *stretch; /* [3 n_tri] half-edges with more than 1 are lines;
                            or NULL */
  const uint8_t *closed; /* [3 n_tri] edges that are no ridges, whatever
                            their angle; or NULL */
};

/** Find them. Decisions compare cosines with one that the angle gives by a
 * rational approximation, not libm. O(n). VG_ERR_MEMORY. */
vg_status vg_curves_find(struct vg_curves *c, const struct vg_ref *r,
                         const struct vg_curves_options *o,
                         struct vg_error *err);

void vg_curves_release(struct vg_curves *c);

/** Curve of the piece of a line with this number. */
size_t vg_curve_of(const struct vg_curves *c, uint32_t number);

/** Must the edge stay a line: a rim, a border that is hard, or stretched? */
int vg_curves_is_hard(const struct vg_curves_options *o, const struct vg_ref *r,
                      uint32_t h);

/** Place at length s along curve i. */
void vg_curve_at(const struct vg_curves *c, const struct vg_ref *r, size_t i,
                 double s, double x[3]);

/** Largest distance of the curve between lengths s0 < s1 from the line
 * between its points there. */
double vg_curve_chord(const struct vg_curves *c, const struct vg_ref *r,
                      size_t i, double s0, double s1);

double vg_curve_length(const struct vg_curves *c, size_t i);

/** Cosine of an angle in degrees, 0 to 180, by plain arithmetic. */
double vg_cosine(double degrees);

#endif
