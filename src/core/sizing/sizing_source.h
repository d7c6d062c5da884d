/* core/sizing/sizing_source.h: laws of single sources, and of a whole list of
 * them prepared for many evaluations. Uses
 * core/sizing/sizing.h.
 *
 * Only + - * / and sqrt touch a size, so the bytes do not depend on libm. */
#ifndef VG_CORE_SIZING_SIZING_SOURCE_H
#define VG_CORE_SIZING_SIZING_SOURCE_H

#include <stdatomic.h>

#include "core/sizing/sizing.h"

/** A bounded-growth source with what a quick rejection needs. */
struct vg_bounded {
  struct vg_source law; /* spacings scaled, corners of a box ordered */
  double slope;         /* growth away from the shape */
  double steep;         /* Lipschitz constant of the law, >= slope */
  double least;         /* smallest spacing */
  double lo[3], hi[3];  /* box around all points of the shape */
};

/** Where a map gave what is no size; of several places that of the least x, y,
 * z that was asked for. Guarded by `busy`. */
struct vg_map_fault {
  atomic_flag busy;
  int n;
  double x[3], h;
};

/** Sources ready to be evaluated. VGRID's appear twice: in the mean and as
 * bounded cones of the global growth, which is what limiting the gradient of
 * the mean makes of it near a source. */
struct vg_source_set {
  struct vg_bounded *bounded; /* [n_bounded], the cones last */
  struct vg_source *mean;     /* [n_mean] scaled VGRID sources */
  double *reach;              /* [n_mean] distance over which the mean varies
                                 next to the source */
  size_t n_bounded, n_mean;
  const struct vg_size_map *map; /* NULL: none; neither scaled nor owned */
  struct vg_map_fault *fault;    /* of the map */
};
#define VG_SOURCE_SET_INIT                                                     \
  {                                                                            \
    0                                                                          \
  }

/** Refuse what has no meaning, naming the source (1-based) and its group. */
vg_status vg_source_check(size_t n, const struct vg_source *source,
                          struct vg_error *err);

/** Fill *set (empty before). cones: 1 to append VGRID sources as cones.
 * options->scale multiplies what sources say; options->growth is scaled
 * already. */
vg_status vg_source_prepare(const struct vg_sizing_options *options, size_t n,
                            const struct vg_source *source, int cones,
                            struct vg_source_set *set, struct vg_error *err);

void vg_source_release(struct vg_source_set *set);

/** Inverse-square mean at x; INFINITY without VGRID sources. */
double vg_source_mean(size_t n, const struct vg_source *source,
                      const double x[3]);

/** Whether there is anything in it. */
static inline int vg_source_any(const struct vg_source_set *set)
{
  return set->n_bounded || set->n_mean || set->map;
}

/** Minimum of mean, bounded sources and map at x; INFINITY for an empty set.
 */
double vg_source_at(const struct vg_source_set *set, const double x[3]);

/** Lower bound of the bounded sources and the map within the box lo..hi; of a
 * map without bounds an estimate from the corners and the centre. */
double vg_source_floor(const struct vg_source_set *set, const double lo[3],
                       const double hi[3]);

/** Whether samples a distance `side` apart can show how the mean varies in
 * the box lo..hi: 0 where one of its sources is too near. */
int vg_source_resolved(const struct vg_source_set *set, const double lo[3],
                       const double hi[3], double side);

/** Box around the shapes of all sources; 0 if there are none. */
int vg_source_bounds(const struct vg_source_set *set, double lo[3],
                     double hi[3]);

#endif
