/* core/remesh/gaps.h: how narrow the fluid is between surfaces that face each
 * other, as places with sizes: for a new surface and for the cells in between.
 *
 * From places on the surface a ray goes into the fluid, along the normal; what
 * it meets within reach, if that faces it, is the other side of a gap as wide
 * as the ray is long. Places are as near to each other as the gaps are wide
 * there, or as the largest size where there is none, so that their number
 * follows from areas and widths. */
#ifndef VG_CORE_REMESH_GAPS_H
#define VG_CORE_REMESH_GAPS_H

#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/mesh.h"

struct vg_gap_options {
  double edges;        /* > 0, asked for across a gap */
  double h_min, h_max; /* no size below; none above is asked for, so that
                          gaps wider than edges * h_max are none. h_min 0:
                          2e-5 of the surface's length, h_max 0: 0.04 */
  double most_tri;     /* triangles of the new surface in gaps that are
                          too many; 0: any number goes */
  double most_place;   /* places that are too many; 0: any number goes */
  int threads;         /* 0: one per core; the same bytes for any */
  struct vg_stop stop;
};

struct vg_gaps {
  size_t n;                /* places, in pairs: both sides of a gap */
  double (*x)[3], *h;      /* [n] owned; size there: width / edges */
  double narrowest, at[3]; /* of all, and one side of it; n 0: not set, but
                              where the forecast is too high */
  uint32_t patch[2];       /* of both sides of it */
  double n_tri, n_place;   /* forecast: triangles of size h in gaps, and
                              places */
};
#define VG_GAPS_INIT                                                           \
  {                                                                            \
    0                                                                          \
  }

/** Find them. A forecast from some 1e5 samples, a million where gaps are
 * narrow, comes first.
 *
 * @param m    triangles that face the fluid, no index out of range
 * @param out  empty before, and on failure; vg_gaps_release
 * Returns VG_BLOCKED where the forecast is above most_tri or most_place: *out
 * then has the forecast and the narrowest gap among its samples, no places.
 * VG_ERR_INPUT for options out of range, edges of three triangles, or some 1e8
 * places; VG_ERR_MEMORY, VG_ERR_STOPPED. Re-entrant. About a microsecond a
 * place. */
vg_status vg_gaps_find(const struct vg_mesh *m, const struct vg_gap_options *o,
                       struct vg_gaps *out, struct vg_error *err);

void vg_gaps_release(struct vg_gaps *g);

#endif
