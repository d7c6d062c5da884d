/* core/sizing/sizing_octree.h: the exact field and the octree that caches it.
 * Internal to core/sizing. */
#ifndef VG_CORE_SIZING_SIZING_OCTREE_H
#define VG_CORE_SIZING_SIZING_OCTREE_H

#include <stdatomic.h>

#include "core/sizing/sizing_bvh.h"
#include "core/sizing/sizing_source.h"

/** What is cached: min(above, max(below, sources)), then clamped; above and
 * below are the growth of the surface (sizing_bvh.h). So the field equals
 * the local size on the surface, and departs from it at the growth rate; down
 * to sources that are much finer than faces nearby, faster in the end. */
struct vg_stat {
  const struct vg_bvh *near;  /* from above; NULL: no surface */
  const struct vg_bvh *under; /* from below; NULL: nor any source */
  struct vg_source_set set;
  double slope;         /* growth - 1 */
  atomic_int *is_steep; /* out: faces hold sources back beyond the knee
                           somewhere (sizing_bvh.h) */
  double h_min, h_max;  /* clamp, 0 and INFINITY for none */
};

#define VG_OCTREE_LEAF 0x80000000u
#define VG_OCTREE_DEPTH 28 /* levels below the root */

struct vg_octree {
  double lo[3], side;   /* root cube */
  uint32_t root;        /* as an entry of child */
  uint32_t (*child)[8]; /* [n_split] VG_OCTREE_LEAF | leaf, or split */
  float *least;         /* [n_split] of the corners below */
  float (*leaf)[8];     /* [n_leaf] corner sizes; x fastest, then y */
  size_t n_split, n_leaf;
};
#define VG_OCTREE_INIT                                                         \
  {                                                                            \
    0                                                                          \
  }

double vg_stat_clamp(const struct vg_stat *f, double h);

/** Value of the field at x before its gradient is limited. reach, hint: for
 * the searches (sizing_bvh.h), without influence. */
double vg_stat_at(const struct vg_stat *f, const double x[3],
                  struct vg_bvh_reach *reach, uint32_t *hint);

/** The surface's bounds applied to the sources' size at x. */
double vg_stat_combine(const struct vg_stat *f, const double x[3],
                       double source, struct vg_bvh_reach *reach,
                       uint32_t *hint);

/** Lower bound of the field within a cube; of VGRID's mean an estimate from
 * the centre, which is good in a cube that resolves its sources.
 * by_sources out: 1: they ask for less than the surface does. */
double vg_stat_floor(const struct vg_stat *f, const double lo[3], double side,
                     struct vg_bvh_reach *reach, uint32_t *hint,
                     int *by_sources);

/** Build over the cube lo, side with about max_leaf leaves at most. *out is
 * empty before, and on failure. threads: as vg_parallel_for's; the same tree
 * for any number. team: NULL, or those who make it together. */
vg_status vg_octree_build(const struct vg_stat *f, const double lo[3],
                          double side, double coarseness, size_t max_leaf,
                          int threads, struct vg_team *team,
                          struct vg_octree *out, struct vg_error *err);

void vg_octree_release(struct vg_octree *t);

/** Number of entries that are out of range or do not point down the tree, and
 * of sizes that are negative or no numbers; a check of stages (base/checks.h).
 */
size_t vg_octree_defects(const struct vg_octree *t);

/** Trilinear size at x; outside the cube at the nearest point of it, and
 * *outside gets the distance (0 inside). */
double vg_octree_at(const struct vg_octree *t, const double x[3],
                    double *outside);

/** Least value within the cube lo, side, and a place x where it is: that in
 * the root cube nearest to it, where it is outside. */
double vg_octree_least(const struct vg_octree *t, const double lo[3],
                       double side, double x[3]);

#endif
