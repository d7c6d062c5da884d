/* core/sizing/sizing_build.h: an octree of sizes in the making. Internal to
 * core/sizing. */
#ifndef VG_CORE_SIZING_SIZING_BUILD_H
#define VG_CORE_SIZING_SIZING_BUILD_H

#include "base/team.h"
#include "core/sizing/sizing_octree.h"

#define VG_OCTREE_TOP (1u << VG_OCTREE_DEPTH) /* side of the root cube */
#define VG_OCTREE_GRAIN 128 /* cells or points for a thread at a time */

struct vg_octree_cell {
  uint32_t at[3];     /* lower corner, in units of the finest cell */
  uint32_t corner[8]; /* points */
  uint32_t child;     /* first of eight; 0: leaf */
  uint32_t hint;      /* for the search of near samples */
  float floor;        /* no value within is smaller */
  float rest;         /* no cell below this times its side is split */
};

struct vg_octree_point {
  uint32_t at[3];     /* in units of the finest cell */
  uint32_t parent[4]; /* of a middle: ends of the edge, corners of the face */
  uint32_t hint;
  float h;
  uint8_t n_parent; /* 0: corner of the root or centre; 2 or 4 */
  uint8_t hangs;
};

/* Cells of a level follow each other, eight children of a cell too. */
struct vg_octree_build {
  const struct vg_stat *f;
  struct vg_octree_cell *cell;
  struct vg_octree_point *point;
  size_t n_cell, n_point, cap_cell, cap_point, max_cell;
  size_t level[VG_OCTREE_DEPTH + 2]; /* first cell of each; n_cell behind */
  int n_level;
  double lo[3], unit, floor;
  float surface; /* times floor where the surface rules, not sources */
  int threads;
  struct vg_team *team;
};

/** All cells and points, with the field at the points. VG_ERR_MEMORY, or what
 * a team fails of. */
vg_status vg_octree_grow(struct vg_octree_build *b, struct vg_error *err);

/** Lower the sources at the points until no two corners of a leaf differ by
 * more than the slope times their distance, and the field with them. Fails as
 * vg_octree_grow. */
vg_status vg_octree_limit(struct vg_octree_build *b, struct vg_error *err);

static inline void vg_octree_place(const struct vg_octree_build *b,
                                   const uint32_t at[3], double x[3])
{
  for (int k = 0; k < 3; k++) x[k] = b->lo[k] + at[k] * b->unit;
}

/** The mean of its parents. */
static inline float vg_octree_hang(const struct vg_octree_build *b,
                                   const struct vg_octree_point *p)
{
  double sum = 0;

  for (int k = 0; k < p->n_parent; k++) sum += (double)b->point[p->parent[k]].h;
  return (float)(sum / p->n_parent);
}

#endif
