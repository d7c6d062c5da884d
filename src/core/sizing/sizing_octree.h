/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_octree.h: the exact sizing field and the octree that
 * caches it. Internal to core/sizing. */
#ifndef VG_CORE_SIZING_SIZING_OCTREE_H
#define VG_CORE_SIZING_SIZING_OCTREE_H

#include <stdatomic.h>

#include "core/sizing/sizing_bvh.h"
#include "core/sizing/sizing_source.h"
#include "core/sizing/sizing_tensor.h"

/** The field to be cached: min(above, max(below, sources)), then clamped. above
 * and below are the bounds from the growth of the surface spacing
 * (sizing_bvh.h). The field therefore equals the local spacing on the surface
 * and departs from it at the growth rate. Towards sources that are much finer
 * than the faces nearby, it finally changes faster. */
struct vg_stat {
  const struct vg_bvh *near;  /* bound from above; NULL: no surface */
  const struct vg_bvh *under; /* bound from below; NULL: no surface, or no
                                 source */
  struct vg_source_set set;
  double slope;         /* growth - 1 */
  atomic_int *is_steep; /* out: sources are limited by faces beyond the knee
                           somewhere (sizing_bvh.h) */
  double h_min, h_max;  /* limits; 0 and INFINITY: no limit */
  int is_stretched;     /* 1: the field is one of size tensors; h_max is then
                           finite */
  double aspect_max;    /* limit of the aspect in a field of size tensors */
};

#define VG_OCTREE_LEAF 0x80000000u
#define VG_OCTREE_TENSOR 0x40000000u /* only in entries of leaves */
#define VG_OCTREE_LEAF_INDEX 0x3fffffffu
#define VG_OCTREE_DEPTH 28 /* levels below the root */

/** Corners of a leaf; x fastest, then y. */
union vg_octree_leaf {
  float h[8];         /* spacings */
  uint32_t corner[8]; /* in a leaf with tensors: their indices */
};

/** Bounds of the sizes below a split cell (sizing_bounds.c). */
struct vg_octree_bounds {
  float h[6];      /* size tensor */
  float low, high; /* factors on its sizes */
};

struct vg_octree {
  double lo[3], side;   /* root cube */
  uint32_t root;        /* as an entry of child */
  uint32_t (*child)[8]; /* [n_split] split, or leaf with VG_OCTREE_LEAF and, if
                           it has tensors, VG_OCTREE_TENSOR */
  float *least;         /* [n_split] smallest corner value below each; of
                           tensors, the geometric mean of the eigenvalues */
  union vg_octree_leaf *leaf; /* [n_leaf] */
  float (*tensor)[6];         /* [n_tensor] size tensors at corners of leaves,
                                 in the order of the entries of child */
  struct vg_octree_bounds *bounds; /* [n_split] if is_stretched, else NULL */
  size_t n_split, n_leaf, n_tensor;
  int is_stretched; /* 1: evaluate with vg_octree_tensor_at; there may be leaves
                       with tensors */
};
#define VG_OCTREE_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

double vg_stat_clamp(const struct vg_stat *f, double h);

/** Value of the field at x before its gradient is limited. reach, hint: speed
 * up the searches (sizing_bvh.h), without effect on the result. */
double vg_stat_at(const struct vg_stat *f, const double x[3],
                  struct vg_bvh_reach *reach, uint32_t *hint);

/** Apply the bounds of the surface to the spacing of the sources at x. */
double vg_stat_combine(const struct vg_stat *f, const double x[3],
                       double source, struct vg_bvh_reach *reach,
                       uint32_t *hint);

/** As vg_stat_at, for a field of size tensors. *iso out: upper bound of all
 * sizes, from isotropic sources and the surface. NULL if it is not needed,
 * which takes less time. */
void vg_stat_tensor_at(const struct vg_stat *f, const double x[3],
                       struct vg_bvh_reach *reach, uint32_t *hint,
                       struct vg_size *out, float *iso);

/** Size tensor of all sources and maps at x, within the limits of sizes and
 * aspect. *iso out: size of the isotropic ones. */
void vg_stat_tensor_source(const struct vg_stat *f, const double x[3],
                           struct vg_size_axes *a, double *iso);

/** Limit the sizes and the aspect of a size tensor. */
void vg_stat_tensor_limit(const struct vg_stat *f, struct vg_size_axes *a);

/** Apply the bounds of the surface to the size tensor of the sources at x.
 *
 * @param a      from vg_stat_tensor_source or vg_stat_tensor_limit; out:
 *               bounded
 * @param above  out: bound from above of the surface, INFINITY: none; or NULL
 */
void vg_stat_tensor_combine(const struct vg_stat *f, const double x[3],
                            struct vg_size_axes *a, struct vg_bvh_reach *reach,
                            uint32_t *hint, struct vg_size *out, double *above);

/** Lower bound of the field within a cube, without sources that depend on the
 * direction. For VGRID's mean, it is an estimate
 * from the centre, which is accurate in a cube that resolves its sources.
 * by_sources out: 1: the sources require less than the surface does. */
double vg_stat_floor(const struct vg_stat *f, const double lo[3], double side,
                     struct vg_bvh_reach *reach, uint32_t *hint,
                     int *by_sources);

/** Build the octree over the cube lo, side with at most about max_leaf leaves.
 * *out is empty before, and on failure. Of the options, coarseness, threads,
 * team and most_points are used. */
vg_status vg_octree_build(const struct vg_stat *f, const double lo[3],
                          double side, const struct vg_sizing_options *o,
                          size_t max_leaf, struct vg_octree *out,
                          struct vg_error *err);

void vg_octree_release(struct vg_octree *t);

/** Number of entries that are out of range or do not point down the tree, and
 * of spacings that are negative or not numbers. For checks of stages
 * (base/checks.h). */
size_t vg_octree_defects(const struct vg_octree *t);

/** Trilinear spacing at x; outside the cube, that at its nearest point.
 * *outside is the distance to the cube (0 inside). */
double vg_octree_at(const struct vg_octree *t, const double x[3],
                    double *outside);

/** As vg_octree_at, for n points. Successive points that are near each other
 * cost less. h, outside: [n] */
void vg_octree_eval(const struct vg_octree *t, size_t n, const double (*x)[3],
                    double *h, double *outside);

/** Gradient of the trilinear spacing in the leaf at x, or at the nearest point
 * of the cube. */
void vg_octree_gradient_at(const struct vg_octree *t, const double x[3],
                           double g[3]);

/** As vg_octree_at, for the size tensor; also if the field is isotropic. */
void vg_octree_tensor_at(const struct vg_octree *t, const double x[3],
                         double h[6], double *outside);

/** Range of the geometric mean, and bound on its gradient. The upper bound
 * allows for the interpolation between different tensors. Only if is_stretched.
 */
void vg_octree_tensor_range(const struct vg_octree *t, int threads,
                            double range[2], double *slope);

/** Smallest value within the cube lo, side, and a point x where it occurs. For
 * a cube outside the root cube, the nearest point of the root cube is used. */
double vg_octree_least(const struct vg_octree *t, const double lo[3],
                       double side, double x[3]);

/** Compute the bounds of all split cells of a stretched octree. Cost:
 * O(leaves). VG_ERR_MEMORY. */
vg_status vg_octree_bounds(struct vg_octree *t, int threads,
                           struct vg_error *err);

/** Bounds of the distance across planes with n unit normals in the box lo..hi,
 * within the root cube. The tree is descended down to cells of half the longest
 * side of the box, and to leaves.
 *
 * @param least, most  out: [n] */
void vg_octree_range_across(const struct vg_octree *t, const double lo[3],
                            const double hi[3], int n,
                            const double (*normal)[3], double *least,
                            double *most);

/** A lower bound of the values within the cube lo, side. */
double vg_octree_bound(const struct vg_octree *t, const double lo[3],
                       double side);

/** A sizing field (sizing.h). */
struct vg_sizing {
  struct vg_octree octree;
  double growth, cap;     /* for spacings outside the octree: rate - 1, and
                             their upper limit */
  double slope;           /* bound on the gradient within the octree */
  double least, most;     /* range over the octree */
  double reach;           /* bound on the ratio of the largest and the mean
                             size at a point; 1 if the field is isotropic */
  struct vg_shmem common; /* shared memory with the octree's arrays, if it is
                             used */
};

#endif
