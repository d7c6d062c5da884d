/* core/front/region.h: where growth may go: along a plane or a line, within
 * walls. Uses core/sizing/sizing.h.
 *
 * A region lies along its planes' common part: one plane makes a zone, two a
 * pencil around the line where they meet. Distances from it are measured in
 * the spacing at its foot, the projection of a point onto all planes, so that
 * a region is as thick as cells are on it, however sizes grow away from it. */
#ifndef VG_CORE_FRONT_REGION_H
#define VG_CORE_FRONT_REGION_H

#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "core/sizing/sizing.h"

struct vg_plane {
  double normal[3], offset;
}; /* normal . x = offset */

enum { VG_REGION_WALLS = 12 };

struct vg_region {
  int n_plane; /* 0: everything */
  int n_wall;
  struct vg_plane plane[2]; /* unit normals, here and below; at right
                               angles */
  double reach;             /* cells within this many spacings belong to the
                               region, in addition to those that cross every
                               plane */
  double wide;              /* additional spacings within which the front must
                               be known and cells are classified, since long
                               triangles reach that far */
  struct vg_plane wall[VG_REGION_WALLS]; /* [n_wall] convex: all corners of a
                               cell must have normal . x > offset. Regions
                               with walls between them cannot overlap */
};
#define VG_REGION_ALL                                                          \
  {                                                                            \
    0                                                                          \
  }
_Static_assert(sizeof(struct vg_region) ==
                 24 + (2 + VG_REGION_WALLS) * sizeof(struct vg_plane),
               "regions have no padding: they are sent, and keys, as bytes");

/* Beyond the reach, in spacings at the foot: how far points are placed, so
 * that the region's cells get their final shape; how far cells are told from
 * outside; how far front faces must be known. */
#define VG_BAND_PLACE 1.3 /* K17 */
#define VG_BAND_FLUID 1.9 /* K18 */
#define VG_BAND_FRONT 2.6

/* The share of it all beyond walls. No cell may cross them, so only what is
 * next to them matters; farther off is what other regions have made, whose
 * other side would have to be told from outside through them. */
#define VG_BEYOND_WALLS 0.5 /* K19 */

/** Does a region keep the invariants of its members: numbers of planes and
 * walls in range, unit normals, planes at right angles, no negative distance?
 * For assertions. */
int vg_region_is_sound(const struct vg_region *r);

/** How far x is above the plane. */
static inline double vg_plane_side(const struct vg_plane *p, const double x[3])
{
  return p->normal[0] * x[0] + p->normal[1] * x[1] + p->normal[2] * x[2] -
         p->offset;
}

/** A band of the region, in spacings from its planes. */
static inline double vg_region_band(const struct vg_region *r, double band)
{
  return r->reach + band + (band >= VG_BAND_FLUID ? r->wide : 0);
}

/** Spacing at the foot of x. */
double vg_region_spacing(const struct vg_region *r,
                         const struct vg_sizing *sizing, const double x[3]);

/** x moved onto all planes. */
void vg_region_foot(const struct vg_region *r, const double x[3],
                    double foot[3]);

/** Is x on the inner side of all walls? */
int vg_region_within(const struct vg_region *r, const double x[3]);

/** vg_region_near, where h is the spacing at most d from x: it is looked up
 * only where that does not tell. */
int vg_region_near_by(const struct vg_region *r, const struct vg_sizing *sizing,
                      const double x[3], double band, double h, double d);

/** Is x within reach + band spacings of every plane, and no farther beyond any
 * wall than VG_BEYOND_WALLS of it? */
int vg_region_near(const struct vg_region *r, const struct vg_sizing *sizing,
                   const double x[3], double band);

/** Does the triangle come as near? By the spacing where it does. */
int vg_region_meets(const struct vg_region *r, const struct vg_sizing *sizing,
                    const double a[3], const double b[3], const double c[3],
                    double band);

/** May it? Never no where it does. */
int vg_region_may_meet(const struct vg_region *r,
                       const struct vg_sizing *sizing, const double a[3],
                       const double b[3], const double c[3], double band);

/** Distances of many points from a region, measured once: questions about
 * their triangles then cost no look-up of sizes. */
struct vg_region_cache {
  const struct vg_region *region; /* borrowed, as the next two */
  const struct vg_sizing *sizing;
  const double (*x)[3];
  double slope, range; /* of the sizing: bounds of its change with the
                          distance, and of any */
  int n_side;          /* of a point: of all planes, then all walls */
  double *side;        /* [points][n_side] */
  double *spacing;     /* [points] at the foot */
};

/** VG_ERR_MEMORY on refusal. Call vg_region_cache_release in any case. */
vg_status vg_region_cache_init(struct vg_region_cache *cache,
                               const struct vg_region *region,
                               const struct vg_sizing *sizing, size_t n,
                               const double (*x)[3], struct vg_error *err);
void vg_region_cache_release(struct vg_region_cache *cache);

/** vg_region_meets of points by their numbers. */
int vg_region_cache_meets(const struct vg_region_cache *cache,
                          const uint32_t v[3], double band);

/** vg_region_may_meet likewise. */
int vg_region_cache_may_meet(const struct vg_region_cache *cache,
                             const uint32_t v[3], double band);

/** Does the cell a b c d, within the walls, cross every plane or have a corner
 * within reach? */
int vg_region_has_cell(const struct vg_region *r,
                       const struct vg_sizing *sizing, const double a[3],
                       const double b[3], const double c[3], const double d[3]);

#endif
