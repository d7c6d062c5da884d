/* core/remesh/sizes.h: edge lengths that the shape of a surface asks for.
 * Private to core/remesh. */
#ifndef VG_CORE_REMESH_SIZES_H
#define VG_CORE_REMESH_SIZES_H

#include "core/remesh/curves.h"

struct vg_sizes_options {
  double per_turn;     /* edges round a full circle */
  double chord;        /* largest distance of an edge from its arc */
  double strip;        /* size on a strip over its width */
  double h_min, h_max; /* bounds, finite; h_min is 0 where it underflows */
  double h_shape;      /* the shape asks for no less */
  double growth;
  const double *cap;         /* [n_tri] largest size on it, or NULL; INFINITY:
                                on an outer boundary, whose chords do not
                                matter */
  const double *point_cap;   /* [n_point] largest size there, or NULL */
  const double *across;      /* [n_patch] edges across strips; NULL: 1 */
  const uint32_t *tri_patch; /* [n_tri] for across */
  struct vg_stop stop;
};

/** Fill r->size (and the tree): by the curvature of faces and curves, and by
 * the width of strips between two curves. O(n). VG_ERR_MEMORY,
 * VG_ERR_STOPPED. */
vg_status vg_sizes_make(struct vg_ref *r, const struct vg_curves *c,
                        const struct vg_sizes_options *o, struct vg_error *err);

#endif
