/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* core/domain/planar_tri.h: the constrained Delaunay triangulation used by
 * vg_planar_mesh. Private to planar*.c.
 *
 * A half-edge is 4 * triangle + k, k = 0, 1, 2, and runs from vertex k to
 * vertex k + 1 of its triangle; the triangle is on its left. Invariant between
 * calls: all live triangles are counter-clockwise (exactly), adjacency is
 * symmetric, and every unconstrained edge is locally Delaunay (exactly), unless
 * the caller has moved points and not yet called vg_tri2_legalise. */
#ifndef VG_CORE_DOMAIN_PLANAR_TRI_H
#define VG_CORE_DOMAIN_PLANAR_TRI_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

#define VG_T2_NONE UINT32_MAX

/* More points than the surface of any mesh has: a size function that requests
 * them is wrong, and is refused before memory is exhausted. */
#define VG_T2_POINT_MAX 100000000u

enum {
  VG_T2_EDGE = 7, /* Bits 0..2: half-edge k is constrained. */
  VG_T2_INSIDE = 8,
  VG_T2_DEAD = 16,
  VG_T2_DONE = 32,  /* The front will not subdivide it. */
  VG_T2_CAVITY = 64 /* In the cavity under construction. */
};

struct vg_t2_face {
  uint32_t v[3], flag;
  uint32_t adj[3], stamp; /* `stamp` changes whenever the slot is rewritten. */
};

/* A directed edge on the border of a cavity, which is on its left. */
struct vg_t2_border {
  uint32_t a, b, outer; /* outer: half-edge b -> a outside, or NONE. */
  uint32_t constrained;
};

struct vg_tri2 {
  size_t n_point, cap_point, cap_h, cap_vt;
  double (*x)[2];
  double *h;    /* Target edge length at each point. */
  uint32_t *vt; /* A half-edge that leaves each point, or NONE. */
  size_t n_face, cap_face;
  struct vg_t2_face *face;
  uint32_t *unused; /* Stack of dead slots. */
  size_t n_unused, cap_unused;
  uint32_t *cavity, *stack;
  size_t n_cavity, cap_cavity, cap_stack;
  struct vg_t2_border *border;
  size_t n_border, cap_border;
  uint32_t walk; /* Triangle from which the next search starts. */
};

static inline uint32_t vg_t2_next(uint32_t e)
{
  return (e & 3) == 2 ? e - 2 : e + 1;
}

static inline uint32_t vg_t2_prev(uint32_t e)
{
  return (e & 3) == 0 ? e + 2 : e - 1;
}

static inline uint32_t vg_t2_from(const struct vg_tri2 *t, uint32_t e)
{
  assert(e >> 2 < t->n_face && (e & 3) < 3);
  return t->face[e >> 2].v[e & 3];
}

static inline uint32_t vg_t2_to(const struct vg_tri2 *t, uint32_t e)
{
  return vg_t2_from(t, vg_t2_next(e));
}

static inline uint32_t vg_t2_apex(const struct vg_tri2 *t, uint32_t e)
{
  return vg_t2_from(t, vg_t2_prev(e));
}

static inline uint32_t vg_t2_twin(const struct vg_tri2 *t, uint32_t e)
{
  assert(e >> 2 < t->n_face && (e & 3) < 3);
  return t->face[e >> 2].adj[e & 3];
}

static inline int vg_t2_is_fixed(const struct vg_tri2 *t, uint32_t e)
{
  assert(e >> 2 < t->n_face && (e & 3) < 3);
  return t->face[e >> 2].flag >> (e & 3) & 1;
}

/** Number of violations of the above invariant, as a stage check
 * (base/checks.h). O(triangles). */
size_t vg_tri2_defects(const struct vg_tri2 *t);

/** Copy n points, add the three corners of an enclosing triangle as points n, n
 * + 1 and n + 2, and create that triangle. Returns 0, or -1 without memory. */
int vg_tri2_init(struct vg_tri2 *t, size_t n, const double (*p)[2]);

void vg_tri2_release(struct vg_tri2 *t);

/** Insert the listed points into the triangulation. Returns 0, or -1 without
 * memory.
 *
 * @param alias  out: [n of init] vertex that represents a point: itself, or the
 *               first inserted point with the same coordinates; not set for
 *               points that are not listed */
int vg_tri2_insert_all(struct vg_tri2 *t, size_t n, const uint32_t *list,
                       uint32_t *alias);

/** Make the segment a -> b an edge and constrain it. VG_ERR_GEOMETRY: *hit is 1
 * if point at[0] is on it, 2 if it crosses the constrained edge at[0] at[1]. */
vg_status vg_tri2_constrain(struct vg_tri2 *t, uint32_t a, uint32_t b, int *hit,
                            uint32_t at[2]);

/** The half-edge a -> b, or NONE. */
uint32_t vg_tri2_find(const struct vg_tri2 *t, uint32_t a, uint32_t b);

/** The triangle that contains x, by a walk from t->walk. With stop_at_fixed,
 * NONE if a constrained edge or the border is in the way. */
uint32_t vg_tri2_locate(struct vg_tri2 *t, const double x[2],
                        int stop_at_fixed);

/** Collect the cavity of x, which is in triangle `at`, in cavity[] and
 * border[]. Returns 1; 0 if x cannot be inserted there; -1 without memory.
 * Always call vg_tri2_commit or vg_tri2_cancel afterwards. */
int vg_tri2_cavity(struct vg_tri2 *t, const double x[2], uint32_t at);

/** Fill the cavity with triangles around point `p`; the new triangles are the
 * first n_border of cavity[], in the order of border[]. Returns 0 or -1. */
int vg_tri2_commit(struct vg_tri2 *t, uint32_t p, uint32_t flag);
void vg_tri2_cancel(struct vg_tri2 *t);

/** Append a point. Returns its index, or NONE without memory or beyond
 * VG_T2_POINT_MAX. */
uint32_t vg_tri2_add_point(struct vg_tri2 *t, const double x[2], double h);

/** Flip edges until every unconstrained edge is Delaunay. Returns the number of
 * flips, -1 without memory. */
long vg_tri2_legalise(struct vg_tri2 *t);

/** Remove every face without VG_T2_INSIDE and rebuild vt. Returns 0 or -1. */
int vg_tri2_carve(struct vg_tri2 *t);

/** Half-edges leaving vertex v, counter-clockwise. Returns their number; 0 if v
 * is on the border or has more than `max`. */
int vg_tri2_ring(const struct vg_tri2 *t, uint32_t v, int max, uint32_t *ring);

#endif
