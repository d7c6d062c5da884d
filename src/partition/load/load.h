/* partition/load/load.h: how many cells will a void need, and where? Uses core.
 *
 * A load is a list of octants that together cover a void, each with the cells
 * expected in it: c V / h^3, V the part of the octant in the void. Octants are
 * a few target edges wide in small meshes; there are some thousands to some
 * tens of thousands of them, more only where cells are many hundred millions.
 * Questions about planes are answered from an index of each axis. */
#ifndef VG_PARTITION_LOAD_LOAD_H
#define VG_PARTITION_LOAD_LOAD_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/front/front.h"
#include "core/sizing/sizing.h"

/** Cells per cube of the target edge where spacing is even, measured over
 * boxes (docs/performance-parallel.md); corrected by what a void's zones turned
 * out. */
#define VG_LOAD_CELLS_PER_CUBE 9.0 /* C13 */

/** Where the target edge varies, cells are more by this share, and cost more:
 * nearly the same for growth rates from 1.1 to 1.35, while even spacing allows
 * regular cells. */
#define VG_LOAD_GRADED 0.21 /* C15 */

struct vg_load_octant {
  float at[3], half; /* centre, half the side */
  float h;           /* target edge, averaged like 1 / h^3 */
  float part;        /* of the octant in the void, > 0; such that all
                        make up the volume that the front encloses */
  float cells;       /* expected in that part */
};

struct vg_load_index;
struct vg_engine;

struct vg_load {
  size_t n;
  struct vg_load_octant *octant; /* [n] in the order of an octree: fixed */
  double cells;                  /* sum */
  double lo[3], unit;            /* of the octree: corner, side / 2^31 */
  int is_block;          /* 1: octants count from .. to only: the void lies */
  double from[3], to[3]; /* between planes that pass octants */
  struct vg_load_index *index;
};
#define VG_LOAD_INIT                                                           \
  {                                                                            \
    .n = 0                                                                     \
  }

void vg_load_release(struct vg_load *l);

/** The load of a void.
 *
 * @param v   front only is looked at; closed
 * @param threads  to use; the result does not depend on it
 * @param cells_per_cube  VG_LOAD_CELLS_PER_CUBE; where h varies in space the
 *            cells are up to 1.21 times as many, as measured
 * Octree over the void's box: split while wider than 3 h, or than 2 h where
 * the front passes (the part inside is then sampled); wider in meshes of more
 * than 10 M cells, to have about 40,000 octants or one for 2,500 cells, and as
 * narrow as 1 h in voids with fewer than 64. Octants outside are dropped.
 * Where h changes much across an octant, 1 / h^3 is summed over its parts; of a
 * field that changes by more than half of a length over it, down to the least
 * h in them. h is
 * taken to grow from the front's own edges by 1.5 for each length at most,
 * which is what meshes do, and there are 1.5 cells for each face at least.
 * Cost: O(front + octants) times a logarithm. Result follows from the arguments
 * alone, bit by bit. VG_ERR_UNSUPPORTED beyond 4 M octants, some 10 billion
 * cells: sizes in another unit than the surface. VG_ERR_MEMORY. */
vg_status vg_load_new(const struct vg_front *v, const struct vg_sizing *sizing,
                      double cells_per_cube, int threads, struct vg_load *out,
                      struct vg_error *err);

/** What each of n voids takes of the load of a void that was cut into them.
 *
 * child: [n] fronts that lie inside the parent's void; out: [n] loads. An
 * octant goes to the child that it lies in (octants that fronts cross are
 * shared by samples); what lies in none of them (the zones) is dropped. A child
 * that is too small for the octants gets one around it. Shares are made to fit
 * the volumes of the fronts; nothing drifts over generations. The octants'
 * cells are multiplied by `correction`, the ratio of cells made to cells
 * expected in the ancestors' zones. Children are looked at in a loop of e,
 * which may be NULL. O(octants + fronts) times a logarithm. */
vg_status vg_load_split(const struct vg_load *parent, size_t n,
                        const struct vg_front *child, double correction,
                        const struct vg_engine *e, struct vg_load *out,
                        struct vg_error *err);

/** What lies in each block of a lattice of planes.
 *
 * n: planes across each axis; at: their places, rising; out: [blocks] loads,
 * x first: block i + (n[0] + 1) (j + (n[1] + 1) k) is behind i planes across
 * x. An octant that planes pass goes to several blocks, by volume; what lies
 * within `reach` target edges of a plane goes to none (zones). In loops of e,
 * which may be NULL. O(octants + blocks). */
vg_status vg_load_split_blocks(const struct vg_load *parent, const int n[3],
                               const double *const at[3], double reach,
                               double correction, const struct vg_engine *e,
                               struct vg_load *out, struct vg_error *err);

/** Make the index for the questions below anew, after octants were changed by
 * hand; all loads from here have one. O(octants). VG_ERR_MEMORY. */
vg_status vg_load_index(struct vg_load *l, int threads, struct vg_error *err);

/* Questions: O(log octants) each. */

/** Position along `axis` below which lies the share `part` of the cells;
 * octants count as evenly filled. */
double vg_load_quantile(const struct vg_load *l, int axis, double part);

/** Cells expected within `width` target edges on each side of the plane
 * x[axis] = at: what a zone costs. As dense as on the plane. */
double vg_load_zone(const struct vg_load *l, int axis, double at, double width);

/** Largest target edge met on the plane (0: the plane misses the void). */
double vg_load_coarsest(const struct vg_load *l, int axis, double at);

/** Cells expected in the box lo ... hi. O(octants). */
double vg_load_within(const struct vg_load *l, const double lo[3],
                      const double hi[3]);

/** Finds octants by places; of one load, which stays as it is. */
struct vg_load_finder;

/** O(octants log octants). VG_ERR_MEMORY. */
vg_status vg_load_finder_new(const struct vg_load *l,
                             struct vg_load_finder **out, struct vg_error *err);
/** Accepts NULL. */
void vg_load_finder_free(struct vg_load_finder *f);

/** The octant that x is in; SIZE_MAX: none, as outside the void. O(log
 * octants). Threads: safe. */
size_t vg_load_find(const struct vg_load_finder *f, const double x[3]);

/** Flat bytes and back, for messages: VG_ERR_FORMAT when damaged. */
struct vg_bytes;
vg_status vg_load_pack(const struct vg_load *l, struct vg_bytes *out,
                       struct vg_error *err);
vg_status vg_load_unpack(const struct vg_bytes *in, struct vg_load *out,
                         struct vg_error *err);

#endif
