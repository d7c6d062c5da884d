/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/strips.h: narrow strips between two feature curves. Strips
 * narrower than the tolerance can only be filled with needles and are closed:
 * one of the two curves is dropped along the strip. The strip around the edge
 * of a thin body, such as a blunt trailing edge, stays unless it is much
 * narrower. Private to core/remesh.
 *
 *   shorter     o---.                                         .---o
 *   curve            '---a----o------o------o------o----b----'
 *                        |  width < tolerance, for at   |
 *                        |    least three widths        |
 *   longer      o=====o=====o======o======o======o======o======o==o
 *   curve
 *
 *   closed      o---.                                         .---o
 *                    '---a    .      .      .      .    b----'
 *
 *               o=====o=====o======o======o======o======o======o==o
 *
 * Edges of the shorter curve are split at the ends a and b of the narrow
 * stretch. The edges between a and b are no longer feature edges. The surface
 * itself is unchanged; the remeshed surface may deviate from it by the
 * tolerance there. */
#ifndef VG_CORE_REMESH_STRIPS_H
#define VG_CORE_REMESH_STRIPS_H

#include "core/remesh/curves.h"

/* End of a walk across a strip. */
struct vg_strip_end {
  uint32_t half; /* Half-edge of the opposite curve, in the strip. */
  double x[3];
};

/** Width of the strip at point x of feature edge h: the length of the walk from
 * x at a right angle to h over the triangles to another feature edge that is
 * nearly parallel. INFINITY above `most`, or if no such edge is found.
 *
 * @param end  out: the feature edge reached, at any angle; may be NULL */
double vg_strip_width(const struct vg_ref *r, const struct vg_curves *c,
                      uint32_t h, const double x[3], double most,
                      struct vg_strip_end *end);

/** Do the faces beyond the half-edges g and h of a strip turn away from each
 * other, as those of a thin body do at its edge?
 *
 *   upper side  -----------.
 *                          | strip of a blunt trailing edge
 *   lower side  -----------'
 */
int vg_strip_is_edge(const struct vg_ref *r, uint32_t g, uint32_t h);

#define VG_STRIP_LEAST 0.1 /* S81 */

struct vg_strips_options {
  double tolerance;     /* Narrower strips are closed. */
  int closes_edges;     /* 1: also those around the edges of thin bodies. 0:
                           these are closed below VG_STRIP_LEAST of the
                           tolerance. */
  const double *across; /* [n_patch] Strips in patches with values above 1 stay;
                           may be NULL. */
  const struct vg_curves_options *lines;
};

/* The input surface with additional points where narrow stretches begin and
 * end. New points and triangles come last. */
struct vg_strips {
  size_t n;             /* Number of closed stretches; if 0, all other members
                           are empty. */
  double length;        /* Total length of the closed stretches. */
  double widest, at[3]; /* Largest width of a closed strip, and its location. */
  int has_edges; /* Strips narrower than the tolerance stay, because they are
                    edges of thin bodies. */
  struct vg_mesh mesh;
  uint8_t *closed;     /* [3 mesh.n_tri] 1: half-edge of a closed stretch, on
                          both sides. */
  uint32_t *tri_from;  /* [mesh.n_tri] Input triangle that contains the
                          triangle. */
  uint32_t *half_from; /* [3 mesh.n_tri] Input half-edge that contains the
                          half-edge; VG_REF_NONE: inside an input triangle. */
  size_t n_new;
  uint32_t (*ends)[2]; /* [n_new] End points of the edge that a new point
                          splits; these may be new points of lower numbers. */
};
#define VG_STRIPS_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

/** Find and close narrow strips. Of two curves closer than the tolerance only
 * one must stay: rims and fixed borders always do, otherwise the longer curve
 * does. m is the mesh of r's faces; r needs neither tree nor sizes. O(total
 * length of curves). VG_ERR_MEMORY. */
vg_status vg_strips_find(const struct vg_ref *r, const struct vg_curves *c,
                         const struct vg_mesh *m,
                         const struct vg_strips_options *o, struct vg_strips *s,
                         struct vg_error *err);

/** Stretch the edges along edges of thin bodies that are much narrower than the
 * size around them, so that the number of triangles in them stays small.
 *
 * @param r       with sizes
 * @param across  [n_patch] patches with values above 1 are left out; may be
 *                NULL
 * @param by      [3 n_tri] ratio of edges along a half-edge to those across it,
 * on both sides of an edge; ratios above 0 are not changed Returns the number
 * of half-edges set. O(n_tri). */
size_t vg_strips_stretch(const struct vg_ref *r, const struct vg_curves *c,
                         const double *across, const uint32_t *tri_patch,
                         double *by);

void vg_strips_release(struct vg_strips *s);

#endif
