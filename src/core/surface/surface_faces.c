/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The boundary faces as triangles on points with distinct coordinates. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/table.h"
#include "base/tri_key.h"
#include "core/geometry/predicates.h"

/* Is the area exactly zero: is the triangle a line in all three projections? */
static int is_flat(const double *a, const double *b, const double *c)
{
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double p[2] = { a[i], a[j] }, q[2] = { b[i], b[j] }, r[2] = { c[i], c[j] };

    if (vg_orient2d(p, q, r) != 0) return 0;
  }
  return 1;
}

static uint8_t state_of(const double (*p)[3], const uint32_t n[3])
{
  if (n[0] == n[1] || n[1] == n[2] || n[2] == n[0]) return VG_FACE_COLLAPSED;
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < 3; i++)
      if (!isfinite(p[n[k]][i])) return VG_FACE_NOT_FINITE;
  return is_flat(p[n[0]], p[n[1]], p[n[2]]) ? VG_FACE_FLAT : 0;
}

/* Triangles come first, then triangles 0 1 2 and 0 2 3 of each
 * quadrilateral. */
static void corners(const struct vg_mesh *m, size_t f, uint32_t node[3])
{
  if (f < m->n_tri) {
    memcpy(node, m->tri[f], sizeof m->tri[f]);
  } else {
    const uint32_t *q = m->quad[(f - m->n_tri) / 2];
    size_t odd = (f - m->n_tri) & 1;

    node[0] = q[0];
    node[1] = q[1 + odd];
    node[2] = q[2 + odd];
  }
}

vg_status vg_faces_build(struct vg_faces *s, const struct vg_mesh *m,
                         const uint32_t *same, struct vg_error *err)
{
  size_t n;

  assert(!s->node && !s->state && same);
  if (m->n_tri > UINT32_MAX / 3 || m->n_quad > UINT32_MAX / 3 ||
      m->n_tri + 2 * m->n_quad > UINT32_MAX / 3 - 1)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "%zu triangles and %zu "
                   "quadrilaterals: the limit is %u triangles",
                   m->n_tri, m->n_quad, (unsigned)(UINT32_MAX / 3 - 1));
  n = m->n_tri + 2 * m->n_quad;
  s->node = vg_alloc(n, sizeof *s->node);
  s->state = vg_alloc(n, sizeof *s->state);
  if (!s->node || !s->state) {
    vg_faces_release(s);
    return vg_fail_memory(err, "the faces of the surface");
  }
  s->n = n;
  s->n_tri = m->n_tri;
  s->n_point = m->n_point;
  s->point = (const double(*)[3])m->point;
  for (size_t f = 0; f < n; f++) {
    uint32_t node[3];

    corners(m, f, node);
    for (int k = 0; k < 3; k++) s->node[f][k] = same[node[k]];
    s->state[f] = state_of(s->point, s->node[f]);
  }
  return VG_OK;
}

void vg_faces_release(struct vg_faces *s)
{
  free(s->node);
  free(s->state);
  memset(s, 0, sizeof *s);
}

int vg_faces_same_side(const uint32_t a[3], const uint32_t b[3])
{
  int k = 0;

  while (k < 2 && b[k] != a[0]) k++;
  return b[(k + 1) % 3] == a[1];
}

vg_status vg_faces_duplicate(const struct vg_faces *s, uint32_t **first,
                             struct vg_error *err)
{
  struct vg_table t;
  int bad = vg_table_init(&t, s->n);
  uint32_t *at, *out = vg_alloc(s->n, sizeof *out);

  assert(first);
  if (bad || !out) {
    vg_table_release(&t);
    free(out);
    return vg_fail_memory(err, "a table of triangles");
  }
  for (size_t f = 0; f < s->n; f++) {
    struct vg_tri_key key = vg_tri_key(s->node[f]);

    VG_TABLE_FIND(&t, at, vg_tri_key_hash(key),
                  vg_tri_key_same(vg_tri_key(s->node[*at]), key));
    if (*at == VG_TABLE_FREE) *at = (uint32_t)f;
    out[f] = *at;
  }
  vg_table_release(&t);
  *first = out;
  return VG_OK;
}
