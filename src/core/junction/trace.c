/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: a walk along the edges of the remeshed surface from the first point
 * of the junction. Points of feature curves are on the old curve except for
 * rounding; of the neighbours that are on it, the next one is taken. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/table.h"
#include "core/geometry/vector.h"
#include "core/junction/junction_parts.h"
#include "core/mesh/edges.h"

#define ON 1e-9 /* of the box: distance of points on a curve */
#define FAR                                                                    \
  20.0 /* arc length of an edge of the new surface, in its lengths             \
        */

struct tracer {
  struct vg_junctions *j;
  const struct vg_mesh *made;
  uint32_t *start, *near; /* Neighbours of each point of made. */
  struct vg_table places; /* Points of made by their coordinates. */
  double on2;             /* Largest squared distance from the curve. */
};

/* A place on a curve: its segment and its arc length. */
struct place {
  size_t k;
  double s;
};

static vg_status list_neighbours(struct tracer *w, struct vg_error *err)
{
  const struct vg_mesh *m = w->made;
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])m->tri;
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st;

  VG_TRY(vg_edges_build(&e, m->n_point, m->n_tri, tri, NULL, 0, err));
  w->start = vg_calloc(m->n_point + 2, sizeof *w->start);
  w->near = vg_alloc(2 * e.n, sizeof *w->near);
  if (!w->start || !w->near)
    VG_TRY(vg_fail_memory(err, "the junctions of inner surfaces"));
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < e.n; i++) {
      const uint32_t h = vg_edges_at(&e, i)[0];
      const uint32_t v[2] = { vg_half_from(tri, h), vg_half_to(tri, h) };

      for (int k = 0; k < 2; k++)
        if (!pass) w->start[v[k] + 2]++;
        else w->near[w->start[v[k] + 1]++] = v[!k];
    }
    for (size_t p = 1; !pass && p < m->n_point + 2; p++)
      w->start[p] += w->start[p - 1];
  }
done:
  vg_edges_release(&e);
  return st;
}

static int is_same_place(const double a[3], const double b[3])
{
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static uint32_t *slot_of(const struct tracer *w, const double *x)
{
  uint32_t *at;

  VG_TABLE_FIND(&w->places, at, vg_hash_point(x),
                is_same_place(w->made->point[*at], x));
  return at;
}

static vg_status list_places(struct tracer *w, struct vg_error *err)
{
  if (vg_table_init(&w->places, w->made->n_point))
    return vg_fail_memory(err, "the junctions of inner surfaces");
  for (size_t p = 0; p < w->made->n_point; p++) {
    uint32_t *at = slot_of(w, w->made->point[p]);

    if (*at == VG_TABLE_FREE) *at = (uint32_t)p;
  }
  return VG_OK;
}

/* The first place after `from` on curve c, at most `most` further, at which x
 * is. Returns 0 if x is on no such place. */
static int locate(const struct tracer *w, const struct vg_junction *c,
                  const struct place *from, double most, const double x[3],
                  struct place *to)
{
  const struct vg_junctions *j = w->j;
  const double *at = j->at + c->first;
  const uint32_t *p = j->point + c->first;

  for (size_t k = from->k; k + 1 < c->n && at[k] <= from->s + most; k++) {
    const double *a = j->m->point[p[k]], *b = j->m->point[p[k + 1]];
    double u[3], v[3], uu, t;

    vg_sub(b, a, u);
    vg_sub(x, a, v);
    uu = vg_dot(u, u);
    t = uu > 0 ? fmin(fmax(vg_dot(u, v) / uu, 0), 1) : 0;
    for (int d = 0; d < 3; d++) v[d] -= t * u[d];
    if (vg_dot(v, v) > w->on2) continue;
    to->k = k;
    to->s = at[k] + t * (at[k + 1] - at[k]);
    if (to->s > from->s + sqrt(w->on2)) return 1;
  }
  return 0;
}

static vg_status lost(const struct tracer *w, const struct vg_junction *c,
                      const double x[3], struct vg_error *err)
{
  const double *a = w->j->m->point[w->j->point[c->first]];
  const double *b = w->j->m->point[w->j->point[c->first + c->n - 1]];

  return vg_fail(err, VG_ERR_GEOMETRY,
                 "the remeshed surface has lost the curve from (%g, %g, %g) to "
                 "(%g, %g, %g), along which an inner surface touches it, near "
                 "(%g, %g, %g): points of the surface may lie within rounding "
                 "of the curve; move the inner surface by a little, or give "
                 "surfaces that share the edges of the curve",
                 a[0], a[1], a[2], b[0], b[1], b[2], x[0], x[1], x[2]);
}

static vg_status add(struct vg_junctions *j, struct vg_junction *c, uint32_t p,
                     double s, struct vg_error *err)
{
  if (vg_reserve(&j->made, &j->cap_made[0], j->n_made + 1, sizeof *j->made) ||
      vg_reserve(&j->made_at, &j->cap_made[1], j->n_made + 1,
                 sizeof *j->made_at) ||
      vg_reserve(&j->made_x, &j->cap_made[2], j->n_made + 1, sizeof *j->made_x))
    return vg_fail_memory(err, "the junctions of inner surfaces");
  j->made[j->n_made] = p;
  j->made_at[j->n_made++] = s;
  c->n_made++;
  return VG_OK;
}

static vg_status trace(struct tracer *w, struct vg_junction *c,
                       struct vg_error *err)
{
  struct vg_junctions *j = w->j;
  const double *end = j->m->point[j->point[c->first + c->n - 1]];
  const double(*x)[3] = (const double(*)[3])w->made->point;
  struct place at = { 0, 0 };
  uint32_t p = *slot_of(w, j->m->point[j->point[c->first]]);
  vg_status st;

  c->made = j->n_made;
  if (p == VG_TABLE_FREE)
    return lost(w, c, j->m->point[j->point[c->first]], err);
  VG_TRY(add(j, c, p, 0, err));
  do {
    struct place best = { 0, INFINITY }, to;
    uint32_t next = VG_JUNCTION_NONE;

    for (uint32_t k = w->start[p]; k < w->start[p + 1]; k++) {
      const uint32_t q = w->near[k];

      if (locate(w, c, &at, FAR * vg_distance(x[p], x[q]), x[q], &to) &&
          to.s < best.s)
        best = to, next = q;
    }
    if (next == VG_JUNCTION_NONE) return lost(w, c, x[p], err);
    p = next;
    at = best;
    VG_TRY(add(j, c, p, at.s, err));
  } while (at.k + 2 < c->n || !is_same_place(x[p], end));
done:
  return st;
}

/* No curve is divided after a failure. */
static void forget(struct vg_junctions *j, size_t n_made)
{
  for (size_t i = 0; i < j->n; i++)
    if (j->curve[i].made >= n_made) j->curve[i].n_made = 0;
  j->n_made = n_made;
}

vg_status vg_junctions_trace(struct vg_junctions *j, uint32_t piece,
                             const struct vg_mesh *made, struct vg_error *err)
{
  const size_t n_made = j->n_placed = j->n_made;
  struct tracer w = { .j = j, .made = made };
  uint8_t *on = vg_calloc(j->n, 1);
  double lo[3], hi[3];
  vg_status st = on ? VG_OK
                    : vg_fail_memory(err, "the junctions of inner surfaces");

  VG_TRY(st);
  vg_mesh_bounds(j->m, lo, hi);
  w.on2 = ON * ON * vg_distance2(lo, hi);
  VG_TRY(list_neighbours(&w, err));
  VG_TRY(list_places(&w, err));
  vg_junctions_of(j, piece, on);
  for (size_t i = 0; i < j->n; i++)
    if (on[i] && !j->curve[i].n_made) VG_TRY(trace(&w, &j->curve[i], err));
done:
  if (st < 0) forget(j, n_made);
  vg_table_release(&w.places);
  free(w.start);
  free(w.near);
  free(on);
  if (st >= 0) vg_junctions_place(j, made);
  return st;
}

/* Points of earlier traces have their coordinates already. */
void vg_junctions_place(struct vg_junctions *j, const struct vg_mesh *made)
{
  for (size_t i = j->n_placed; i < j->n_made; i++)
    memcpy(j->made_x[i], made->point[j->made[i]], sizeof *j->made_x);
}
