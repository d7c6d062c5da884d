/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/front/region.h: a region that restricts where the kernel makes cells:
 * along a plane or a line, within walls. Uses core/sizing/sizing.h.
 *
 * A region lies along the intersection of its planes: one plane makes a
 * separator zone, two planes make an edge separator (pencil) around the line
 * where they meet. Distances from the region are measured in units of the
 * spacing at the foot of a point, its projection onto all planes; in a metric,
 * the distance from each plane in units of the spacing across that plane. The
 * thickness of a region therefore depends on the cells along it, however fast
 * the spacing grows away from it.
 *
 *           wall[0]                    wall[1]
 *              |->                      <-|
 *              |      ________________    |
 *              |     /\      /\      /\   |
 *              |    /  \    /  \    /  \  |
 *       -------|---/----\--/----\--/----\-|-------  plane[0]
 *              |  /______\/______\/______\|
 *              |                          |
 *
 * The zone consists of the cells that cross the plane, or have a corner within
 * `reach` spacings of it. No cell crosses a wall, so that regions on the two
 * sides of a wall cannot overlap and can be meshed at the same time. The
 * normals of walls point into the region (arrows). */
#ifndef VG_CORE_FRONT_REGION_H
#define VG_CORE_FRONT_REGION_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/sizing/sizing.h"

struct vg_plane {
  double normal[3], offset;
}; /* normal . x = offset */

/* Largest numbers of walls, and of planes and walls. */
enum { VG_REGION_WALLS = 12, VG_REGION_SIDES = 2 + VG_REGION_WALLS };

struct vg_region {
  int n_plane; /* number of planes; 0: no restriction */
  int n_wall;
  struct vg_plane plane[2]; /* unit normals, as for wall[]; two planes are at
                               right angles */
  double reach;             /* cells with a corner within this many spacings
                               belong to the region, in addition to those
                               that cross every plane */
  double wide;              /* additional spacings within which the front
                               must be known and cells are classified, since
                               long triangles reach that far */
  struct vg_plane wall[VG_REGION_WALLS]; /* [n_wall] a convex set: all
                                            corners of a cell must have
                                            normal . x > offset. Regions with
                                            walls between them cannot overlap */
};
#define VG_REGION_ALL                                                          \
  {                                                                            \
    0                                                                          \
  }
_Static_assert(sizeof(struct vg_region) ==
                 24 + (2 + VG_REGION_WALLS) * sizeof(struct vg_plane),
               "no padding allowed: regions are sent and hashed as bytes");

/* Bands around the region, in spacings at the foot, in addition to the reach.
 * Points are placed within the first, so that the region's cells get their
 * final shape. Cells are classified as inside or outside the fluid within the
 * second. Front faces must be known within the third. */
#define VG_BAND_PLACE 1.3 /* K17 */
#define VG_BAND_FLUID 1.9 /* K18 */
#define VG_BAND_FRONT 2.6

/* Beyond a wall, only this share of a band counts. No cell may cross a wall,
 * so only the faces close to it matter. Faces farther away belong to other
 * regions, and classifying the cells behind them would require going through
 * those regions. */
#define VG_BEYOND_WALLS 0.5 /* K19 */

/** Does the region satisfy the invariants of its members: numbers of planes and
 * walls in range, unit normals, planes at right angles, no negative distance?
 * For assertions. */
int vg_region_is_sound(const struct vg_region *r);

/** Signed distance of x from the plane, positive above it. */
static inline double vg_plane_side(const struct vg_plane *p, const double x[3])
{
  return p->normal[0] * x[0] + p->normal[1] * x[1] + p->normal[2] * x[2] -
         p->offset;
}

/** Width of a band of the region, in spacings from its planes. */
static inline double vg_region_band(const struct vg_region *r, double band)
{
  return r->reach + band + (band >= VG_BAND_FLUID ? r->wide : 0);
}

/** Spacing at the foot of x. In a metric, the largest of those across the
 * planes and half of those across the walls: an upper bound of the distances
 * that count as one spacing. */
double vg_region_spacing(const struct vg_region *r,
                         const struct vg_sizing *sizing, const double x[3]);

/** Bounds of the spacing at the feet of all points in the box lo..hi. Exact in
 * a metric, else within the errors of vg_sizing_slope. */
void vg_region_spacing_within(const struct vg_region *r,
                              const struct vg_sizing *sizing,
                              const double lo[3], const double hi[3],
                              double *least, double *most);

/** In a metric: the spacings across the planes, then across the walls, at the
 * foot of x. */
void vg_region_across(const struct vg_region *r, const struct vg_sizing *sizing,
                      const double x[3], double h[VG_REGION_SIDES]);

/** Bounds of vg_region_across for all points in the box lo..hi. */
void vg_region_across_within(const struct vg_region *r,
                             const struct vg_sizing *sizing, const double lo[3],
                             const double hi[3], double least[VG_REGION_SIDES],
                             double most[VG_REGION_SIDES]);

/** Project x onto all planes. */
void vg_region_foot(const struct vg_region *r, const double x[3],
                    double foot[3]);

/** Is x on the inner side of all walls? */
int vg_region_within(const struct vg_region *r, const double x[3]);

/** As vg_region_near, for a caller that knows the spacing h at a point at most
 * d away from x. The spacing at x is looked up only if h does not decide. */
int vg_region_near_by(const struct vg_region *r, const struct vg_sizing *sizing,
                      const double x[3], double band, double h, double d);

/** Is x within reach + band spacings of every plane, and beyond no wall by more
 * than VG_BEYOND_WALLS times that? */
int vg_region_near(const struct vg_region *r, const struct vg_sizing *sizing,
                   const double x[3], double band);

/** Does a triangle satisfy the condition of vg_region_near at any of its
 * points, by the spacing there? */
int vg_region_meets(const struct vg_region *r, const struct vg_sizing *sizing,
                    const double a[3], const double b[3], const double c[3],
                    double band);

/** A cheaper test that may report additional triangles, but misses none for
 * which vg_region_meets is true. */
int vg_region_may_meet(const struct vg_region *r,
                       const struct vg_sizing *sizing, const double a[3],
                       const double b[3], const double c[3], double band);

/** Distances of many points from a region, computed once, so that tests of
 * their triangles need no look-up of spacings. */
struct vg_region_cache {
  const struct vg_region *region; /* borrowed, as are the next two */
  const struct vg_sizing *sizing;
  const double (*x)[3];
  double slope, range; /* bounds of the sizing field: its change per
                          distance, and its largest difference */
  int n_side;          /* distances per point: from all planes, then all
                          walls */
  int n_spacing;       /* spacings per point: 1; in a metric, n_side */
  double *side;        /* [points][n_side] */
  double *spacing;     /* [points][n_spacing] spacings at the foot */
};

/** VG_ERR_MEMORY if memory is refused. Call vg_region_cache_release in any
 * case. */
vg_status vg_region_cache_init(struct vg_region_cache *cache,
                               const struct vg_region *region,
                               const struct vg_sizing *sizing, size_t n,
                               const double (*x)[3], struct vg_error *err);
void vg_region_cache_release(struct vg_region_cache *cache);

/** Distance of point p from the region, in spacings at its foot: from the
 * farthest plane, or beyond a wall, divided by VG_BEYOND_WALLS. */
double vg_region_cache_far(const struct vg_region_cache *cache, uint32_t p);

/** vg_region_meets for points given by their indices. */
int vg_region_cache_meets(const struct vg_region_cache *cache,
                          const uint32_t v[3], double band);

/** vg_region_may_meet for points given by their indices. */
int vg_region_cache_may_meet(const struct vg_region_cache *cache,
                             const uint32_t v[3], double band);

/** Is the cell a b c d within the walls, and does it cross every plane or have
 * a corner within reach? */
int vg_region_has_cell(const struct vg_region *r,
                       const struct vg_sizing *sizing, const double a[3],
                       const double b[3], const double c[3], const double d[3]);

#endif
