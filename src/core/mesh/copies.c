/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/copies.h"

#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/table.h"
#include "base/tri_key.h"
#include "base/union_find.h"

struct copies {
  const struct vg_mesh *m;
  uint32_t *first; /* [n_point] first point of triangles at this place */
  uint8_t *on;     /* [n_point] 1: of a triangle, 2: of one that lies back to
                      back on another */
  size_t n;        /* points that are not the first ones at their places */
};

static int is_side(const struct vg_patch *p, int32_t side, int32_t is_sheet)
{
  return p->inner == side && p->is_sheet == is_sheet;
}

size_t vg_mesh_front_patch(const struct vg_mesh *m, size_t i)
{
  size_t n = 0, front = 0;
  int32_t is_sheet;

  assert(i < m->n_patch);
  is_sheet = m->patch[i].is_sheet;
  if (m->patch[i].inner != VG_INNER_BACK) return i;
  for (size_t k = 0; k < i; k++)
    n += is_side(&m->patch[k], VG_INNER_BACK, is_sheet);
  while (front < m->n_patch &&
         (!is_side(&m->patch[front], VG_INNER_FRONT, is_sheet) || n--))
    front++;
  assert(front < m->n_patch || is_sheet == VG_SHEET_GONE);
  return front < m->n_patch ? front : i;
}

static int is_same_place(const double a[3], const double b[3])
{
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

vg_status vg_mesh_first_points(const struct vg_mesh *m, const uint8_t *on,
                               uint32_t *first, struct vg_error *err)
{
  struct vg_table table;

  if (vg_table_init(&table, m->n_point))
    return vg_fail_memory(err, "the table of points");
  for (uint32_t p = 0; p < m->n_point; p++) {
    uint32_t *at;

    first[p] = p;
    if (!on[p]) continue;
    VG_TABLE_FIND(&table, at, vg_hash_point(m->point[p]),
                  is_same_place(m->point[*at], m->point[p]));
    if (*at == VG_TABLE_FREE) *at = p;
    first[p] = *at;
  }
  vg_table_release(&table);
  return VG_OK;
}

vg_status vg_mesh_inner_points(const struct vg_mesh *m, uint32_t **first,
                               struct vg_error *err)
{
  uint8_t *on;
  vg_status st;

  *first = NULL;
  if (!vg_mesh_has_inner(m)) return VG_OK;
  on = vg_calloc(m->n_point, 1);
  *first = vg_alloc(m->n_point, sizeof **first);
  for (size_t t = 0; on && t < m->n_tri; t++)
    for (int k = 0; m->patch[m->tri_patch[t]].inner && k < 3; k++)
      on[m->tri[t][k]] = 1;
  st = on && *first ? vg_mesh_first_points(m, on, *first, err)
                    : vg_fail_memory(err, "the inner surfaces");
  free(on);
  if (st >= 0) return VG_OK;
  free(*first);
  *first = NULL;
  return st;
}

static struct vg_tri_key key_of(const struct vg_mesh *m, const uint32_t *first,
                                size_t t)
{
  const uint32_t *v = m->tri[t];

  return vg_tri_key((uint32_t[3]){ first[v[0]], first[v[1]], first[v[2]] });
}

vg_status vg_mesh_inner_pairs(const struct vg_mesh *m, const uint32_t *first,
                              uint32_t *other, struct vg_error *err)
{
  struct vg_table table;

  assert(first && (other || !m->n_tri));
  if (vg_table_init(&table, m->n_tri))
    return vg_fail_memory(err, "the inner surfaces");
  for (size_t t = 0; t < m->n_tri; t++) other[t] = UINT32_MAX;
  for (int32_t side = VG_INNER_FRONT; side <= VG_INNER_BACK; side++)
    for (uint32_t t = 0; t < m->n_tri; t++) {
      struct vg_tri_key key;
      uint32_t *at;

      if (m->patch[m->tri_patch[t]].inner != side) continue;
      key = key_of(m, first, t);
      VG_TABLE_FIND(&table, at, vg_tri_key_hash(key),
                    vg_tri_key_same(key_of(m, first, *at), key));
      if (side == VG_INNER_FRONT) *at = t;
      else if (*at != VG_TABLE_FREE) {
        other[t] = *at;
        other[*at] = t;
      }
    }
  vg_table_release(&table);
  return VG_OK;
}

/* Unites the corners of triangles t and u, the sides of a sheet. */
static void join_corners(const struct vg_mesh *m, const uint32_t *first,
                         size_t t, size_t u, uint32_t *same)
{
  for (int k = 0; k < 3; k++)
    for (int j = 0; j < 3; j++)
      if (first[m->tri[t][k]] == first[m->tri[u][j]])
        vg_union(same, m->tri[t][k], m->tri[u][j]);
}

static int is_split_front(const struct vg_patch *p)
{
  return p->is_split && p->inner == VG_INNER_FRONT;
}

vg_status vg_mesh_joined_points(const struct vg_mesh *m, uint32_t **same,
                                struct vg_error *err)
{
  uint32_t *first = NULL, *other = NULL;
  int has = 0;
  vg_status st;

  *same = NULL;
  for (size_t i = 0; i < m->n_patch; i++) has |= is_split_front(&m->patch[i]);
  if (!has) return VG_OK;
  VG_TRY(vg_mesh_inner_points(m, &first, err));
  other = vg_alloc(m->n_tri, sizeof *other);
  *same = vg_alloc(m->n_point, sizeof **same);
  if (!other || !*same) VG_TRY(vg_fail_memory(err, "the sheets"));
  VG_TRY(vg_mesh_inner_pairs(m, first, other, err));
  for (uint32_t p = 0; p < m->n_point; p++) (*same)[p] = p;
  for (size_t t = 0; t < m->n_tri; t++) {
    if (!is_split_front(&m->patch[m->tri_patch[t]])) continue;
    assert(other[t] != UINT32_MAX);
    join_corners(m, first, t, other[t], *same);
  }
  for (uint32_t p = 0; p < m->n_point; p++) (*same)[p] = vg_root_of(*same, p);
done:
  free(first);
  free(other);
  if (st < 0) {
    free(*same);
    *same = NULL;
  }
  return st;
}

/* Faces: triangles, then the four triangles of the corners of each
 * quadrilateral, which has the same ones from behind, reversed. */
static size_t face_count(const struct vg_mesh *m)
{
  return m->n_tri + 4 * m->n_quad;
}

static uint32_t corner_of(const struct vg_mesh *m, size_t f, int k)
{
  const size_t q = f - m->n_tri;

  return f < m->n_tri ? m->tri[f][k] : m->quad[q / 4][(q + (size_t)k) % 4];
}

/* The corners of face f by their first copies, ascending. Returns the parity of
 * the order. */
static uint32_t corners_of(const struct copies *c, size_t f, uint32_t v[3])
{
  for (int k = 0; k < 3; k++) v[k] = c->first[corner_of(c->m, f, k)];
  return vg_order3(v);
}

static int is_opposite(const struct copies *c, size_t t, size_t u)
{
  uint32_t v[3], w[3];

  return corners_of(c, t, v) != corners_of(c, u, w) && v[0] == w[0] &&
         v[1] == w[1] && v[2] == w[2];
}

static vg_status mark_sides(struct copies *c, struct vg_error *err)
{
  const size_t n = face_count(c->m);
  struct vg_table table;

  if (vg_table_init(&table, n))
    return vg_fail_memory(err, "the triangles of the boundary");
  for (uint32_t t = 0; t < n; t++) {
    uint32_t v[3], *at;

    corners_of(c, t, v);
    VG_TABLE_FIND(&table, at, vg_tri_key_hash(vg_tri_key(v)),
                  is_opposite(c, t, *at));
    if (*at == VG_TABLE_FREE) {
      *at = t;
      continue;
    }
    for (int k = 0; k < 3; k++)
      c->on[corner_of(c->m, t, k)] = c->on[corner_of(c->m, *at, k)] = 2;
  }
  vg_table_release(&table);
  return VG_OK;
}

vg_status vg_mesh_copies(const struct vg_mesh *m, uint64_t *n,
                         struct vg_error *err)
{
  struct copies c = { .m = m };
  uint64_t count = 0;
  vg_status st = VG_OK;

  assert(m && n);
  c.first = vg_alloc(m->n_point, sizeof *c.first);
  c.on = vg_calloc(m->n_point, 1);
  if (!c.first || !c.on) VG_TRY(vg_fail_memory(err, "the table of points"));
  for (size_t f = 0; f < face_count(m); f++)
    for (int k = 0; k < 3; k++) c.on[corner_of(m, f, k)] = 1;
  VG_TRY(vg_mesh_first_points(m, c.on, c.first, err));
  for (uint32_t p = 0; p < m->n_point; p++) c.n += c.first[p] != p;
  if (c.n) VG_TRY(mark_sides(&c, err));
  for (uint32_t p = 0; c.n && p < m->n_point; p++)
    count += c.on[p] == 2 && c.first[p] != p && c.on[c.first[p]] == 2;
  *n = count;
done:
  free(c.first);
  free(c.on);
  return st;
}
