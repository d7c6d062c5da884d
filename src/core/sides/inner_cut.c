/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edges of sheets that are cut in the middle. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/sides/inner_parts.h"

/* Would both sides of triangle t, through which no fluid passes, have the same
 * points? */
static int is_same(const struct vg_inner_work *s, size_t t)
{
  const uint32_t *sector = s->sides.sector + 6 * t;
  int n = 0;

  if (!vg_is_sheet(s, t) || vg_is_passed(s, t)) return 0;
  for (int k = 0; k < 3; k++) n += s->room[sector[k]] == s->room[sector[3 + k]];
  return n == 3;
}

/* Rank of half-edge h for a cut: edges of sheets alone before those of walls;
 * free edges have none, nor have those at which the mesh passes around the
 * triangle. */
static int rank_of(const struct vg_inner_work *s, uint32_t h)
{
  const size_t i = s->sides.edge.of_half[h];
  const uint32_t n = vg_edges_count(&s->sides.edge, i);
  uint32_t n_solid = 0;
  int has_wall = 0;

  for (uint32_t k = 0; k < n; k++) {
    const uint32_t t = vg_edges_at(&s->sides.edge, i)[k] / 3;

    n_solid += !vg_is_passed(s, t);
    has_wall |= !vg_is_sheet(s, t);
  }
  return n_solid < 2 ? 0 : has_wall ? 1 : 2;
}

/* The half-edge of triangle t to cut; UINT32_MAX: all are free. */
static uint32_t edge_to_cut(const struct vg_inner_work *s, uint32_t t)
{
  uint32_t best = UINT32_MAX;
  double longest = 0;
  int most = 0;

  for (uint32_t h = 3 * t; h < 3 * t + 3; h++) {
    const double *a = s->m->point[vg_half_from(s->sides.tri, h)];
    const double *b = s->m->point[vg_half_to(s->sides.tri, h)];
    const double length = vg_distance(a, b);
    const int rank = rank_of(s, h);

    if (rank < most || !rank || (rank == most && length <= longest)) continue;
    best = h;
    most = rank;
    longest = length;
  }
  return best;
}

/* Appends the point with weights 1 / n of the n points v. Returns it. */
static uint32_t add_middle(struct vg_mesh *m, const uint32_t *v, int n)
{
  double *x = m->point[m->n_point];

  for (int d = 0; d < 3; d++) {
    x[d] = 0;
    for (int k = 0; k < n; k++) x[d] += m->point[v[k]][d] / n;
  }
  return (uint32_t)m->n_point++;
}

/* Appends a copy of triangle t in which corner k is point p. */
static void add_copy(struct vg_mesh *m, size_t t, uint32_t k, uint32_t p)
{
  memcpy(m->tri[m->n_tri], m->tri[t], sizeof *m->tri);
  m->tri[m->n_tri][k] = p;
  m->tri_patch[m->n_tri++] = m->tri_patch[t];
}

/* Cuts the edge of half-edge h, with all its triangles. */
static void cut_edge(struct vg_inner_work *s, uint32_t h, uint8_t *is_done)
{
  const struct vg_edges *e = &s->sides.edge;
  const uint32_t end[2] = { s->m->tri[h / 3][h % 3],
                            s->m->tri[h / 3][vg_half_next(h) % 3] };
  const uint32_t p = add_middle(s->m, end, 2), i = e->of_half[h];

  for (uint32_t k = 0; k < vg_edges_count(e, i); k++) {
    const uint32_t g = vg_edges_at(e, i)[k];

    is_done[g / 3] = 1;
    add_copy(s->m, g / 3, g % 3, p);
    s->m->tri[g / 3][vg_half_next(g) % 3] = p;
  }
}

/* Cuts a triangle whose edges are all free into three. */
static void cut_alone(struct vg_inner_work *s, size_t t, uint8_t *is_done)
{
  const uint32_t p = add_middle(s->m, s->m->tri[t], 3);

  is_done[t] = 1;
  for (uint32_t k = 0; k < 2; k++) add_copy(s->m, t, k, p);
  s->m->tri[t][2] = p;
}

/* None of the triangles on the edge of half-edge h has been cut. */
static int is_whole(const struct vg_inner_work *s, uint32_t h,
                    const uint8_t *is_done)
{
  const struct vg_edges *e = &s->sides.edge;

  for (uint32_t k = 0; k < vg_edges_count(e, e->of_half[h]); k++)
    if (is_done[vg_edges_at(e, e->of_half[h])[k] / 3]) return 0;
  return 1;
}

/* Room for a cut of every triangle that needs one. */
static vg_status reserve(struct vg_inner_work *s, size_t n,
                         struct vg_error *err)
{
  struct vg_mesh *m = s->m;
  size_t most = 2, cap_point = m->n_point, cap_tri = m->n_tri, cap = cap_tri;

  for (size_t i = 0; i < s->sides.edge.n; i++)
    if (vg_edges_count(&s->sides.edge, i) > most)
      most = vg_edges_count(&s->sides.edge, i);
  if (vg_reserve(&m->point, &cap_point, m->n_point + n, sizeof *m->point) ||
      vg_reserve(&m->tri, &cap_tri, m->n_tri + n * most, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &cap, m->n_tri + n * most,
                 sizeof *m->tri_patch))
    return vg_fail_memory(err, "the sides of a sheet");
  return VG_OK;
}

vg_status vg_inner_cut(struct vg_inner_work *s, size_t *n_cut,
                       struct vg_error *err)
{
  const uint32_t n_tri = (uint32_t)s->m->n_tri;
  uint8_t *is_done = vg_calloc(n_tri, 1);
  size_t n = 0;
  vg_status st = is_done ? VG_OK : vg_fail_memory(err, "the sides of a sheet");

  *n_cut = 0;
  for (uint32_t t = 0; t < n_tri; t++) n += (size_t)is_same(s, t);
  if (st >= 0 && n) st = reserve(s, n, err);
  s->sides.x = NULL; /* may have moved */
  for (uint32_t t = 0; st >= 0 && n && t < n_tri; t++) {
    uint32_t h;

    if (is_done[t] || !is_same(s, t)) continue;
    s->sides.tri = (const uint32_t(*)[3])s->m->tri;
    h = edge_to_cut(s, t);
    if (h != UINT32_MAX && !is_whole(s, h, is_done)) continue; /* next pass */
    if (h == UINT32_MAX) cut_alone(s, t, is_done);
    else cut_edge(s, h, is_done);
    ++*n_cut;
  }
  free(is_done);
  return st;
}
