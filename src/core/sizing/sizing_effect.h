/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_effect.h: do sources have the requested effect? Uses
 * core/sizing/sizing.h, core/mesh/slices.h.
 *
 * The spacing near a coarse boundary cannot be small (core/sizing/sizing.h),
 * so a source may be partly or wholly ineffective. It is tested at sample
 * points in its shape. Only points in the void count, since the centre of a
 * source is often inside a body. Where the gradient towards a source is too
 * steep for cells to follow, the mesh may still miss it; this can only be
 * tested once the mesh exists. */
#ifndef VG_CORE_SIZING_SIZING_EFFECT_H
#define VG_CORE_SIZING_SIZING_EFFECT_H

#include "core/mesh/slices.h"
#include "core/sizing/sizing.h"

/** A source is limited by the surface if the spacing exceeds this times the
 * requested one ... */
#define VG_LIMITED_RATIO 1.5 /* H5 */
/** ... at this share of its sample points, or more. */
#define VG_LIMITED_SHARE 0.25

/** A sample point is resolved if a point of the mesh is within this times the
 * spacing there. */
#define VG_MET_WITHIN 2.0
#define VG_MET_STEEP 0.5

struct vg_limited_source {
  size_t source;             /* index of the source */
  size_t n_place, n_limited; /* number of sample points in the void; number
                                of those with too large a spacing */
  double at[3];              /* if all points are limited: the point with the
                                smallest deviation; otherwise the one with the
                                largest */
  double asked, got;         /* requested and actual spacing at this point */
  size_t face;               /* triangle of the front that limits the spacing
                                there; SIZE_MAX: none */
  double edge, distance;     /* mean edge of that face, and its distance */
  double edge_wanted;   /* with edges up to this length, no face would limit
                           the source there */
  double growth_wanted; /* growth rate with which no face would limit it; 0:
                           no rate up to 2 suffices */
};

/** A source without any sample point in the fluid, not even within three
 * spacings of it. */
struct vg_outside_source {
  size_t source;
  int is_beyond; /* 1: outside the bounding box of the surface */
};

/** A sample point of a source where the spacing (got) is much smaller than
 * around it. */
struct vg_steep_place {
  double x[3], got;
  uint64_t source;
};

/** An unresolved source: at least VG_LIMITED_SHARE of its steep sample points
 * are not resolved by the mesh. */
struct vg_unmet_source {
  size_t source, n_place, n_unmet;
  struct vg_steep_place place; /* first unresolved point */
};

struct vg_effects {
  size_t n, n_outside, n_place, n_unmet;
  struct vg_limited_source *item;    /* [n] sources limited by the surface,
                                        in the order of the sources */
  struct vg_outside_source *outside; /* [n_outside] sources outside the
                                        fluid, in the same order */
  struct vg_steep_place *place;      /* [n_place] steep sample points, in the
                                        same order; only if the spacing may
                                        change by more than VG_MET_STEEP per
                                        unit length */
  struct vg_unmet_source *unmet; /* [n_unmet] unresolved sources, in the same
                                    order */
};
#define VG_EFFECTS_INIT                                                        \
  {                                                                            \
    0                                                                          \
  }

/** Find the sources that are limited by the surface, and those outside the
 * fluid.
 *
 * @param options, n, source  as used to build the field
 * @param front    closed triangles that face the void of `sizing`
 * @param surface  the boundary of the fluid; differs from front only if there
 *                 are layers
 * @param out      owned by the caller, vg_effects_release; unchanged on
 *                 failure
 *
 * Cost: about 10 ns per triangle times the logarithm of the number of sample
 * points, of which each source has some dozens. The result depends on the
 * arguments only. VG_ERR_MEMORY. */
vg_status vg_effects_find(const struct vg_sizing_options *options, size_t n,
                          const struct vg_source *source,
                          const struct vg_mesh *front,
                          const struct vg_mesh *surface,
                          const struct vg_sizing *sizing,
                          struct vg_effects *out, struct vg_error *err);

/** Find the sources that a mesh does not resolve. Collective. h: on rank 0, the
 * result of vg_effects_find before the mesh was made; empty on other ranks. It
 * is completed on all ranks, except for item and outside. Cost: only for steep
 * fields, the number of sample points times the points of the slices around
 * them. The result does not depend on the number of ranks. VG_ERR_MEMORY. */
vg_status vg_effects_in_mesh(struct vg_comm *c, const struct vg_slices *s,
                             int threads, struct vg_effects *h,
                             struct vg_error *err);

/** Free; accepts an empty one. */
void vg_effects_release(struct vg_effects *h);

#endif
