/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/load/load.h: load estimate: the number and distribution of the
 * cells that a void needs. Uses core.
 *
 * A load is a list of octants that together cover a void, each with
 * the number of cells expected in it: c V / h^3, where V is the part of the
 * octant in the void. In small meshes the octants are a few target edges wide.
 * There are some thousands to some tens of thousands of octants, and more only
 * for many hundred million cells. Queries about planes are answered from an
 * index of each axis. */
#ifndef VG_PARTITION_LOAD_LOAD_H
#define VG_PARTITION_LOAD_LOAD_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/front/front.h"
#include "core/sizing/sizing.h"

/** Cells per cube of the target edge length where the spacing is uniform,
 * measured over boxes (docs/lab/performance-parallel.md). It is corrected by
 * the number of cells that a void's separator zones needed. */
#define VG_LOAD_CELLS_PER_CUBE 9.0 /* C13 */

/** Where the target edge length varies, the number of cells rises by this
 * share, and so does the cost per cell. The share is nearly the same for
 * growth rates from 1.1 to 1.35; uniform spacing allows regular cells. In a
 * field of metrics, points advance one by one (core/metric/metric_points.h)
 * rather than as a lattice, and the share is zero. */
#define VG_LOAD_GRADED 0.21 /* C15 */

struct vg_load_octant {
  float at[3], half; /* Centre, half of the side. */
  float h;           /* Target edge length, averaged like 1 / h^3. */
  float across[3];   /* Distances of length 1 in the metric across planes normal
                        to   the axes (vg_sizing_across); h if the sizes do not
                        depend   on the direction. */
  /* Fraction of the octant in the void, > 0; scaled so that all octants sum up
   * to the volume that the front encloses. */
  float part;
  float cells; /* Cells expected in that fraction. */
};

/** Target edge length across a plane with this unit normal; of oblique planes,
 * the mean one. */
static inline double vg_load_across(const struct vg_load_octant *c,
                                    const double normal[3])
{
  for (int k = 0; k < 3; k++)
    if (normal[k] == 1 || normal[k] == -1) return (double)c->across[k];
  return (double)c->h;
}

struct vg_load_index;
struct vg_engine;

struct vg_load {
  size_t n;
  struct vg_load_octant *octant; /* [n] In octree order; fixed. */
  double cells;                  /* Sum over the octants. */
  double lo[3], unit;            /* Of the octree: corner, side / 2^31. */
  int is_block; /* 1: planes that pass through octants bound the void. */
  double from[3], to[3]; /* In that case octants count only within this box. */
  struct vg_load_index *index;
};
#define VG_LOAD_INIT                                                           \
  {                                                                            \
    .n = 0                                                                     \
  }

void vg_load_release(struct vg_load *l);

/** Estimates the load of a void.
 *
 * @param v   only the front is used; closed
 * @param threads  threads to use; the result does not depend on it
 * @param cells_per_cube  VG_LOAD_CELLS_PER_CUBE; where h varies in space, the
 *   expected number is up to 1.21 times higher, as measured
 * The octree covers the void's box. A node is split while it is wider than 3
 * h, or than 2 h where the front passes through it (the inside fraction is
 * then sampled). Nodes are wider in meshes of more than 10 M cells, to have
 * about 40,000 octants or one per 2,500 cells, and as narrow as 1 h in voids
 * with fewer than 64 octants. Octants outside the void are dropped.
 * Where h changes much across an octant, 1 / h^3 is summed over its parts. If
 * the sizing field changes by more than half an edge over one edge, the parts
 * are refined down to the smallest h in them. h is assumed to grow from the
 * front's own edges by at most 1.5 per length, as meshes do, and at least 1.5
 * cells are expected per face of the front.
 * Cost: O(front + octants) times a logarithm. The result depends on the
 * arguments alone, bit by bit. VG_ERR_UNSUPPORTED beyond 4 M octants, some 10
 * billion cells, which means that the sizes have another unit than the
 * surface. VG_ERR_MEMORY. */
vg_status vg_load_new(const struct vg_front *v, const struct vg_sizing *sizing,
                      double cells_per_cube, int threads, struct vg_load *out,
                      struct vg_error *err);

/** Divides the load of a void among the n voids that it was cut into.
 *
 * child: [n] fronts inside the parent's void; out: [n] loads. An octant goes to
 * the child that contains it; octants that fronts cross are shared by samples.
 * Parts of octants outside all children (the separator zones) are dropped. A
 * child that is too small for the octants gets one octant around it. The shares
 * are scaled to the volumes of the fronts, so that errors do not accumulate
 * over generations. The octants' cells are multiplied by `correction`, the
 * ratio of cells made to cells expected in the ancestors' zones. The children
 * are processed in a loop of e, which may be NULL. O(octants + fronts) times a
 * logarithm. */
vg_status vg_load_split(const struct vg_load *parent, size_t n,
                        const struct vg_front *child, double correction,
                        const struct vg_engine *e, struct vg_load *out,
                        struct vg_error *err);

/** Divides a load among the blocks of a lattice of planes.
 *
 * n: planes across each axis; at: their positions in ascending order; out:
 * [blocks] loads, x first: block i + (n[0] + 1) (j + (n[1] + 1) k) is behind i
 * planes across x. An octant that planes pass through is shared among blocks by
 * volume. The part within `reach` target edges of a plane is assigned to no
 * block (separator zones). In loops of e, which may be NULL. O(octants +
 * blocks). */
vg_status vg_load_split_blocks(const struct vg_load *parent, const int n[3],
                               const double *const at[3], double reach,
                               double correction, const struct vg_engine *e,
                               struct vg_load *out, struct vg_error *err);

/** Rebuilds the index for the queries below after octants were changed
 * directly; all loads made here have one. O(octants). VG_ERR_MEMORY. */
vg_status vg_load_index(struct vg_load *l, int threads, struct vg_error *err);

/* Queries: O(log octants) each. */

/** Position along `axis` below which the fraction `part` of the cells lies;
 * octants count as uniformly filled. */
double vg_load_quantile(const struct vg_load *l, int axis, double part);

/** Cells expected within `width` target edges on each side of the plane x[axis]
 * = at, the cost of a separator zone. The density on the plane is used
 * throughout. In a metric, the edges are those across the plane, so that the
 * cost is in proportion to the area of the plane in the metric: a plane that
 * contains the long edges of the cells crosses the fewest cells. */
double vg_load_zone(const struct vg_load *l, int axis, double at, double width);

/** Largest target edge length across the plane, among the octants on it (0: the
 * plane misses the void). */
double vg_load_coarsest(const struct vg_load *l, int axis, double at);

/** Cells expected in the box lo ... hi. O(octants). */
double vg_load_within(const struct vg_load *l, const double lo[3],
                      const double hi[3]);

/** Finds octants by position, in one load that must stay unchanged. */
struct vg_load_finder;

/** O(octants log octants). VG_ERR_MEMORY. */
vg_status vg_load_finder_new(const struct vg_load *l,
                             struct vg_load_finder **out, struct vg_error *err);
/** Accepts NULL. */
void vg_load_finder_free(struct vg_load_finder *f);

/** The octant that contains x; SIZE_MAX: no octant, as outside the void. O(log
 * octants). Threads: safe. */
size_t vg_load_find(const struct vg_load_finder *f, const double x[3]);

/** Conversion to flat bytes and back, for messages. VG_ERR_FORMAT when
 * damaged. */
struct vg_bytes;
vg_status vg_load_pack(const struct vg_load *l, struct vg_bytes *out,
                       struct vg_error *err);
vg_status vg_load_unpack(const struct vg_bytes *in, struct vg_load *out,
                         struct vg_error *err);

#endif
