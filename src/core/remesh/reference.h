/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/remesh/reference.h: the reference surface: the triangles of the input
 * with a search tree for queries of distance, orientation and size while the
 * surface is remeshed. Private to core/remesh.
 *
 * A triangle is oriented like a vector n if the cosine between its normal and n
 * exceeds 0.7 (S22). A triangle too flat to have a normal is oriented like any
 * n. */
#ifndef VG_CORE_REMESH_REFERENCE_H
#define VG_CORE_REMESH_REFERENCE_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "base/stop.h"
#include "core/mesh/edges.h"
#include "core/mesh/mesh.h"
#include "core/search/box_tree.h"

#define VG_REF_NONE UINT32_MAX
#define VG_REF_GROUP 8 /* most points in one query */

enum { VG_REF_STRIP = 1, VG_REF_CLOSED };
enum { VG_REF_THIN = 1, VG_REF_THIN_FAR = 2 };

struct vg_ref_tri {
  double a[3], u[3], v[3]; /* A corner, and the edges from it to the next two
                              corners. */
  double n[3];             /* Unit normal; 0: too flat to have one. */
  double uu, uv, vv;       /* Inner products of u and v. */
  double far;              /* Largest distance of the other points from corner
                              a. */
};

struct vg_ref_node { /* Node of the search tree. */
  struct vg_box box;
  double size;         /* Least size below the node. */
  int8_t normal[2][3]; /* Box of the normals below the node, rounded outwards to
                          multiples of 1 / VG_REF_NORMAL. */
};
#define VG_REF_NORMAL 127

/* Half-edge 3 t + k runs from corner k of triangle t to the next corner. */
struct vg_ref {
  size_t n_point, n_tri;
  const double (*point)[3];
  const uint32_t (*tri)[3];
  uint32_t *mate;           /* [3 n_tri] Opposite half-edge; VG_REF_NONE: open
                               rim. */
  struct vg_ref_tri *shape; /* [n_tri] Geometry of the triangles. */
  double *size;             /* [n_point] Target edge length; see
                               vg_ref_sizes. */
  double *plain;            /* [n_point] The same without the effect of narrow
                               strips. */
  uint8_t *strip;           /* [n_tri] VG_REF_STRIP: a strip reduces the size
                               below `plain`; VG_REF_CLOSED: near a closed
                               strip. May be NULL. */
  double *fine;             /* [n_tri] Tolerance in narrow patches; INFINITY
                               elsewhere. May be NULL. */
  double *fine_at;          /* [n_point] The least of them around each point;
                               NULL with `fine`. */
  double slope;             /* Growth - 1. */
  uint8_t *thin;            /* [n_tri] VG_REF_THIN, VG_REF_THIN_FAR: another
                               sheet is near; see vg_ref_thin. */
  struct vg_box_tree tree;  /* Search tree of struct vg_ref_node. Its items are
                               triangles; long ones occur several times, in
                               pieces. */
};
#define VG_REF_INIT                                                            \
  {                                                                            \
    0                                                                          \
  }

static inline struct vg_ref_node *vg_ref_node(const struct vg_ref *r, size_t i)
{
  return (struct vg_ref_node *)r->tree.node + i;
}

/** Start point of half-edge h. */
static inline uint32_t vg_ref_from(const struct vg_ref *r, uint32_t h)
{
  assert(h < 3 * r->n_tri);
  return r->tri[h / 3][h % 3];
}

static inline uint32_t vg_ref_to(const struct vg_ref *r, uint32_t h)
{
  return vg_ref_from(r, vg_half_next(h));
}

static inline const double *vg_ref_at(const struct vg_ref *r, uint32_t h)
{
  return r->point[vg_ref_from(r, h)];
}

/** Build the reference of m, whose points and triangles are borrowed and must
 * not change. O(n log n). VG_ERR_INPUT for edges of three faces or neighbours
 * of opposite orientation; VG_ERR_STOPPED: stop may be NULL. */
vg_status vg_ref_build(struct vg_ref *r, const struct vg_mesh *m,
                       const struct vg_stop *stop, struct vg_error *err);

/** As vg_ref_build. On a surface of needles, as a metric requests them, the
 * tree needs a third of the memory or less, and searches take longer. */
vg_status vg_ref_build_sparse(struct vg_ref *r, const struct vg_mesh *m,
                              const struct vg_stop *stop, struct vg_error *err);

/** First half of vg_ref_build: mates and shapes without the tree, which is
 * sufficient to find feature curves and strips. */
vg_status vg_ref_set_faces(struct vg_ref *r, const struct vg_mesh *m,
                           const struct vg_stop *stop, struct vg_error *err);

/** Second half of vg_ref_build: the tree. On failure r is unchanged. */
vg_status vg_ref_add_tree(struct vg_ref *r, const struct vg_stop *stop,
                          struct vg_error *err);

/** Like vg_ref_build, for arbitrary triangles and without mates: only queries
 * that need no mates, such as vg_ref_nearest and vg_ref_within, are possible.
 */
vg_status vg_ref_build_tree(struct vg_ref *r, const struct vg_mesh *m,
                            const struct vg_stop *stop, struct vg_error *err);

/** Propagate size[n_point] to the nodes of the tree. */
void vg_ref_sizes(struct vg_ref *r);

/** Mark the triangles that have an opposed triangle, or one without a normal,
 * within `distance`. Where no triangle is marked, the sheets of the surface
 * cannot be mistaken for each other. THIN_FAR: such a triangle is within `far`,
 * or cap[n_tri] is not INFINITY and `far` was not checked; cap NULL: no
 * triangle is marked THIN_FAR. O(n log n). VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_ref_thin(struct vg_ref *r, double distance, double far,
                      const double *cap, int threads,
                      const struct vg_stop *stop, struct vg_error *err);

void vg_ref_release(struct vg_ref *r);

/** Is a triangle oriented like n (a unit vector; NULL: any) within the distance
 * of x?
 *
 * @param hint  in: first triangle, from which neighbours are tried before the
 *              tree, or VG_REF_NONE; out: the triangle found
 * @param d2    out: its squared distance */
int vg_ref_within(const struct vg_ref *r, const double x[3], const double n[3],
                  double distance, uint32_t *hint, double *d2);

/** Follow the segment from a, which is on the surface, to b from triangle to
 * triangle across the edges of the reference. Returns 1 if it is farther than
 * `distance` from the triangles at one of these edges, and sets x to that point
 * of the segment. The distance between two triangulated surfaces has its
 * maximum at a point of one of them or where edges of both cross. Returns 0
 * also if the segment cannot be followed: beyond a rim, and where no triangle
 * is oriented like n.
 *
 * @param hint  a triangle near a */
int vg_ref_leaves(const struct vg_ref *r, const double a[3], const double b[3],
                  const double n[3], double distance, uint32_t hint,
                  double x[3]);

/** Set out to the nearest point to x on triangles oriented like n (as above),
 * or on any triangle if no such triangle exists. Returns the distance.
 *
 * @param hint  in: first triangle, or VG_REF_NONE; out: triangle of the
 *              point */
double vg_ref_nearest(const struct vg_ref *r, const double x[3],
                      const double n[3], uint32_t *hint, double out[3]);

/** Distances d[n] of points x[n] that are close together; n is at most
 * VG_REF_GROUP.
 *
 * @param hint  as above; out: the triangle nearest to the last point */
void vg_ref_distances(const struct vg_ref *r, size_t n, const double (*x)[3],
                      uint32_t *hint, double *d);

/** The first triangle that a ray from x along the unit vector d hits on its
 * front side, within `most`; VG_REF_NONE if it hits no triangle.
 *
 * @param far  out: distance from x */
uint32_t vg_ref_ray(const struct vg_ref *r, const double x[3],
                    const double d[3], double most, double *far);

/** Project x to a nearby triangle oriented like n by a few steps from triangle
 * *hint to neighbours; the result need not be the nearest point of the surface.
 * Sets out to the point. Returns the distance; INFINITY if the steps end at a
 * triangle that is not oriented like n. */
double vg_ref_project(const struct vg_ref *r, const double x[3],
                      const double n[3], uint32_t *hint, double out[3]);

/** Size at x: the minimum over all points of their own size plus growth with
 * the distance.
 *
 * @param most  known upper bound of the size, or INFINITY
 * @param by    in: first triangle, or VG_REF_NONE; out: the triangle that
 *              determines the size */
double vg_ref_size(const struct vg_ref *r, const double x[3], double most,
                   uint32_t *by);

/** Size that triangle t determines at x. */
double vg_ref_size_by(const struct vg_ref *r, uint32_t t, const double x[3]);

/** Triangles whose box is within `distance` of the given box, and a few that
 * are farther; some occur more than once. Returns their number; the first cap
 * of them are stored in tri. The search ends when it finds more than these,
 * unless tri is NULL. */
size_t vg_ref_around(const struct vg_ref *r, const struct vg_box *box,
                     double distance, size_t cap, uint32_t *tri);

/** Set all members except the normal. */
void vg_ref_tri_make(struct vg_ref_tri *t, const double a[3], const double b[3],
                     const double c[3]);

/** Barycentric coordinates (for u and v) of the point of a triangle nearest to
 * x. Returns the squared distance. */
double vg_ref_tri_nearest(const struct vg_ref_tri *t, const double x[3],
                          double *s, double *q);

#endif
