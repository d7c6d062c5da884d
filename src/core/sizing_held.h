/* core/sizing_held.h: do sources get what they ask for? Uses core/sizing.h.
 *
 * Sizes near a coarse boundary cannot be small (core/sizing.h), so a source
 * may be partly or wholly without effect. It is asked at some places in its
 * shape, those in the void alone: the middle of a source is often inside a
 * body. */
#ifndef VG_CORE_SIZING_HELD_H
#define VG_CORE_SIZING_HELD_H

#include "core/sizing.h"

/** Held back: sizes above this times what the source asks for ... */
#define VG_HELD_RATIO 1.5
/** ... in this share of the places looked at, or more. */
#define VG_HELD_SHARE 0.25

struct vg_held_source {
  size_t source;         /* its index */
  size_t n_place, n_held; /* in the void; of them with too large a size */
  double at[3];          /* where it gets least, if all are held: its best
                            place; else the one where most is amiss */
  double asked, got;     /* there */
  size_t face;           /* triangle of the front that holds it back there;
                            SIZE_MAX: none does */
  double edge, distance; /* mean edge of that face, how far it is */
  double edge_wanted;    /* with edges up to that no face there would */
  double growth_wanted;  /* nor with that growth rate; 0: none up to 2 does */
};

/** A source without any place in the fluid, nor one three spacings away. */
struct vg_lost_source {
  size_t source;
  int is_beyond;         /* outside the box of the surface */
};

struct vg_held {
  size_t n, n_lost;
  struct vg_held_source *item;  /* [n], in the order of the sources */
  struct vg_lost_source *lost;  /* [n_lost], likewise */
};
#define VG_HELD_INIT { 0 }

/** Find the sources that are held back, and those that are lost.
 *
 * @param options, n, source  as the field was made from
 * @param front    closed triangles, faces into the void that `sizing` is for
 * @param surface  the boundary of the fluid: the same, but for layers
 * @param out      owned by the caller, vg_held_release; untouched on failure
 * Cost: some 10 ns for each triangle and a logarithm of the places, which are
 * some dozens for each source. Follows from the arguments alone.
 * VG_ERR_MEMORY. */
vg_status vg_held_find(const struct vg_sizing_options *options, size_t n,
                       const struct vg_source *source,
                       const struct vg_mesh *front,
                       const struct vg_mesh *surface,
                       const struct vg_sizing *sizing, struct vg_held *out,
                       struct vg_error *err);

/** Free; accepts an empty one. */
void vg_held_release(struct vg_held *h);

#endif
