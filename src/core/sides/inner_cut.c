/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Edges of sheets that are cut in the middle. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/vector.h"
#include "core/sides/inner_parts.h"
#include "core/sides/sides_parts.h"

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

/* The first connected sectors of the wedge above half-edge h at the lower and
 * the higher point of its edge. */
static void ends_of(const struct vg_inner_work *s, uint32_t h, uint32_t end[2])
{
  const uint32_t e = vg_wedge_above(&s->sides, h);
  const int is_up = vg_half_from(s->sides.tri, h) < vg_half_to(s->sides.tri, h);

  end[!is_up] = s->room[s->sides.sector[e]];
  end[is_up] = s->room[s->sides.sector[vg_half_next(e)]];
}

/* Does a sheet end on another surface in this edge alone, between two free
 * edges, so that the sides of the sheet would have the same points there? */
static int is_tied(const struct vg_inner_work *s, size_t edge)
{
  const struct vg_edges *e = &s->sides.edge;
  const uint32_t n = vg_edges_count(e, edge), *half = vg_edges_at(e, edge);
  int n_sheet = 0, n_wall = 0;

  for (uint32_t k = 0; k < n; k++) {
    n_sheet += vg_is_sheet(s, half[k] / 3) && !vg_is_passed(s, half[k] / 3);
    n_wall += !vg_is_sheet(s, half[k] / 3);
  }
  if (!n_sheet || !n_wall) return 0;
  for (uint32_t k = 0; k < n; k++)
    for (uint32_t l = 0; l < k; l++) {
      uint32_t a[2], b[2];

      if (vg_is_passed(s, half[k] / 3) || vg_is_passed(s, half[l] / 3))
        continue;
      ends_of(s, half[k], a);
      ends_of(s, half[l], b);
      if (a[0] == b[0] && a[1] == b[1]) return 1;
    }
  return 0;
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

/* Cuts edge h, or triangle t if that is UINT32_MAX. If a triangle was cut
 * before, the next pass does it. */
static size_t cut(struct vg_inner_work *s, uint32_t t, uint32_t h,
                  uint8_t *is_done)
{
  if (h != UINT32_MAX && !is_whole(s, h, is_done)) return 0;
  if (h == UINT32_MAX) cut_alone(s, t, is_done);
  else cut_edge(s, h, is_done);
  return 1;
}

/* Marks the edges and triangles to be cut. Returns their number. */
static size_t mark(const struct vg_inner_work *s, uint8_t *edge, uint8_t *tri)
{
  size_t n = 0;

  for (size_t i = 0; i < s->sides.edge.n; i++)
    n += edge[i] = (uint8_t)is_tied(s, i);
  for (size_t t = 0; t < s->m->n_tri; t++) n += tri[t] = (uint8_t)is_same(s, t);
  return n;
}

vg_status vg_inner_cut(struct vg_inner_work *s, size_t *n_cut,
                       struct vg_error *err)
{
  const struct vg_edges *e = &s->sides.edge;
  const uint32_t n_tri = (uint32_t)s->m->n_tri;
  uint8_t *is_done = vg_calloc(n_tri, 1), *tri = vg_calloc(n_tri, 1);
  uint8_t *edge = vg_calloc(e->n, 1);
  size_t n;
  vg_status st = VG_OK;

  *n_cut = 0;
  if (!is_done || !tri || !edge)
    VG_TRY(vg_fail_memory(err, "the sides of a sheet"));
  n = mark(s, edge, tri);
  if (!n) goto done;
  VG_TRY(reserve(s, n, err));
  s->sides.x = NULL; /* may have moved */
  s->sides.tri = (const uint32_t(*)[3])s->m->tri;
  for (size_t i = 0; i < e->n; i++)
    if (edge[i]) *n_cut += cut(s, 0, *vg_edges_at(e, i), is_done);
  for (uint32_t t = 0; t < n_tri; t++)
    if (tri[t] && !is_done[t]) *n_cut += cut(s, t, edge_to_cut(s, t), is_done);
done:
  free(is_done);
  free(tri);
  free(edge);
  return st;
}
