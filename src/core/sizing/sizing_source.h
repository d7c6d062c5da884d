/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_source.h: laws of single sources, and lists of sources
 * that are prepared for many evaluations. Uses core/sizing/sizing.h.
 *
 * Spacings are computed with + - * / and sqrt only, so the bytes do not depend
 * on libm. */
#ifndef VG_CORE_SIZING_SIZING_SOURCE_H
#define VG_CORE_SIZING_SIZING_SOURCE_H

#include <stdatomic.h>

#include "core/sizing/sizing.h"
#include "core/sizing/sizing_stretch.h"

/** A bounded-growth source, with the data for quick rejection. */
struct vg_bounded {
  struct vg_source law; /* source with scaled spacings; corners of a box are
                           ordered */
  double slope;         /* growth away from the shape */
  double steep;         /* Lipschitz constant of the law, >= slope */
  double least;         /* smallest spacing */
  double lo[3], hi[3];  /* box around all points of the shape */
};

/** Position where a map returned an invalid spacing or metric; if there are
 * several, the one with the smallest x, y, z. Guarded by `busy`. */
struct vg_map_fault {
  atomic_flag busy;
  int n;
  double x[3], value[6]; /* spacing, or components of the metric */
};

/** Sources prepared for evaluation. VGRID sources appear twice: in the mean,
 * and as bounded (or stretched) cones with the global growth, which is what
 * limiting the gradient of the mean gives near a source. */
struct vg_source_set {
  struct vg_bounded *bounded; /* [n_bounded], cones of VGRID sources last */
  struct vg_source *mean;     /* [n_mean] scaled VGRID sources */
  double *reach;              /* [n_mean] distance over which the mean varies
                                 next to the source */
  struct vg_stretched *stretched; /* [n_stretched] by their groups */
  struct vg_stretched_groups groups;
  size_t n_bounded, n_mean, n_stretched;
  int mean_is_stretched;            /* 1: the mean is one of size tensors */
  const struct vg_size_map *map;    /* NULL: no map; neither scaled nor owned */
  const struct vg_size_map *metric; /* map with a metric, instead of map */
  struct vg_map_fault *fault;       /* fault of the map */
};
#define VG_SOURCE_SET_INIT                                                     \
  {                                                                            \
    0                                                                          \
  }

/** Check sources. The error names the source (1-based) and its group. */
vg_status vg_source_check(size_t n, const struct vg_source *source,
                          struct vg_error *err);

/** Fill *set (empty before). cones: 1 to append VGRID sources as cones.
 * options->scale multiplies the spacings and growth of sources;
 * options->growth is scaled already. */
vg_status vg_source_prepare(const struct vg_sizing_options *options, size_t n,
                            const struct vg_source *source, int cones,
                            struct vg_source_set *set, struct vg_error *err);

void vg_source_release(struct vg_source_set *set);

/** Inverse-square mean at x; INFINITY if there are no VGRID sources. */
double vg_source_mean(size_t n, const struct vg_source *source,
                      const double x[3]);

/** Does the set contain a source or map? */
static inline int vg_source_any(const struct vg_source_set *set)
{
  return set->n_bounded || set->n_mean || set->map;
}

/** Do sizes depend on the direction? */
static inline int vg_source_any_stretched(const struct vg_source_set *set)
{
  return set->n_stretched || set->mean_is_stretched || set->metric;
}

/** Inverse-square mean of the size tensors at x. */
void vg_source_mean_tensor(size_t n, const struct vg_source *source,
                           const double x[3], double h[6]);

/** Size tensor at x: the intersection of those of all sources and maps with the
 * isotropic size h, which may be INFINITY. */
void vg_source_axes_at(const struct vg_source_set *set, const double x[3],
                       double h, struct vg_size_axes *out);

/** Minimum of mean, bounded sources and map at x, without those that depend on
 * the direction; INFINITY without any such source. */
double vg_source_at(const struct vg_source_set *set, const double x[3]);

/** Lower bound of the bounded sources and the map within the box lo..hi. For a
 * map without bounds, an estimate from the corners and the centre. */
double vg_source_floor(const struct vg_source_set *set, const double lo[3],
                       const double hi[3]);

/** Can samples at a distance of `side` resolve the variation of the mean in the
 * box lo..hi? 0 if one of its sources is too near. */
int vg_source_resolved(const struct vg_source_set *set, const double lo[3],
                       const double hi[3], double side);

/** Box around the shapes of all sources. Returns 0 if there are no sources. */
int vg_source_bounds(const struct vg_source_set *set, double lo[3],
                     double hi[3]);

#endif
