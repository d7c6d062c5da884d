/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/strips_cut.h: splits edges of a surface without changing its
 * shape, and marks the parts between the cuts. Private to core/remesh. */
#ifndef VG_CORE_REMESH_STRIPS_CUT_H
#define VG_CORE_REMESH_STRIPS_CUT_H

#include "core/remesh/strips.h"

/* Cuts move half-edges; `where` maps the initial half-edges to the current
 * ones. */
struct vg_strip_cutter {
  struct vg_strips *s;
  size_t cap_point, cap_tri, cap_patch, cap_from, cap_ends, cap_mate, cap_half,
    cap_closed;
  uint32_t *mate;  /* [3 n_tri] Opposite half-edge. */
  uint32_t *where; /* [3 n_tri initially] Current number of each initial
                      half-edge. */
  uint32_t edge;   /* The edge cut last; where[edge] is its remaining part. */
  double begun;    /* Position on it at which that part begins. */
};

/** Start with mesh m, from which r was built. VG_ERR_MEMORY. */
vg_status vg_strip_cutter_begin(struct vg_strip_cutter *c,
                                const struct vg_ref *r, const struct vg_mesh *m,
                                struct vg_error *err);

/** Mark initial half-edge h as closed between positions t0 and t1; values below
 * 0 and above 1 stand for its ends. Calls for the same edge must be consecutive
 * and ascending. VG_ERR_MEMORY. */
vg_status vg_strip_cut(struct vg_strip_cutter *c, uint32_t h, double t0,
                       double t1, struct vg_error *err);

void vg_strip_cutter_release(struct vg_strip_cutter *c);

#endif
