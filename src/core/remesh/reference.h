/* core/remesh/reference.h: the surface as it was given, for questions of
 * distance and size while another one takes its place. Private to
 * core/remesh. */
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
#define VG_REF_GROUP 8 /* points that are asked for at once */

enum { VG_REF_STRIP = 1, VG_REF_CLOSED };
enum { VG_REF_THIN = 1, VG_REF_THIN_FAR = 2 };

struct vg_ref_tri {
  double a[3], u[3], v[3]; /* a corner, the edges from there */
  double n[3];             /* unit normal; 0: too flat to have one */
  double uu, uv, vv;       /* their products */
  double far;              /* of the points, from the corner */
};

struct vg_ref_node { /* of the tree of boxes */
  struct vg_box box;
  double size;         /* least below */
  int8_t normal[2][3]; /* the box of the normals below, outward to whole
                          numbers of VG_REF_NORMAL */
};
#define VG_REF_NORMAL 127

/* Half-edge 3 t + k runs from corner k of triangle t to the next one. */
struct vg_ref {
  size_t n_point, n_tri;
  const double (*point)[3];
  const uint32_t (*tri)[3];
  uint32_t *mate;           /* [3 n_tri] VG_REF_NONE: open */
  struct vg_ref_tri *shape; /* [n_tri] */
  double *size;             /* [n_point] asked for there; vg_ref_sizes */
  double *plain;            /* [n_point] the same but for narrow strips */
  uint8_t *strip;           /* [n_tri] VG_REF_STRIP: asks for less than that;
                               VG_REF_CLOSED: near a strip that is closed.
                               NULL: there are none */
  double slope;             /* growth - 1 */
  uint8_t *thin;            /* [n_tri] another sheet is near: of vg_ref_thin
                               these */
  struct vg_box_tree tree;  /* of struct vg_ref_node; its items are triangles,
                               long ones in pieces, more than once */
};
#define VG_REF_INIT                                                            \
  {                                                                            \
    0                                                                          \
  }

static inline struct vg_ref_node *vg_ref_node(const struct vg_ref *r, size_t i)
{
  return (struct vg_ref_node *)r->tree.node + i;
}

/** The point that half-edge h starts from. */
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

/** Over the triangles of m, which is borrowed and stays as it is. O(n log n).
 * VG_ERR_INPUT for edges of three faces or neighbours that disagree;
 * VG_ERR_STOPPED: stop may be NULL. */
vg_status vg_ref_build(struct vg_ref *r, const struct vg_mesh *m,
                       const struct vg_stop *stop, struct vg_error *err);

/** The first half of that: mates and shapes, but no tree, which is all that
 * lines and strips are found by. */
vg_status vg_ref_set_faces(struct vg_ref *r, const struct vg_mesh *m,
                           const struct vg_stop *stop, struct vg_error *err);

/** The second half. On failure what was there stays. */
vg_status vg_ref_add_tree(struct vg_ref *r, const struct vg_stop *stop,
                          struct vg_error *err);

/** The same of any triangles, and without mates: vg_ref_nearest and
 * vg_ref_within alone can be asked. */
vg_status vg_ref_build_tree(struct vg_ref *r, const struct vg_mesh *m,
                            const struct vg_stop *stop, struct vg_error *err);

/** Take size[n_point] into the tree. */
void vg_ref_sizes(struct vg_ref *r);

/** Mark the triangles that have one within `distance` which faces the other
 * way, or may: where none has, the sheets of the surface cannot be taken for
 * one another. THIN_FAR: within `far`, or not where cap[n_tri] is INFINITY, and
 * so not looked at; cap NULL: none is marked so.
 * O(n log n). VG_ERR_MEMORY, VG_ERR_STOPPED. */
vg_status vg_ref_thin(struct vg_ref *r, double distance, double far,
                      const double *cap, int threads,
                      const struct vg_stop *stop, struct vg_error *err);

void vg_ref_release(struct vg_ref *r);

/** Is a triangle that faces the way of n (a unit vector; NULL: any) within
 * the distance of x? *hint: one to begin with, from which neighbours are
 * tried before the tree; out: the one found, at the squared distance *d2. */
int vg_ref_within(const struct vg_ref *r, const double x[3], const double n[3],
                  double distance, uint32_t *hint, double *d2);

/** Is the segment from a, which is on the surface, to b farther than that from
 * one of the edges below it, as it is followed from triangle to triangle? x
 * out: where. Two surfaces of triangles are farthest from each other at points
 * of one of them, or where their edges cross. hint: a triangle near a. 0 where
 * it cannot be followed: beyond a rim, and where no triangle faces the way of
 * n. */
int vg_ref_leaves(const struct vg_ref *r, const double a[3], const double b[3],
                  const double n[3], double distance, uint32_t hint,
                  double x[3]);

/** Nearest point to x on triangles that face the way of n (as above; those
 * of all ways where none does) into out; returns the distance. *hint: in: one
 * to begin with, out: its triangle. */
double vg_ref_nearest(const struct vg_ref *r, const double x[3],
                      const double n[3], uint32_t *hint, double out[3]);

/** Distances d[n] of points x[n], no more than VG_REF_GROUP, that are near each
 * other. *hint: as above, or VG_REF_NONE; out: the triangle of the last. */
void vg_ref_distances(const struct vg_ref *r, size_t n, const double (*x)[3],
                      uint32_t *hint, double *d);

/** The triangle that a ray from x, a unit vector d along it, meets first, from
 * the side that it faces, within `most`; VG_REF_NONE: none. *far out: how far
 * that is. */
uint32_t vg_ref_ray(const struct vg_ref *r, const double x[3],
                    const double d[3], double most, double *far);

/** A point near x on a triangle that faces the way of n, no farther than on
 * those beside it: a few steps from *hint, which is a triangle. Returns the
 * distance; INFINITY where the steps lead to one that faces another way. */
double vg_ref_project(const struct vg_ref *r, const double x[3],
                      const double n[3], uint32_t *hint, double out[3]);

/** Size at x: the least of all points' own sizes grown with the distance, which
 * is known not to be above `most` (INFINITY: nothing is known).
 * *by: a triangle to begin with, or VG_REF_NONE; out: the one that asks for
 * the size. */
double vg_ref_size(const struct vg_ref *r, const double x[3], double most,
                   uint32_t *by);

/** What triangle t asks for at x. */
double vg_ref_size_by(const struct vg_ref *r, uint32_t t, const double x[3]);

/** All triangles with a box within `distance` of the box, and a few that are
 * farther; some of them more than once. Returns their number; tri gets the
 * first cap of them. */
size_t vg_ref_around(const struct vg_ref *r, const struct vg_box *box,
                     double distance, size_t cap, uint32_t *tri);

/** All of a triangle but its normal. */
void vg_ref_tri_make(struct vg_ref_tri *t, const double a[3], const double b[3],
                     const double c[3]);

/** Barycentric coordinates (of u and v) of the point of a triangle that is
 * nearest to x; returns the squared distance. */
double vg_ref_tri_nearest(const struct vg_ref_tri *t, const double x[3],
                          double *s, double *q);

#endif
