/* Checks of the boundary faces of a mesh. */
#include "core/mesh/mesh_defects.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"

static size_t bad_face(const struct vg_mesh *m, const uint32_t *node, int n,
                       uint32_t patch)
{
  size_t bad = patch >= m->n_patch;

  for (int k = 0; k < n; k++) bad += node[k] >= m->n_point;
  return bad;
}

size_t vg_mesh_bad_faces(const struct vg_mesh *m)
{
  size_t bad = 0;

  assert(m);
  for (size_t i = 0; i < m->n_tri; i++)
    bad += bad_face(m, m->tri[i], 3, m->tri_patch[i]);
  for (size_t i = 0; i < m->n_quad; i++)
    bad += bad_face(m, m->quad[i], 4, m->quad_patch[i]);
  return bad;
}

/* An edge from its lower to its higher node, and whether a face uses it in
 * that direction. */
struct edge { uint32_t lo, hi; int up; };

static int order(const void *a, const void *b)
{
  const struct edge *p = a, *q = b;

  if (p->lo != q->lo) return p->lo < q->lo ? -1 : 1;
  return (p->hi > q->hi) - (p->hi < q->hi);
}

static size_t add_edges(const uint32_t *node, int n, struct edge *out)
{
  size_t n_edge = 0;

  for (int k = 0; k < n; k++) {
    const uint32_t a = node[k], b = node[(k + 1) % n];

    if (a == b) continue;    /* a face without area: an error elsewhere */
    out[n_edge++] = a < b ? (struct edge){ a, b, 1 } : (struct edge){ b, a, 0 };
  }
  return n_edge;
}

size_t vg_mesh_open_edges(const struct vg_mesh *m)
{
  struct edge *edge = vg_alloc(3 * m->n_tri + 4 * m->n_quad, sizeof *edge);
  size_t n = 0, bad = 0;

  if (!edge) return SIZE_MAX;
  for (size_t i = 0; i < m->n_tri; i++)
    n += add_edges(m->tri[i], 3, edge + n);
  for (size_t i = 0; i < m->n_quad; i++)
    n += add_edges(m->quad[i], 4, edge + n);
  qsort(edge, n, sizeof *edge, order);
  for (size_t i = 0, j; i < n; i = j) {
    long balance = 0;

    for (j = i; j < n && !order(&edge[i], &edge[j]); j++)
      balance += edge[j].up ? 1 : -1;
    bad += balance != 0;
  }
  free(edge);
  return bad;
}
