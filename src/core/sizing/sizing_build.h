/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/sizing/sizing_build.h: an octree of spacings under construction.
 * Internal to core/sizing. */
#ifndef VG_CORE_SIZING_SIZING_BUILD_H
#define VG_CORE_SIZING_SIZING_BUILD_H

#include "base/team.h"
#include "core/sizing/sizing_octree.h"

#define VG_OCTREE_TOP (1u << VG_OCTREE_DEPTH) /* side of the root cube */
#define VG_OCTREE_GRAIN 128 /* cells or points per thread and step */

/* Numbers of leaves and splits below a cell, later the indices of the first
 * ones in the compact tree. */
struct vg_octree_span {
  uint32_t leaf, split;
  float least; /* smallest value at a corner */
};

struct vg_octree_cell {
  uint32_t corner[8]; /* indices of points */
  uint32_t child;     /* first of eight children; 0: leaf */
  union {
    struct {
      uint32_t hint; /* start of the search for near samples */
      float floor;   /* lower bound of the spacing within */
      float rest;    /* the cell is not split if its side is at most this
                        times b->floor */
    };
    struct vg_octree_span span; /* while the tree is compacted */
  };
};

struct vg_octree_point {
  uint32_t at[3]; /* in units of the finest cell */
  uint32_t hint;
  float h;
  uint8_t n_parent;   /* of a hanging point 2 or 4, of others 0 */
  uint32_t parent[4]; /* of a hanging point: ends of the edge, or corners of
                         the face */
};

/* Cells of a level are contiguous, and so are the eight children of a cell. */
struct vg_octree_build {
  const struct vg_stat *f;
  struct vg_octree_cell *cell;
  struct vg_octree_point *point;
  struct vg_size *tensor; /* [n_point] size tensors at the points; NULL if the
                             field is isotropic. The h of a point is then an
                             upper bound of its sizes from isotropic sources and
                             the surface. */
  size_t n_cell, n_point, cap_cell, cap_point, cap_tensor, max_cell;
  size_t level[VG_OCTREE_DEPTH + 2]; /* first cell of each level; n_cell
                                        after the last */
  int n_level;
  double lo[3], unit, floor, most_points;
  float surface; /* factor on floor where the surface, not sources,
                    determines the spacing */
  int threads;
  struct vg_team *team;
};

/** Create all cells and points, with the field at the points. VG_ERR_MEMORY, or
 * a failure of the team. */
vg_status vg_octree_grow(struct vg_octree_build *b, struct vg_error *err);

/** Lower the spacing of the sources at the points until no two corners of a
 * leaf differ by more than the slope times their distance, and update the
 * field. Fails as vg_octree_grow. */
vg_status vg_octree_limit(struct vg_octree_build *b, struct vg_error *err);

static inline void vg_octree_place(const struct vg_octree_build *b,
                                   const uint32_t at[3], double x[3])
{
  for (int k = 0; k < 3; k++) x[k] = b->lo[k] + at[k] * b->unit;
}

/** Lower corner of a cell, in units of the finest cell. */
static inline const uint32_t *vg_octree_corner(const struct vg_octree_build *b,
                                               const struct vg_octree_cell *c)
{
  return b->point[c->corner[0]].at;
}

/** Decisions about the eight children of a cell together. */
struct vg_octree_family {
  const struct vg_octree_build *b;
  uint32_t half; /* half the side of a child, in units of the finest cell */
  double side;   /* side of a child */
  struct vg_bvh_reach reach;
  float face[125];            /* field at the centres of their faces; NAN if
                                 not evaluated */
  struct vg_size tensor[125]; /* the same of a field of size tensors; `least`
                                 is NAN if not evaluated */
};

/** Use y for families of a level whose cells have this side. The values at the
 * centres of faces stay undefined. */
static inline void vg_octree_family_open(struct vg_octree_family *y,
                                         const struct vg_octree_build *b,
                                         uint32_t half, double side)
{
  y->b = b;
  y->half = half;
  y->side = side;
}

/** Prepare y for the family whose first cell is c. */
void vg_octree_family_start(struct vg_octree_family *y,
                            const struct vg_octree_cell *c);

/** Forget the values at the centres of faces. */
void vg_octree_family_clear(struct vg_octree_family *y);

/** Field at point i of the 3 x 3 x 3 lattice of a cell. */
float vg_octree_sample(struct vg_octree_family *y,
                       const struct vg_octree_cell *c, int i);

/** The same of a field of size tensors. *iso out: the h of the point. */
void vg_octree_sample_tensor(struct vg_octree_family *y,
                             const struct vg_octree_cell *c, int i,
                             struct vg_size *out, float *iso);

/** Is a cell of the family to be split? Sets the floor and the rest of the
 * cell.
 *
 * @param sibling  index of the cell in its family
 * @param centre   out: field at its centre, unchanged if it was not evaluated;
 *                 of a field of size tensors, the number of points that the
 *                 cell will contain */
int vg_octree_wants_split(struct vg_octree_family *y, struct vg_octree_cell *c,
                          int sibling, float *centre);

/** Coordinates 0 .. 2 of point i of a lattice of 3 x 3 x 3 points. */
static inline void vg_octree_lattice(int i, int at[3])
{
  for (int k = 0; k < 3; k++, i /= 3) at[k] = i % 3;
}

/** Lower the size tensors of the sources at the points until the growth from
 * each corner of a leaf to each other one is at most the slope, except for
 * hanging points, and update the field. Where it has kinks, corners are lowered
 * further, because the interpolation exceeds it. Fails as vg_octree_grow. */
vg_status vg_octree_limit_tensors(struct vg_octree_build *b,
                                  struct vg_error *err);

/** Relative error of edge lengths that the octree of size tensors may have. */
double vg_octree_tolerance(const struct vg_octree_build *b);

/** Do only stretched sources make the sizes depend on the direction? Their
 * growth begins with a kink; metrics of a file and means of VGRID have none. */
int vg_octree_has_kinks(const struct vg_octree_build *b);

/** Size tensor of a hanging point: the mean of its parents. */
static inline void vg_octree_hanging_tensor(const struct vg_octree_build *b,
                                            const struct vg_octree_point *p,
                                            struct vg_size *out)
{
  double sum[6] = { 0 };

  *out = b->tensor[p->parent[0]];
  for (int k = 0; k < p->n_parent; k++) {
    const struct vg_size *s = b->tensor + p->parent[k];

    for (int i = 0; i < 6; i++) sum[i] += (double)s->h[i];
    out->least = s->least < out->least ? s->least : out->least;
    out->most = s->most > out->most ? s->most : out->most;
  }
  for (int i = 0; i < 6; i++) out->h[i] = (float)(sum[i] / p->n_parent);
}

/** Compute the size tensors of all hanging points. Parents may hang themselves,
 * but precede the point. */
static inline void vg_octree_hang_tensors(struct vg_octree_build *b)
{
  for (size_t i = 0; i < b->n_point; i++)
    if (b->point[i].n_parent)
      vg_octree_hanging_tensor(b, b->point + i, b->tensor + i);
}

/** Value of a hanging point: the mean of its parents. */
static inline float vg_octree_hanging_size(const struct vg_octree_build *b,
                                           const struct vg_octree_point *p)
{
  double sum = 0;

  for (int k = 0; k < p->n_parent; k++) sum += (double)b->point[p->parent[k]].h;
  return (float)(sum / p->n_parent);
}

#endif
