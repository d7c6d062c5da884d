/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: an edge is on a junction if its triangles do not belong to one piece
 * that continues through it. Edges of the same pieces form curves between
 * nodes. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "base/tri_key.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/junction/junction_parts.h"
#include "core/mesh/edges.h"
#include "core/remesh/remesh.h"

struct finder {
  struct vg_junctions *j;
  const uint32_t (*tri)[3];
  struct vg_edges e;
  uint32_t *up;     /* [n_tri] union-find */
  uint32_t *on;     /* [n_edge] edges of e on junctions, in order */
  uint64_t *pieces; /* [n_edge] hash of the pieces of each */
  uint32_t *degree, *start, *at_point; /* Edges (of on) at each point. */
  uint8_t *is_node;                    /* [n_point] */
  uint8_t *seen;                       /* [n_edge] */
};

/* The two triangles of edge i that belong to one patch of inner surfaces and
 * continue each other there. */
static int continues(const struct finder *f, const uint32_t *half, uint32_t n,
                     uint32_t k, uint32_t *other)
{
  const uint32_t *patch = f->j->m->tri_patch;
  uint32_t count = 0;

  if (half[k] / 3 < f->j->n_wall) return 0;
  for (uint32_t i = 0; i < n; i++) {
    if (i == k || half[i] / 3 < f->j->n_wall ||
        patch[half[i] / 3] != patch[half[k] / 3])
      continue;
    *other = half[i];
    count++;
  }
  return count == 1;
}

static void number_pieces(struct finder *f)
{
  struct vg_junctions *j = f->j;
  const size_t n = j->m->n_tri;

  for (size_t t = 0; t < n; t++) f->up[t] = t < j->n_wall ? 0 : (uint32_t)t;
  for (size_t i = 0; i < f->e.n; i++) {
    const uint32_t *half = vg_edges_at(&f->e, i);
    const uint32_t count = vg_edges_count(&f->e, i);
    uint32_t other;

    for (uint32_t k = 0; k < count; k++)
      if (continues(f, half, count, k, &other))
        vg_union(f->up, half[k] / 3, other / 3);
  }
  j->n_piece = 1;
  for (size_t t = 0; t < n; t++) {
    const uint32_t root = vg_root_of(f->up, (uint32_t)t);

    if (t < j->n_wall) j->piece[t] = 0;
    else j->piece[t] = root == t ? (uint32_t)j->n_piece++ : j->piece[root];
  }
}

static int is_junction(const struct finder *f, size_t i)
{
  const uint32_t *half = vg_edges_at(&f->e, i);
  const uint32_t n = vg_edges_count(&f->e, i);
  int has_sheet = 0;

  for (uint32_t k = 0; k < n; k++) has_sheet |= half[k] / 3 >= f->j->n_wall;
  if (!has_sheet || n < 2) return 0;
  return n > 2 || f->j->piece[half[0] / 3] != f->j->piece[half[1] / 3] ||
         vg_edges_disagree(&f->e, f->tri, i);
}

static void ends_of(const struct finder *f, uint32_t i, uint32_t v[2])
{
  const uint32_t h = vg_edges_at(&f->e, f->on[i])[0];

  v[0] = vg_half_from(f->tri, h);
  v[1] = vg_half_to(f->tri, h);
}

static vg_status list_edges(struct finder *f, struct vg_error *err)
{
  struct vg_junctions *j = f->j;
  const size_t n_point = j->m->n_point;
  uint32_t v[2];

  for (size_t i = 0; i < f->e.n; i++) j->n_edge += (size_t)is_junction(f, i);
  f->on = vg_alloc(j->n_edge, sizeof *f->on);
  f->pieces = vg_calloc(j->n_edge, sizeof *f->pieces);
  f->seen = vg_calloc(j->n_edge, 1);
  f->start = vg_calloc(n_point + 2, sizeof *f->start);
  f->at_point = vg_alloc(2 * j->n_edge, sizeof *f->at_point);
  f->is_node = vg_calloc(n_point, 1);
  if (!f->on || !f->pieces || !f->seen || !f->start || !f->at_point ||
      !f->is_node)
    return vg_fail_memory(err, "the junctions of inner surfaces");
  j->n_edge = 0;
  for (size_t i = 0; i < f->e.n; i++) {
    if (!is_junction(f, i)) continue;
    f->on[j->n_edge] = (uint32_t)i;
    for (uint32_t k = 0; k < vg_edges_count(&f->e, i); k++)
      f->pieces[j->n_edge] += vg_hash_mix(
        j->piece[vg_edges_at(&f->e, i)[k] / 3] + 1);
    j->n_edge++;
  }
  for (int pass = 0; pass < 2; pass++) {
    for (uint32_t i = 0; i < j->n_edge; i++) {
      ends_of(f, i, v);
      for (int k = 0; k < 2; k++)
        if (!pass) f->start[v[k] + 2]++;
        else f->at_point[f->start[v[k] + 1]++] = i;
    }
    for (size_t p = 1; !pass && p < n_point + 2; p++)
      f->start[p] += f->start[p - 1];
  }
  return VG_OK;
}

/* Nodes: all points but those at which two edges of the same pieces meet. */
static void find_nodes(struct finder *f)
{
  for (size_t p = 0; p < f->j->m->n_point; p++) {
    const uint32_t *at = f->at_point + f->start[p];
    const uint32_t n = f->start[p + 1] - f->start[p];

    f->is_node[p] = n && (n != 2 || f->pieces[at[0]] != f->pieces[at[1]]);
  }
}

static vg_status add_point(struct finder *f, uint32_t p, struct vg_error *err)
{
  struct vg_junctions *j = f->j;
  struct vg_junction *c = &j->curve[j->n - 1];
  double s = 0;

  if (vg_reserve(&j->point, &j->cap_point, j->n_point + 1, sizeof *j->point) ||
      vg_reserve(&j->at, &j->cap_at, j->n_point + 1, sizeof *j->at))
    return vg_fail_memory(err, "the junctions of inner surfaces");
  if (c->n)
    s = j->at[j->n_point - 1] +
        vg_distance(j->m->point[j->point[j->n_point - 1]], j->m->point[p]);
  j->point[j->n_point] = p;
  j->at[j->n_point++] = s;
  c->n++;
  return VG_OK;
}

/* Follow the curve that leaves p along edge i. */
static vg_status follow(struct finder *f, uint32_t p, uint32_t i,
                        struct vg_error *err)
{
  struct vg_junctions *j = f->j;
  vg_status st;

  if (vg_reserve(&j->curve, &j->cap, j->n + 1, sizeof *j->curve))
    return vg_fail_memory(err, "the junctions of inner surfaces");
  j->curve[j->n++] = (struct vg_junction){ .first = j->n_point };
  VG_TRY(add_point(f, p, err));
  for (;;) {
    const uint32_t *at;
    uint32_t v[2];

    ends_of(f, i, v);
    f->seen[i] = 1;
    j->of_edge[i] = (uint32_t)j->n - 1;
    p = v[0] == p ? v[1] : v[0];
    VG_TRY(add_point(f, p, err));
    at = f->at_point + f->start[p];
    if (f->is_node[p]) break;
    i = at[at[0] == i];
  }
done:
  return st;
}

/* Closed curves without a node begin at their lowest point. */
static vg_status find_curves(struct finder *f, struct vg_error *err)
{
  const size_t n = f->j->m->n_point;
  vg_status st = VG_OK;

  for (int closed = 0; closed < 2; closed++)
    for (uint32_t p = 0; p < n; p++) {
      const uint32_t end = f->start[p + 1];

      if (!closed && !f->is_node[p]) continue;
      for (uint32_t k = f->start[p]; k < end; k++) {
        if (f->seen[f->at_point[k]]) continue;
        f->is_node[p] = 1;
        VG_TRY(follow(f, p, f->at_point[k], err));
      }
    }
done:
  return st;
}

static void take_keys(struct finder *f)
{
  uint32_t v[2];

  for (uint32_t i = 0; i < f->j->n_edge; i++) {
    ends_of(f, i, v);
    f->j->edge[i] = vg_edge_key(v[0], v[1]);
    assert(!i || f->j->edge[i - 1] < f->j->edge[i]);
  }
}

vg_status vg_junctions_find(const struct vg_mesh *m, size_t n_wall,
                            struct vg_junctions *j, struct vg_error *err)
{
  struct finder f = { .j = j, .tri = (const uint32_t(*)[3])m->tri };
  vg_status st;

  assert(!j->piece && n_wall <= m->n_tri);
  j->m = m;
  j->n_wall = n_wall;
  j->piece = vg_alloc(m->n_tri, sizeof *j->piece);
  f.up = vg_alloc(m->n_tri, sizeof *f.up);
  if (!j->piece || !f.up)
    VG_TRY(vg_fail_memory(err, "the junctions of inner surfaces"));
  VG_TRY(vg_edges_build(&f.e, m->n_point, m->n_tri, f.tri, NULL, 0, err));
  number_pieces(&f);
  VG_TRY(list_edges(&f, err));
  j->edge = vg_alloc(j->n_edge, sizeof *j->edge);
  j->of_edge = vg_alloc(j->n_edge, sizeof *j->of_edge);
  if (!j->edge || !j->of_edge)
    VG_TRY(vg_fail_memory(err, "the junctions of inner surfaces"));
  take_keys(&f);
  find_nodes(&f);
  VG_TRY(find_curves(&f, err));
done:
  vg_edges_release(&f.e);
  free(f.up);
  free(f.on);
  free(f.pieces);
  free(f.start);
  free(f.at_point);
  free(f.is_node);
  free(f.seen);
  if (st < 0) vg_junctions_release(j);
  return st;
}

void vg_junctions_release(struct vg_junctions *j)
{
  free(j->piece);
  free(j->curve);
  free(j->point);
  free(j->at);
  free(j->edge);
  free(j->of_edge);
  free(j->made);
  free(j->made_at);
  free(j->made_x);
  *j = (struct vg_junctions)VG_JUNCTIONS_INIT;
}

size_t vg_junction_edge(const struct vg_junctions *j, uint32_t a, uint32_t b)
{
  const uint64_t key = vg_edge_key(a, b);
  const uint64_t *at = j->n_edge ? bsearch(&key, j->edge, j->n_edge, sizeof key,
                                           vg_compare_edge_keys)
                                 : NULL;

  return at ? (size_t)(at - j->edge) : SIZE_MAX;
}

void vg_junctions_of(const struct vg_junctions *j, uint32_t piece, uint8_t *on)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])j->m->tri;

  for (uint32_t h = 0; h < 3 * j->m->n_tri; h++) {
    size_t i;

    if (j->piece[h / 3] != piece) continue;
    i = vg_junction_edge(j, vg_half_from(tri, h), vg_half_to(tri, h));
    if (i != SIZE_MAX) on[j->of_edge[i]] = 1;
  }
}

void vg_junctions_mark(const struct vg_junctions *j,
                       const struct vg_mesh *walls, double *stretch,
                       uint8_t *still)
{
  const uint32_t(*tri)[3] = (const uint32_t(*)[3])j->m->tri;

  assert(walls->n_tri == j->n_wall);
  for (uint32_t h = 0; h < 3 * j->n_wall; h++) {
    const size_t i = vg_junction_edge(j, vg_half_from(tri, h),
                                      vg_half_to(tri, h));
    const struct vg_junction *c;

    if (i == SIZE_MAX) continue;
    c = &j->curve[j->of_edge[i]];
    if (!(stretch[h] > 1)) stretch[h] = VG_REMESH_FEATURE;
    for (uint32_t k = 0; k < 2; k++) {
      const uint32_t g = k ? vg_half_next(h) : h;
      const uint32_t p = vg_half_from(tri, g);

      if (p == j->point[c->first] || p == j->point[c->first + c->n - 1])
        still[walls->tri[g / 3][g % 3]] = VG_REMESH_STILL;
    }
  }
}
