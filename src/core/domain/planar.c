/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: build the constrained Delaunay triangulation of the boundary, flood
 * the inside from the left of the segments, add points by an advancing front,
 * smooth. */
#include "core/domain/planar.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/domain/planar_front.h"
#include "core/domain/planar_tri.h"

enum {
  N_SWEEP = 8,
  LEFT = 8 /* Bit LEFT + k of the flags: half-edge k is a boundary segment. */
};

struct region {
  size_t n, n_edge;
  const double (*p)[2];
  const uint32_t (*edge)[2];
  struct vg_tri2 t;
};

static vg_status check_input(const struct region *r, struct vg_error *err)
{
  if (r->n_edge < 3)
    return vg_fail(err, VG_ERR_INPUT,
                   "plane region: %zu boundary segments; "
                   "a closed loop needs at least 3",
                   r->n_edge);
  if (r->n > VG_T2_POINT_MAX / 2)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "plane region: %zu points are too many", r->n);
  for (size_t i = 0; i < r->n_edge; i++)
    for (int k = 0; k < 2; k++) {
      const uint32_t v = r->edge[i][k];

      if (v >= r->n)
        return vg_fail(err, VG_ERR_INPUT,
                       "plane region: segment %zu names "
                       "point %" PRIu32 " of %zu",
                       i + 1, v + 1, r->n);
      if (!isfinite(r->p[v][0]) || !isfinite(r->p[v][1]))
        return vg_fail(err, VG_ERR_INPUT,
                       "plane region: point %" PRIu32 " (%g, %g) is not finite",
                       v + 1, r->p[v][0], r->p[v][1]);
    }
  return VG_OK;
}

/* Insert the points that are used by segments. */
static vg_status insert_points(struct region *r, struct vg_error *err)
{
  uint32_t *alias = vg_alloc(r->n, sizeof *alias);
  uint32_t *list = vg_alloc(r->n, sizeof *list);
  vg_status st = VG_OK;
  size_t n = 0;

  if (!alias || !list) st = vg_fail_memory(err, "a plane triangulation");
  for (size_t i = 0; st == VG_OK && i < r->n; i++) alias[i] = VG_T2_NONE;
  for (size_t i = 0; st == VG_OK && i < 2 * r->n_edge; i++)
    alias[r->edge[i / 2][i % 2]] = 0;
  for (uint32_t i = 0; st == VG_OK && i < r->n; i++)
    if (!alias[i]) list[n++] = i;
  if (st == VG_OK && (vg_tri2_init(&r->t, r->n, r->p) ||
                      vg_tri2_insert_all(&r->t, n, list, alias)))
    st = vg_fail_memory(err, "a plane triangulation");
  for (size_t i = 0; st == VG_OK && i < n; i++) {
    const uint32_t v = list[i];

    if (alias[v] != v)
      st = vg_fail(err, VG_ERR_GEOMETRY,
                   "plane region: points %" PRIu32 " and %" PRIu32
                   " coincide at (%.9g, %.9g); weld them",
                   alias[v] + 1, v + 1, r->p[v][0], r->p[v][1]);
  }
  free(alias);
  free(list);
  return st;
}

static size_t segment_between(const struct region *r, uint32_t a, uint32_t b)
{
  for (size_t i = 0; i < r->n_edge; i++)
    if ((r->edge[i][0] == a && r->edge[i][1] == b) ||
        (r->edge[i][0] == b && r->edge[i][1] == a))
      return i;
  return r->n_edge;
}

static vg_status crossing(const struct region *r, size_t i, int hit,
                          const uint32_t at[2], struct vg_error *err)
{
  const double *a = r->p[r->edge[i][0]], *b = r->p[r->edge[i][1]];

  if (hit == 1)
    return vg_fail(err, VG_ERR_GEOMETRY,
                   "plane region: point %" PRIu32
                   " (%.9g, %.9g) lies on segment %zu, from (%.9g, %.9g) to "
                   "(%.9g, %.9g); split the segment there",
                   at[0] + 1, r->p[at[0]][0], r->p[at[0]][1], i + 1, a[0], a[1],
                   b[0], b[1]);
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "plane region: segments %zu and %zu "
                 "cross near (%.9g, %.9g) - (%.9g, %.9g); correct the curves "
                 "or make them finer",
                 segment_between(r, at[0], at[1]) + 1, i + 1, a[0], a[1], b[0],
                 b[1]);
}

static vg_status insert_segments(struct region *r, struct vg_error *err)
{
  for (size_t i = 0; i < r->n_edge; i++) {
    const uint32_t a = r->edge[i][0], b = r->edge[i][1];
    uint32_t at[2] = { 0, 0 };
    int hit = 0;
    vg_status st;

    if (a == b)
      return vg_fail(err, VG_ERR_INPUT,
                     "plane region: segment %zu joins "
                     "point %" PRIu32 " to itself",
                     i + 1, a + 1);
    st = vg_tri2_constrain(&r->t, a, b, &hit, at);
    if (st == VG_ERR_GEOMETRY) return crossing(r, i, hit, at, err);
    if (st != VG_OK) return vg_fail_memory(err, "a plane triangulation");
  }
  if (vg_tri2_legalise(&r->t) < 0)
    return vg_fail_memory(err, "a plane triangulation");
  return VG_OK;
}

static int flood(struct vg_tri2 *t, uint32_t from)
{
  size_t n = 0;

  if (t->face[from].flag & VG_T2_INSIDE) return 0;
  t->face[from].flag |= VG_T2_INSIDE;
  if (vg_reserve(&t->stack, &t->cap_stack, 1, sizeof *t->stack)) return -1;
  t->stack[n++] = from;
  while (n) {
    const uint32_t at = t->stack[--n];

    for (uint32_t k = 0; k < 3; k++) {
      const uint32_t o = t->face[at].adj[k];

      if (o == VG_T2_NONE || vg_t2_is_fixed(t, 4 * at + k) ||
          t->face[o >> 2].flag & VG_T2_INSIDE)
        continue;
      t->face[o >> 2].flag |= VG_T2_INSIDE;
      if (vg_reserve(&t->stack, &t->cap_stack, n + 1, sizeof *t->stack))
        return -1;
      t->stack[n++] = o >> 2;
    }
  }
  return 0;
}

/* The region is on the left of the segments. None of its triangles may touch
 * the enclosing triangle or the right side of a segment. */
static vg_status mark_inside(struct region *r, struct vg_error *err)
{
  struct vg_tri2 *t = &r->t;

  for (size_t i = 0; i < r->n_edge; i++) {
    const uint32_t e = vg_tri2_find(t, r->edge[i][0], r->edge[i][1]);
    const uint32_t bit = 1u << (LEFT + (e & 3));

    if (t->face[e >> 2].flag & bit)
      return vg_fail(err, VG_ERR_INPUT,
                     "plane region: segment %zu appears "
                     "twice",
                     i + 1);
    t->face[e >> 2].flag |= bit;
    if (flood(t, e >> 2)) return vg_fail_memory(err, "a plane region");
  }
  for (uint32_t i = 0; i < t->n_face; i++) {
    if (!(t->face[i].flag & VG_T2_INSIDE)) continue;
    for (uint32_t k = 0; k < 3; k++) {
      const uint32_t v = t->face[i].v[k], e = 4 * i + k;

      if (v >= r->n && v < r->n + 3)
        return vg_fail(err, VG_ERR_INPUT,
                       "plane region: the boundary loops "
                       "do not close, or the outer one runs clockwise");
      if (vg_t2_is_fixed(t, e) && !(t->face[i].flag >> (LEFT + k) & 1))
        return vg_fail(err, VG_ERR_INPUT,
                       "plane region: segment %zu at "
                       "(%.9g, %.9g) has the region on its right; its loop "
                       "is reversed or open",
                       segment_between(r, v, vg_t2_to(t, e)) + 1, t->x[v][0],
                       t->x[v][1]);
    }
  }
  for (uint32_t i = 0; i < t->n_face; i++) t->face[i].flag &= ~(7u << LEFT);
  return vg_tri2_carve(t) ? vg_fail_memory(err, "a plane region") : VG_OK;
}

/* Set the size at boundary points from the lengths of their segments. */
static vg_status boundary_size(struct region *r, struct vg_error *err)
{
  uint32_t *n = vg_calloc(r->n, sizeof *n);

  if (!n) return vg_fail_memory(err, "a plane region");
  for (size_t i = 0; i < r->n_edge; i++) {
    const double *a = r->p[r->edge[i][0]], *b = r->p[r->edge[i][1]];
    const double dx = b[0] - a[0], dy = b[1] - a[1];
    const double len = sqrt(dx * dx + dy * dy);

    for (int k = 0; k < 2; k++) {
      r->t.h[r->edge[i][k]] += len;
      n[r->edge[i][k]]++;
    }
  }
  for (size_t i = 0; i < r->n; i++)
    if (n[i]) r->t.h[i] /= n[i];
  free(n);
  return VG_OK;
}

static vg_status hand_over(struct region *r, size_t *n_new, double (**add)[2],
                           size_t *n_tri, uint32_t (**tri)[3],
                           struct vg_error *err)
{
  const struct vg_tri2 *t = &r->t;
  uint32_t *number = vg_calloc(t->n_point, sizeof *number);
  double(*x)[2] = vg_alloc(t->n_point, sizeof *x);
  uint32_t(*list)[3];
  size_t n = 0, n_added = 0, n_live = 0;

  for (size_t i = 0; i < t->n_face; i++)
    n_live += !(t->face[i].flag & VG_T2_DEAD);
  list = vg_alloc(n_live, sizeof *list);
  if (!number || !x || !list) {
    free(number);
    free(x);
    free(list);
    return vg_fail_memory(err, "a plane triangulation");
  }
  for (size_t i = 0; i < r->n; i++) number[i] = (uint32_t)i;
  for (size_t i = r->n + 3; i < t->n_point; i++) {
    if (t->vt[i] == VG_T2_NONE) continue;
    number[i] = (uint32_t)(r->n + n_added);
    x[n_added][0] = t->x[i][0];
    x[n_added++][1] = t->x[i][1];
  }
  for (size_t i = 0; i < t->n_face; i++) {
    if (t->face[i].flag & VG_T2_DEAD) continue;
    for (int k = 0; k < 3; k++) list[n][k] = number[t->face[i].v[k]];
    n++;
  }
  free(number);
  *n_new = n_added;
  *add = x;
  *n_tri = n;
  *tri = list;
  return VG_OK;
}

vg_status vg_planar_mesh(size_t n, const double (*p)[2], size_t n_edge,
                         const uint32_t (*edge)[2],
                         const struct vg_planar_law *law, size_t *n_new,
                         double (**add)[2], size_t *n_tri, uint32_t (**tri)[3],
                         struct vg_error *err)
{
  struct region r = { .n = n, .n_edge = n_edge, .p = p, .edge = edge };
  int bad;
  vg_status st;

  assert(law->at && n_new && add && n_tri && tri);
  VG_TRY(check_input(&r, err));
  VG_TRY(insert_points(&r, err));
  VG_TRY(insert_segments(&r, err));
  VG_TRY(mark_inside(&r, err));
  VG_TRY(boundary_size(&r, err));
  bad = vg_tri2_fill(&r.t, law);
  if (!bad) bad = vg_tri2_improve(&r.t, (uint32_t)n + 3, N_SWEEP, law);
  if (bad > 0) {
    st = vg_fail(err, VG_ERR_STOPPED, "interrupted");
    goto done;
  }
  if (bad) {
    st = vg_fail(err, VG_ERR_MEMORY,
                 "plane region with %zu boundary segments: not enough "
                 "memory, or more than %u points; the spacing in it may be "
                 "far too small",
                 n_edge, VG_T2_POINT_MAX);
    goto done;
  }
  VG_CHECK("the triangulation of a plane region", vg_tri2_defects(&r.t));
  st = hand_over(&r, n_new, add, n_tri, tri, err);
done:
  vg_tri2_release(&r.t);
  return st;
}
