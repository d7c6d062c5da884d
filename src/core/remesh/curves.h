/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/curves.h: the feature curves of a surface, which remeshing
 * preserves: sharp edges, fixed patch borders and open rims. Private to
 * core/remesh. */
#ifndef VG_CORE_REMESH_CURVES_H
#define VG_CORE_REMESH_CURVES_H

#include "core/remesh/reference.h"

/* A feature curve from corner to corner, or closed. */
struct vg_feature_curve {
  size_t first, n; /* Its range in vg_curves.point. */
};

struct vg_curves {
  uint32_t *line;  /* [3 n_tri] For half-edges of feature edges, on both sides:
                      number + 1 of the feature edge, counted curve by curve; 0
                      for other half-edges. */
  uint8_t *corner; /* [n_point] 1: feature corner. */
  size_t n_curve, cap_curve, n_point, cap_point, cap_at;
  struct vg_feature_curve *curve;
  uint32_t *point; /* [n_point] Surface points along the curves, in order. */
  double *at;      /* [n_point] Arc length of the curve up to each point. */
  size_t n_corner;
  double length;         /* Total length of all curves. */
  const uint8_t *closed; /* As in the options; borrowed. */
};
#define VG_CURVES_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

struct vg_curves_options {
  double angle;              /* Feature angle: least angle in degrees between
                                the faces of a sharp edge. */
  double tolerance;          /* Jags smaller than this do not make a feature
                                corner. */
  const uint32_t *tri_patch; /* [n_tri] Patch of each triangle. */
  const struct vg_patch *patch;
  const uint8_t *hard;   /* [n_patch] 1: the borders of the patch are fixed. May
                            be NULL. Borders between patches with different
                            conditions are always fixed. */
  const uint8_t *kept;   /* [n_patch] 1: borders between two such patches are
                            feature edges, too, unless they are closed. May be
                            NULL. */
  const double *stretch; /* [3 n_tri] Half-edges with values above 1 or below 0
                            are feature edges; may be NULL. */
  const uint8_t *still;  /* [n_still] Points of feature curves with values above
                            0 are feature corners; may be NULL. */
  size_t n_still;
  const uint8_t *closed; /* [3 n_tri] Edges that are not sharp edges at any
                            angle; may be NULL. */
};

/** Find the feature curves. Cosines are compared with the cosine of the feature
 * angle, which is computed by a rational approximation, not libm, so that all
 * processors take the same decisions. O(n). VG_ERR_MEMORY. */
vg_status vg_curves_find(struct vg_curves *c, const struct vg_ref *r,
                         const struct vg_curves_options *o,
                         struct vg_error *err);

void vg_curves_release(struct vg_curves *c);

/** Curve that contains feature edge `number`, counted from 0. */
size_t vg_curve_of(const struct vg_curves *c, uint32_t number);

/** Must the edge remain a feature edge: is it an open rim, a fixed patch border
 * or stretched? */
int vg_curves_is_hard(const struct vg_curves_options *o, const struct vg_ref *r,
                      uint32_t h);

/** Point at arc length s along curve i. */
void vg_curve_at(const struct vg_curves *c, const struct vg_ref *r, size_t i,
                 double s, double x[3]);

/** Largest distance of curve i between arc lengths s0 < s1 from the chord
 * between these two points. */
double vg_curve_chord(const struct vg_curves *c, const struct vg_ref *r,
                      size_t i, double s0, double s1);

double vg_curve_length(const struct vg_curves *c, size_t i);

/** Cosine of an angle in degrees, 0 to 180, by plain arithmetic without
 * libm. */
double vg_cosine(double degrees);

#endif
