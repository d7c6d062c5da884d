/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/gaps.h: finds gaps, narrow fluid regions between surfaces that
 * face each other, and returns places with target edge lengths, for remeshing
 * the surface and for the cells in the gaps.
 *
 * From sample places on the surface a ray is cast into the fluid along the
 * normal. If it hits a facing surface within reach, that is the opposite side
 * of a gap whose width is the length of the ray. The places are spaced by the
 * gap width, or by the largest edge length where no gap is found, so that their
 * number depends on areas and gap widths only. */
#ifndef VG_CORE_REMESH_GAPS_H
#define VG_CORE_REMESH_GAPS_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

struct vg_gap_options {
  double edges;        /* > 0; requested number of edges across a gap. */
  double h_min, h_max; /* Bounds of the target edge length. Gaps wider than
                          edges * h_max are ignored. 0: h_min is 2e-5 and h_max
                          0.04 of the length of the surface. */
  double most_tri;     /* Limit for the number of remeshed triangles in gaps; 0:
                          no limit. */
  double most_place;   /* Limit for the number of places; 0: no limit. */
  int threads;         /* 0: one per core. The result is bitwise independent of
                          it. */
  struct vg_stop stop;
};

struct vg_gaps {
  size_t n;                /* Number of places, in pairs: one on each side of a
                              gap. */
  double (*x)[3], *h;      /* [n] owned; target edge length at each place: width
                              / edges. */
  double narrowest, at[3]; /* Width of the narrowest gap, and a point on one
                              side of it. If n is 0 it is set only when the
                              forecast exceeds a limit. */
  uint32_t patch[2];       /* Patches of both sides of the narrowest gap. */
  double n_tri, n_place;   /* Forecast: triangles of edge length h in gaps, and
                              places. */
};
#define VG_GAPS_INIT                                                           \
  {                                                                            \
    0                                                                          \
  }

/** Find gaps. A forecast from some 1e5 samples comes first, or 1e6 if gaps are
 * narrow.
 *
 * @param m    triangles that face the fluid, all indices in range
 * @param out  empty on entry, and on failure; release with vg_gaps_release
 * Returns VG_BLOCKED if the forecast exceeds most_tri or most_place: *out then
 * contains the forecast and the narrowest gap among its samples, but no places.
 * VG_ERR_INPUT for options out of range, edges of three triangles, or more than
 * some 1e8 places; VG_ERR_MEMORY, VG_ERR_STOPPED. Re-entrant. About a
 * microsecond per place. */
vg_status vg_gaps_find(const struct vg_mesh *m, const struct vg_gap_options *o,
                       struct vg_gaps *out, struct vg_error *err);

void vg_gaps_release(struct vg_gaps *g);

#endif
