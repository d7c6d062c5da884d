/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* partition/cut/lattice.h: positions of cuts. Uses load.h,
 * core/front/region.h.
 *
 * Planes across one, two or three axes, at weighted quantiles of the load,
 * divide a void into blocks. Separator zones, final cells along the planes,
 * are made in stages. Where planes cross, edge separators (pencils) are
 * grown along the lines first. The face separators (tiles) of the planes
 * between them can then be grown at the same time, and after them the
 * blocks. Large tiles are grown in pieces: ribs, thin pencils along lines
 * across the tile, are grown before the pieces and cut nothing else.
 *
 * One plane, with two planes across y and one across z:
 *
 *      z
 *      ^           P           P          P  pencil along z     (stage 0)
 *      |     T     P  T  r  T  P    T     S  segment along y    (stage 1)
 *      |           P     r     P             between pencils
 *      +  S S S S SPS S S S S SPS S S S   r  rib across a large (stage 2)
 *      |           P     r     P             tile
 *      |     T     P  T  r  T  P    T     T  tile, in pieces    (stage 3)
 *      |           P           P             between ribs
 *      +-----------+-----------+---> y
 *
 * Section normal to a line along z. The pencil P reaches farther from the
 * line than the tiles T are thick, so that tiles end at it:
 *
 *       \         |T|         /
 *         \       |T|       /        \ /  walls at 45 degrees between
 *     block \   +-----+   /  block        tiles (and segments) of planes
 *             \ |     | /                 that cross
 *     - - - - - +     + - - - - -
 *      T  T  T     P     T  T  T     plane y = at[1][j]
 *     - - - - - +     + - - - - -
 *             / |     | \
 *     block /   +-----+   \  block
 *         /       |T|       \
 *       /         |T|         \      plane x = at[0][i]
 *
 * Walls, planes that no cell of a region crosses, keep the regions of a
 * stage apart: midway between parallel planes, and at 45 degrees where
 * planes cross. */
#ifndef VG_PARTITION_CUT_LATTICE_H
#define VG_PARTITION_CUT_LATTICE_H

#include "core/front/region.h"
#include "partition/load/load.h"

enum {
  VG_LATTICE_PLANES = 7,
  VG_LATTICE_STAGES = 4,
  VG_LATTICE_TILES = 3,   /* stage of tiles; earlier stages are pencils */
  VG_LATTICE_BLOCKS = 512 /* (VG_LATTICE_PLANES + 1)^3 */
};

/* Constants shared by cutting and its forecast. */

/** Half thickness of a tile in spacings: the thickness subtracted from the load
 * of the blocks and used for the number of pieces of a tile; and the thickness
 * that its cells fill, measured over boxes and spheres. (C18) */
#define VG_TILE_REACH 0.68
#define VG_TILE_FILLED 0.57
/** Attempts to divide a void by other planes. (C8) */
enum { VG_RETRIES = 5 };
/** Voids below this share of a leaf are filled together; a cut that leaves more
 * than the second share in one child has failed. (C10) */
#define VG_SMALL_SHARE 0.02
#define VG_NOT_PARTED 0.9

/* A line across a tile. */
struct vg_rib {
  int tile;              /* Index of the whole tile. */
  struct vg_plane plane; /* Normal to the plane of the tile. */
};

struct vg_lattice {
  int n[3];          /* Planes across each axis. */
  int lines_at_once; /* 1: n is 1 1 1, and the planes meet inside a body. */
  double at[3][VG_LATTICE_PLANES];
  int n_rib;
  struct vg_rib *rib; /* [n_rib] Ascending by tile; within a tile in order,
                         normals towards the next rib; owned. */
};

/** Releases the ribs. */
void vg_lattice_release(struct vg_lattice *l);

struct vg_cut_rule {
  double leaf_cells; /* A void is cut while more cells are expected; 0: cut
                        by levels. */
  int first_axis;    /* 0 to 2: cut across this axis first; -1: best axis. */
  int constant;      /* 1: cut across first_axis only. */
};

/** Plans planes for a void, without ribs yet.
 * @param levels  remaining bisections, for a rule by levels
 * @param retry   0, 1, ...: other planes after a failed attempt
 * @param out     overwritten; release an old lattice before
 * Returns the bisections used (as levels), or 0 when no plane makes sense. */
int vg_lattice_plan(const struct vg_load *load, const struct vg_cut_rule *rule,
                    int levels, int retry, struct vg_lattice *out);

/** Adds ribs to large tiles, so that both sides can be grown at the same time.
 * The smaller the leaves, the more workers are expected, and the smaller are
 * the pieces. O(octants + dots log dots) for the octants that planes pass
 * through.
 * @param l  without ribs; release with vg_lattice_release
 * VG_ERR_MEMORY. */
vg_status vg_lattice_add_ribs(const struct vg_load *load,
                              const struct vg_cut_rule *rule,
                              struct vg_lattice *l, struct vg_error *err);

/** Number of regions of a stage: 0: lines along z (the last axis with lines
 * across all), 1: segments of the other lines, 2: ribs, 3: pieces of tiles. If
 * lines_at_once is set, stage 0 has the segments of all lines and stage 1 is
 * empty. */
size_t vg_lattice_count(const struct vg_lattice *l, int stage);

/** Makes region k of a stage. Returns the axis of the line, or of the plane. */
int vg_lattice_region(const struct vg_lattice *l, int stage, size_t k,
                      struct vg_region *r);

/** Makes the region of plane i across an axis within a box, where subdomains
 * are still connected after all stages. Such regions are kept apart by boxes
 * that do not overlap. */
void vg_lattice_patch(const struct vg_lattice *l, int axis, int i,
                      const double lo[3], const double hi[3],
                      struct vg_region *r);

/** Number of blocks between planes: x first, i + (n[0] + 1) (j + (n[1] + 1) k)
 * is behind i planes across x. */
size_t vg_lattice_blocks(const struct vg_lattice *l);

/** The block that contains x. A point on a plane is in the block below it or,
 * if upper is 1, above it. */
uint32_t vg_lattice_block(const struct vg_lattice *l, const double x[3],
                          int upper);

#endif
