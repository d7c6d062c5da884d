/* partition/cut/lattice.h: where a void is cut. Uses load.h,
 * core/front/region.h.
 *
 * Planes across one, two or three axes at weighted quantiles of the load make
 * blocks. Where planes meet, lines are grown first, as pencils, so that the
 * tiles of the planes between them can be grown at the same time, and then
 * the blocks. Large tiles are grown in pieces: between them ribs are grown
 * first, pencils along lines across the tile, which cut nothing else. Walls
 * between the regions of a stage keep them apart: midway between parallel
 * planes, and at 45 degrees where planes meet. */
#ifndef VG_PARTITION_CUT_LATTICE_H
#define VG_PARTITION_CUT_LATTICE_H

#include "core/front/region.h"
#include "partition/load/load.h"

enum {
  VG_LATTICE_PLANES = 7,
  VG_LATTICE_STAGES = 4,
  VG_LATTICE_TILES = 3,   /* the stage of tiles; those before: pencils */
  VG_LATTICE_BLOCKS = 512 /* (VG_LATTICE_PLANES + 1)^3 */
};

/* What cutting and its forecast have in common. */

/** Half thickness of a tile in spacings: as it is taken off the parts' load and
 * counted for pieces of tiles; and as cells fill it, measured over boxes and
 * spheres. (C18) */
#define VG_TILE_REACH 0.68
#define VG_TILE_FILLED 0.57
/** Attempts to part a void by other planes. (C8) */
enum { VG_RETRIES = 5 };
/** Voids below this share of a leaf are filled together; a cut that leaves more
 * than the second in one part did not part its void. (C10) */
#define VG_SMALL_SHARE 0.02
#define VG_NOT_PARTED 0.9

/* A line across a tile. */
struct vg_rib {
  int tile;              /* whole ones count */
  struct vg_plane plane; /* at right angles to the tile's */
};

struct vg_lattice {
  int n[3];          /* planes across each axis */
  int lines_at_once; /* 1: n is 1 1 1, and the planes meet in a body */
  double at[3][VG_LATTICE_PLANES];
  int n_rib;
  struct vg_rib *rib; /* [n_rib] rising by tile; of a tile in order,
                         normals towards the next one; owned */
};

/** Without ribs. */
void vg_lattice_release(struct vg_lattice *l);

struct vg_cut_rule {
  double leaf_cells; /* cut while more are expected; 0: by levels */
  int first_axis;    /* 0 to 2: cut across this one first; -1: best */
  int constant;      /* 1: across first_axis only */
};

/** Planes for a void, without ribs yet.
 * @param levels  bisections left, for a rule by levels
 * @param retry   0, 1, ...: after a failed attempt, other planes
 * @param out     overwritten; release an old one before
 * Returns the bisections used (as levels): 0 when no plane makes sense. */
int vg_lattice_plan(const struct vg_load *load, const struct vg_cut_rule *rule,
                    int levels, int retry, struct vg_lattice *out);

/** Ribs for large tiles, so that both sides can be grown at the same time: the
 * smaller the leaves, the more workers are expected, and the smaller are the
 * pieces. O(octants + dots log dots) for octants that planes pass.
 * @param l  without ribs; these are to be released (vg_lattice_release)
 * VG_ERR_MEMORY. */
vg_status vg_lattice_add_ribs(const struct vg_load *load,
                              const struct vg_cut_rule *rule,
                              struct vg_lattice *l, struct vg_error *err);

/** Number of regions of a stage: 0: lines along z (the last axis with lines
 * across all), 1: segments of the other lines, 2: ribs, 3: tiles in pieces.
 * lines_at_once: 0: segments of all lines, 1: none. */
size_t vg_lattice_count(const struct vg_lattice *l, int stage);

/** Region k of a stage. Returns the axis of the line, or of the plane. */
int vg_lattice_region(const struct vg_lattice *l, int stage, size_t k,
                      struct vg_region *r);

/** The part of plane i across an axis that lies in a box: where parts of a
 * void still hang together after all stages. Boxes that do not overlap keep
 * such regions apart. */
void vg_lattice_patch(const struct vg_lattice *l, int axis, int i,
                      const double lo[3], const double hi[3],
                      struct vg_region *r);

/** The blocks between planes: x first, i + (n[0] + 1) (j + (n[1] + 1) k) is
 * behind i planes across x. */
size_t vg_lattice_blocks(const struct vg_lattice *l);

/** The block that x lies in. What is on a plane is in the block below it, or,
 * if upper is 1, above it. */
uint32_t vg_lattice_block(const struct vg_lattice *l, const double x[3],
                          int upper);

#endif
