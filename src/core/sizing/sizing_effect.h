/* core/sizing/sizing_effect.h: do sources get what they ask for? Uses
 * core/sizing/sizing.h, core/mesh/slices.h.
 *
 * Sizes near a coarse boundary cannot be small (core/sizing/sizing.h), so a
 * source may be partly or wholly without effect. It is asked at some places in
 * its shape, those in the void alone: the middle of a source is often inside a
 * body. Where sizes fall faster towards it than cells can follow, the mesh
 * may pass it by all the same: that is seen when it is made. */
#ifndef VG_CORE_SIZING_SIZING_EFFECT_H
#define VG_CORE_SIZING_SIZING_EFFECT_H

#include "core/mesh/slices.h"
#include "core/sizing/sizing.h"

/** Held back: sizes above this times what the source asks for ... */
#define VG_LIMITED_RATIO 1.5 /* H5 */
/** ... in this share of the places looked at, or more. */
#define VG_LIMITED_SHARE 0.25

/** Met: a point of the mesh is within this times the size there. */
#define VG_MET_WITHIN 2.0
#define VG_MET_STEEP 0.5

struct vg_limited_source {
  size_t source;             /* its index */
  size_t n_place, n_limited; /* in the void; of them with too large a size */
  double at[3];          /* where it gets least, if all are held back: its best
                            place; else the one where most is amiss */
  double asked, got;     /* there */
  size_t face;           /* triangle of the front that holds it back there;
                            SIZE_MAX: none does */
  double edge, distance; /* mean edge of that face, how far it is */
  double edge_wanted;    /* with edges up to that no face there would */
  double growth_wanted;  /* nor with that growth rate; 0: none up to 2 does */
};

/** A source without any place in the fluid, nor one three spacings away. */
struct vg_outside_source {
  size_t source;
  int is_beyond; /* outside the box of the surface */
};

/** A place of a source, and the size there, which is much less than around
 * it. */
struct vg_steep_place {
  double x[3], got;
  uint64_t source;
};

/** A source that the mesh does not meet in VG_LIMITED_SHARE of such places. */
struct vg_unmet_source {
  size_t source, n_place, n_unmet;
  struct vg_steep_place place; /* the first of them */
};

struct vg_effects {
  size_t n, n_outside, n_place, n_unmet;
  struct vg_limited_source *item;    /* [n], in the order of the sources */
  struct vg_outside_source *outside; /* [n_outside], likewise */
  struct vg_steep_place *place;  /* [n_place], likewise; where sizes may change
                                   by more than VG_MET_STEEP over a length */
  struct vg_unmet_source *unmet; /* [n_unmet], likewise */
};
#define VG_EFFECTS_INIT                                                        \
  {                                                                            \
    0                                                                          \
  }

/** Find the sources that are held back, and those that are outside.
 *
 * @param options, n, source  as the field was made from
 * @param front    closed triangles, faces into the void that `sizing` is for
 * @param surface  the boundary of the fluid: the same, but for layers
 * @param out      owned by the caller, vg_effects_release; untouched on
 * failure Cost: some 10 ns for each triangle and a logarithm of the places,
 * which are some dozens for each source. Follows from the arguments alone.
 * VG_ERR_MEMORY. */
vg_status vg_effects_find(const struct vg_sizing_options *options, size_t n,
                          const struct vg_source *source,
                          const struct vg_mesh *front,
                          const struct vg_mesh *surface,
                          const struct vg_sizing *sizing,
                          struct vg_effects *out, struct vg_error *err);

/** Find what a mesh does not meet. Collective; h: of rank 0, as found before
 * the mesh was made; elsewhere empty, and filled likewise, but for item and
 * outside. Cost: of steep fields alone, some places times the points of slices
 * around them. The same for any number of ranks. VG_ERR_MEMORY. */
vg_status vg_effects_in_mesh(struct vg_comm *c, const struct vg_slices *s,
                             int threads, struct vg_effects *h,
                             struct vg_error *err);

/** Free; accepts an empty one. */
void vg_effects_release(struct vg_effects *h);

#endif
