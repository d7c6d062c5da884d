/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: where points of walls lie within rounding of a sheet, the common
 * curve passes them at distances that are no edges to mesh. Points joined by
 * such short edges become one; then triangles whose height is that small give
 * their corner to the opposite edge, in all surfaces that share it:
 *
 *        d                      d
 *       / \                    /|\
 *      /   \                  / | \
 *     a-----b       ->       a--v--b
 *      '-v-'
 */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/vector.h"
#include "core/junction/junction_parts.h"
#include "core/mesh/edges.h"

enum { WALL = 1, SHEET = 2, BOTH = 3 };
#define ROUNDS 20

/* Marks the points of walls and sheets. */
static void mark(const struct vg_mesh *m, size_t n_wall, uint8_t *on)
{
  memset(on, 0, m->n_point);
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    on[m->tri[i / 3][i % 3]] |= i / 3 < n_wall ? WALL : SHEET;
}

/* Joins the points of short edges at the common curves; the first of them
 * stays. Returns their number. */
static size_t join_short(struct vg_mesh *m, const uint8_t *on, double most,
                         uint32_t *up)
{
  size_t n = 0;

  for (size_t p = 0; p < m->n_point; p++) up[p] = (uint32_t)p;
  for (size_t i = 0; i < 3 * m->n_tri; i++) {
    const uint32_t a = m->tri[i / 3][i % 3], b = m->tri[i / 3][(i + 1) % 3];

    if (on[a] != BOTH && on[b] != BOTH) continue;
    if (vg_distance(m->point[a], m->point[b]) <= most) vg_union(up, a, b);
  }
  for (size_t i = 0; i < 3 * m->n_tri; i++) {
    uint32_t *v = &m->tri[i / 3][i % 3];
    const uint32_t root = vg_root_of(up, *v);

    n += root != *v;
    *v = root;
  }
  return n;
}

/* Is triangle t flat above its edge k, with the foot of the height inside? */
static int is_cap(const struct vg_mesh *m, size_t t, uint32_t k, double most)
{
  const uint32_t *v = m->tri[t];
  const double *a = m->point[v[k]], *b = m->point[v[(k + 1) % 3]];
  double u[3], w[3], n[3], along, uu;

  vg_sub(b, a, u);
  vg_sub(m->point[v[(k + 2) % 3]], a, w);
  uu = vg_dot(u, u);
  along = vg_dot(u, w);
  vg_cross(u, w, n);
  return along > 0 && along < uu && vg_dot(n, n) <= most * most * uu;
}

struct caps {
  struct vg_mesh *m;
  size_t cap[2];
  uint8_t *is_done; /* [triangles before the round] */
};

/* Triangle t with edge from corner k gets point v on that edge. */
static vg_status divide(struct caps *c, size_t t, uint32_t k, uint32_t v,
                        struct vg_error *err)
{
  struct vg_mesh *m = c->m;

  if (vg_reserve(&m->tri, &c->cap[0], m->n_tri + 1, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &c->cap[1], m->n_tri + 1, sizeof *m->tri_patch))
    return vg_fail_memory(err, "the inner surfaces");
  memcpy(m->tri[m->n_tri], m->tri[t], sizeof *m->tri);
  m->tri[m->n_tri][k] = v;
  m->tri_patch[m->n_tri++] = m->tri_patch[t];
  m->tri[t][(k + 1) % 3] = v;
  return VG_OK;
}

/* Gives the corner of flat triangle t to the others at its edge, unless one of
 * them was changed in this round. */
static vg_status flatten(struct caps *c, const struct vg_edges *e, size_t t,
                         uint32_t k, size_t *n, struct vg_error *err)
{
  const size_t i = e->of_half[3 * t + k];
  const uint32_t v = c->m->tri[t][(k + 2) % 3];
  vg_status st = VG_OK;

  for (uint32_t j = 0; j < vg_edges_count(e, i); j++)
    if (c->is_done[vg_edges_at(e, i)[j] / 3]) return VG_OK;
  for (uint32_t j = 0; j < vg_edges_count(e, i) && st >= 0; j++) {
    const uint32_t h = vg_edges_at(e, i)[j];

    c->is_done[h / 3] = 1;
    if (h / 3 == t) continue;
    st = divide(c, h / 3, h % 3, v, err);
  }
  for (int j = 0; j < 3; j++) c->m->tri[t][j] = v;
  ++*n;
  return st;
}

/* Puts the triangles of walls first again, in their order. */
static vg_status sort(struct vg_mesh *m, const uint8_t *is_sheet_patch,
                      size_t *n_wall, struct vg_error *err)
{
  uint32_t(*tri)[3] = vg_alloc(m->n_tri, sizeof *tri);
  uint32_t *patch = vg_alloc(m->n_tri, sizeof *patch);
  size_t n = 0;

  if (!tri || !patch) {
    free(tri);
    free(patch);
    return vg_fail_memory(err, "the inner surfaces");
  }
  for (int sheets = 0; sheets < 2; sheets++) {
    for (size_t t = 0; t < m->n_tri; t++) {
      if (is_sheet_patch[m->tri_patch[t]] != sheets) continue;
      memcpy(tri[n], m->tri[t], sizeof *tri);
      patch[n++] = m->tri_patch[t];
    }
    if (!sheets) *n_wall = n;
  }
  free(m->tri);
  free(m->tri_patch);
  m->tri = tri;
  m->tri_patch = patch;
  *n_wall = vg_junction_drop_flat(m, *n_wall);
  return VG_OK;
}

/* One round. n: flat triangles that were removed. */
static vg_status flatten_all(struct vg_mesh *m, size_t *n_wall,
                             const uint8_t *is_sheet, uint8_t *on, double most,
                             size_t *n, struct vg_error *err)
{
  const size_t n_tri = m->n_tri;
  struct caps c = { m, { n_tri, n_tri }, vg_calloc(n_tri, 1) };
  struct vg_edges e = VG_EDGES_INIT;
  vg_status st;

  *n = 0;
  if (!c.is_done) return vg_fail_memory(err, "the inner surfaces");
  mark(m, *n_wall, on);
  VG_TRY(vg_edges_build(&e, m->n_point, n_tri, (const uint32_t(*)[3])m->tri,
                        NULL, 0, err));
  for (size_t t = 0; t < n_tri; t++)
    for (uint32_t k = 0; k < 3 && !c.is_done[t]; k++)
      if (on[m->tri[t][(k + 2) % 3]] == BOTH && is_cap(m, t, k, most))
        VG_TRY(flatten(&c, &e, t, k, n, err));
  if (*n) st = sort(m, is_sheet, n_wall, err);
done:
  vg_edges_release(&e);
  free(c.is_done);
  return st;
}

vg_status vg_junction_mend(struct vg_mesh *m, size_t *n_wall, double most,
                           struct vg_error *err)
{
  uint8_t *on = vg_alloc(m->n_point, 1);
  uint8_t *is_sheet = vg_calloc(m->n_patch, 1);
  uint32_t *up = vg_alloc(m->n_point, sizeof *up);
  size_t n = 1;
  vg_status st = VG_OK;

  if (!on || !is_sheet || !up)
    VG_TRY(vg_fail_memory(err, "the inner surfaces"));
  for (size_t t = *n_wall; t < m->n_tri; t++) is_sheet[m->tri_patch[t]] = 1;
  mark(m, *n_wall, on);
  if (join_short(m, on, most, up)) *n_wall = vg_junction_drop_flat(m, *n_wall);
  for (int i = 0; i < ROUNDS && n; i++)
    VG_TRY(flatten_all(m, n_wall, is_sheet, on, most, &n, err));
done:
  free(on);
  free(is_sheet);
  free(up);
  return st;
}
