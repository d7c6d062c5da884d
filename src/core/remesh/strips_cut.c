/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/remesh/strips_cut.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define END 1e-3 /* of an edge: no cut closer to its ends */

vg_status vg_strip_cutter_begin(struct vg_strip_cutter *c,
                                const struct vg_ref *r, const struct vg_mesh *m,
                                struct vg_error *err)
{
  struct vg_strips *s = c->s;
  const size_t n = 3 * m->n_tri;
  vg_status st;

  VG_TRY(vg_mesh_copy(&s->mesh, m, err));
  c->edge = VG_REF_NONE;
  c->cap_mate = c->cap_half = c->cap_closed = n;
  c->cap_tri = c->cap_patch = c->cap_from = m->n_tri;
  c->cap_point = m->n_point;
  c->mate = vg_alloc(n, sizeof *c->mate);
  c->where = vg_alloc(n, sizeof *c->where);
  s->closed = vg_calloc(n, 1);
  s->tri_from = vg_alloc(m->n_tri, sizeof *s->tri_from);
  s->half_from = vg_alloc(n, sizeof *s->half_from);
  if (!c->mate || !c->where || !s->closed || !s->tri_from || !s->half_from)
    VG_TRY(vg_fail_memory(err, "narrow strips"));
  memcpy(c->mate, r->mate, n * sizeof *c->mate);
  for (uint32_t h = 0; h < n; h++) c->where[h] = s->half_from[h] = h;
  for (uint32_t t = 0; t < m->n_tri; t++) s->tri_from[t] = t;
done:
  return st;
}

void vg_strip_cutter_release(struct vg_strip_cutter *c)
{
  free(c->mate);
  free(c->where);
}

static vg_status make_room(struct vg_strip_cutter *c, struct vg_error *err)
{
  struct vg_strips *s = c->s;
  struct vg_mesh *m = &s->mesh;
  const size_t n = m->n_tri + 2;

  if (m->n_point >= UINT32_MAX || 3 * n >= UINT32_MAX)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the surface has too many "
                   "triangles to split the edges of "
                   "its feature curves");
  if (vg_reserve(&m->point, &c->cap_point, m->n_point + 1, sizeof *m->point) ||
      vg_reserve(&m->tri, &c->cap_tri, n, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &c->cap_patch, n, sizeof *m->tri_patch) ||
      vg_reserve(&s->tri_from, &c->cap_from, n, sizeof *s->tri_from) ||
      vg_reserve(&s->closed, &c->cap_closed, 3 * n, 1) ||
      vg_reserve(&c->mate, &c->cap_mate, 3 * n, sizeof *c->mate) ||
      vg_reserve(&s->half_from, &c->cap_half, 3 * n, sizeof *s->half_from) ||
      vg_reserve(&s->ends, &c->cap_ends, s->n_new + 1, sizeof *s->ends))
    return vg_fail_memory(err, "narrow strips");
  return VG_OK;
}

static void join(struct vg_strip_cutter *c, uint32_t g, uint32_t h)
{
  c->mate[g] = h;
  if (h != VG_REF_NONE) c->mate[h] = g;
}

/* Half-edge `from` becomes half-edge `to`. */
static void move(struct vg_strip_cutter *c, uint32_t from, uint32_t to)
{
  const uint32_t first = c->s->half_from[from];

  join(c, to, c->mate[from]);
  c->s->half_from[to] = first;
  if (first != VG_REF_NONE && c->where[first] == from) c->where[first] = to;
  c->s->closed[to] = c->s->closed[from];
}

static void set_inner(struct vg_strip_cutter *c, uint32_t h)
{
  c->s->half_from[h] = VG_REF_NONE;
  c->s->closed[h] = 0;
}

/* Split the triangle of h by an edge from point m on h to the opposite corner;
 * h then ends at m. Returns the second half of h. */
static uint32_t halve(struct vg_strip_cutter *c, uint32_t h, uint32_t m)
{
  struct vg_mesh *mesh = &c->s->mesh;
  const uint32_t t = h / 3, n = (uint32_t)mesh->n_tri++, i = h % 3;
  const uint32_t j = (i + 1) % 3, k = (i + 2) % 3;

  memcpy(mesh->tri[n], mesh->tri[t], sizeof *mesh->tri);
  mesh->tri[t][j] = mesh->tri[n][i] = m;
  mesh->tri_patch[n] = mesh->tri_patch[t];
  c->s->tri_from[n] = c->s->tri_from[t];
  move(c, 3 * t + j, 3 * n + j);
  join(c, 3 * t + j, 3 * n + k);
  set_inner(c, 3 * t + j);
  set_inner(c, 3 * n + k);
  c->s->half_from[3 * n + i] = c->s->half_from[h];
  c->s->closed[3 * n + i] = 0;
  return 3 * n + i;
}

/* Insert a point at position t of edge h, which then ends there. *rest is the
 * second half. */
static vg_status cut(struct vg_strip_cutter *c, uint32_t h, double t,
                     uint32_t *rest, struct vg_error *err)
{
  struct vg_strips *s = c->s;
  struct vg_mesh *mesh = &s->mesh;
  uint32_t g = c->mate[h], m, back;
  const double *a, *b;
  vg_status st;

  VG_TRY(make_room(c, err));
  m = (uint32_t)mesh->n_point++;
  s->ends[s->n_new][0] = mesh->tri[h / 3][h % 3];
  s->ends[s->n_new][1] = mesh->tri[h / 3][(h % 3 + 1) % 3];
  a = mesh->point[s->ends[s->n_new][0]];
  b = mesh->point[s->ends[s->n_new++][1]];
  for (int d = 0; d < 3; d++) mesh->point[m][d] = a[d] + t * (b[d] - a[d]);
  *rest = halve(c, h, m);
  if (g != VG_REF_NONE) {
    back = halve(c, g, m);
    join(c, h, back);
    join(c, *rest, g);
  } else c->mate[*rest] = VG_REF_NONE;
done:
  return st;
}

static void mark(struct vg_strip_cutter *c, uint32_t h)
{
  c->s->closed[h] = 1;
  if (c->mate[h] != VG_REF_NONE) c->s->closed[c->mate[h]] = 1;
}

/* Cut the remaining part of the current edge at position t of the whole
 * edge. */
static vg_status cut_at(struct vg_strip_cutter *c, double t,
                        struct vg_error *err)
{
  uint32_t h = c->where[c->edge], rest;
  vg_status st;

  VG_TRY(cut(c, h, (t - c->begun) / (1 - c->begun), &rest, err));
  c->where[c->edge] = rest;
  c->begun = t;
done:
  return st;
}

vg_status vg_strip_cut(struct vg_strip_cutter *c, uint32_t h, double t0,
                       double t1, struct vg_error *err)
{
  uint32_t piece;
  vg_status st = VG_OK;

  assert(t0 <= t1);
  if (c->edge != h) c->edge = h, c->begun = 0;
  if (t0 > c->begun + END && t0 < 1 - END) VG_TRY(cut_at(c, t0, err));
  piece = c->where[h];
  if (t1 < 1 - END && t1 > c->begun + END) VG_TRY(cut_at(c, t1, err));
  if (t1 > c->begun - END && t0 < 1 - END) mark(c, piece);
done:
  return st;
}
