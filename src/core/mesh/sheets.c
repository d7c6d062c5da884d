/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/sheets.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"

static int is_sheet(const struct vg_patch *p, int32_t side)
{
  return p->is_sheet && p->inner == side;
}

/* Takes the fronts of sheets, and leaves the triangles of the boundary. to:
 * [n_patch] new numbers of patches and sheets */
static void part(struct vg_mesh *m, const uint32_t *to)
{
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t p = m->tri_patch[t];

    if (!m->patch[p].is_sheet) {
      memmove(m->tri[n], m->tri[t], sizeof *m->tri);
      m->tri_patch[n++] = to[p];
    } else if (is_sheet(&m->patch[p], VG_INNER_FRONT)) {
      memcpy(m->sheet_tri[m->n_sheet_tri], m->tri[t], sizeof *m->tri);
      m->sheet_of[m->n_sheet_tri++] = to[p];
    }
  }
  m->n_tri = n;
  for (size_t q = 0; q < m->n_quad; q++)
    m->quad_patch[q] = to[m->quad_patch[q]];
}

/* Moves the sheets out of the list of patches. */
static void part_patches(struct vg_mesh *m, uint32_t *to)
{
  uint32_t n = 0;

  for (size_t p = 0; p < m->n_patch; p++) {
    if (is_sheet(&m->patch[p], VG_INNER_FRONT)) {
      to[p] = (uint32_t)m->n_sheet;
      m->sheet[m->n_sheet++] = m->patch[p];
    } else to[p] = n;
    if (!m->patch[p].is_sheet) n++;
  }
}

vg_status vg_mesh_part_sheets(struct vg_mesh *m, struct vg_error *err)
{
  uint32_t *to;
  size_t n = 0, n_patch = 0, n_kept = 0;

  assert(!m->n_sheet_tri && !m->sheet_tri && !m->sheet);
  if (!vg_mesh_has_sheets(m)) return VG_OK;
  for (size_t p = 0; p < m->n_patch; p++)
    n_patch += is_sheet(&m->patch[p], VG_INNER_FRONT);
  for (size_t t = 0; t < m->n_tri; t++)
    n += is_sheet(&m->patch[m->tri_patch[t]], VG_INNER_FRONT);
  to = vg_alloc(m->n_patch, sizeof *to);
  m->sheet_tri = vg_alloc(n, sizeof *m->sheet_tri);
  m->sheet_of = vg_alloc(n, sizeof *m->sheet_of);
  m->sheet = vg_alloc(n_patch, sizeof *m->sheet);
  if (!to || !m->sheet_tri || !m->sheet_of || !m->sheet) {
    free(to);
    vg_mesh_drop_sheets(m);
    return vg_fail_memory(err, "the sheets");
  }
  part_patches(m, to);
  part(m, to);
  for (size_t p = 0; p < m->n_patch; p++)
    if (!m->patch[p].is_sheet) m->patch[n_kept++] = m->patch[p];
  m->n_patch = n_kept;
  free(to);
  return VG_OK;
}

void vg_mesh_drop_sheets(struct vg_mesh *m)
{
  free(m->sheet_tri);
  free(m->sheet_of);
  free(m->sheet);
  m->sheet_tri = NULL;
  m->sheet_of = NULL;
  m->sheet = NULL;
  m->n_sheet_tri = m->n_sheet = 0;
}

/* Adds the sheets to the patches of the view. to: [n_sheet] patch of each */
static void view_patches(struct vg_mesh *view, const struct vg_mesh *m,
                         uint32_t *to)
{
  for (size_t i = 0; i < m->n_sheet; i++) {
    size_t at = vg_mesh_find_patch(m, m->sheet[i].id);

    if (at == SIZE_MAX) {
      at = view->n_patch++;
      view->patch[at] = m->sheet[i];
      view->patch[at].is_sheet = 1;
    }
    to[i] = (uint32_t)at;
  }
}

vg_status vg_mesh_sheet_view(const struct vg_mesh *m, struct vg_mesh *out,
                             struct vg_error *err)
{
  const size_t n_tri = m->n_tri + m->n_sheet_tri;
  struct vg_mesh v = *m;
  uint32_t *to;

  memset(out, 0, sizeof *out);
  if (!m->n_sheet) {
    *out = v;
    return VG_OK;
  }
  v.tri = vg_alloc(n_tri, sizeof *v.tri);
  v.tri_patch = vg_alloc(n_tri, sizeof *v.tri_patch);
  v.patch = vg_alloc(m->n_patch + m->n_sheet, sizeof *v.patch);
  to = vg_alloc(m->n_sheet, sizeof *to);
  if (!v.tri || !v.tri_patch || !v.patch || !to) {
    free(to);
    vg_mesh_sheet_view_release(&v, m);
    return vg_fail_memory(err, "the sheets");
  }
  if (m->n_tri) {
    memcpy(v.tri, m->tri, m->n_tri * sizeof *v.tri);
    memcpy(v.tri_patch, m->tri_patch, m->n_tri * sizeof *v.tri_patch);
  }
  if (m->n_patch) memcpy(v.patch, m->patch, m->n_patch * sizeof *v.patch);
  view_patches(&v, m, to);
  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    memcpy(v.tri[v.n_tri], m->sheet_tri[t], sizeof *v.tri);
    v.tri_patch[v.n_tri++] = to[m->sheet_of[t]];
  }
  free(to);
  v.n_sheet = v.n_sheet_tri = 0;
  *out = v;
  return VG_OK;
}

void vg_mesh_sheet_view_release(struct vg_mesh *view, const struct vg_mesh *m)
{
  if (view->tri != m->tri) free(view->tri);
  if (view->tri_patch != m->tri_patch) free(view->tri_patch);
  if (view->patch != m->patch) free(view->patch);
  memset(view, 0, sizeof *view);
}

static uint32_t *slot_of(const struct vg_sheet_table *t, const uint32_t v[3])
{
  const struct vg_tri_key key = vg_tri_key(v);
  uint32_t *at;

  VG_TABLE_FIND(&t->table, at, vg_tri_key_hash(key),
                vg_tri_key_same(vg_tri_key(t->m->sheet_tri[*at]), key));
  return at;
}

vg_status vg_sheet_table_new(struct vg_sheet_table *t, const struct vg_mesh *m,
                             struct vg_error *err)
{
  *t = (struct vg_sheet_table)VG_SHEET_TABLE_INIT;
  if (!m->n_sheet_tri) return VG_OK;
  t->m = m;
  for (size_t i = 0; i < 3 * m->n_sheet_tri; i++)
    if (m->sheet_tri[i / 3][i % 3] >= t->n_on)
      t->n_on = (size_t)m->sheet_tri[i / 3][i % 3] + 1;
  t->on = vg_calloc(t->n_on, 1);
  if (!t->on || vg_table_init(&t->table, m->n_sheet_tri)) {
    vg_sheet_table_release(t);
    return vg_fail_memory(err, "the sheets");
  }
  for (uint32_t i = 0; i < m->n_sheet_tri; i++) {
    uint32_t *at = slot_of(t, m->sheet_tri[i]);

    if (*at == VG_TABLE_FREE) *at = i;
    for (int k = 0; k < 3; k++) t->on[m->sheet_tri[i][k]] = 1;
  }
  return VG_OK;
}

void vg_sheet_table_release(struct vg_sheet_table *t)
{
  vg_table_release(&t->table);
  free(t->on);
  *t = (struct vg_sheet_table)VG_SHEET_TABLE_INIT;
}

uint32_t vg_sheet_table_find(const struct vg_sheet_table *t,
                             const uint32_t v[3], int *is_same)
{
  uint32_t a[3], b[3], i;

  for (int k = 0; k < 3; k++)
    if (!vg_sheet_table_on(t, v[k])) return UINT32_MAX;
  i = *slot_of(t, v);
  if (i == VG_TABLE_FREE) return UINT32_MAX;
  memcpy(a, v, sizeof a);
  memcpy(b, t->m->sheet_tri[i], sizeof b);
  *is_same = vg_order3(a) == vg_order3(b);
  return i;
}

double vg_mesh_sheet_area(const struct vg_mesh *m, size_t i)
{
  double sum = 0;

  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    const double *a = m->point[m->sheet_tri[t][0]], *b, *c;
    double u[3], v[3], n = 0;

    if (m->sheet_of[t] != i) continue;
    b = m->point[m->sheet_tri[t][1]];
    c = m->point[m->sheet_tri[t][2]];
    for (int d = 0; d < 3; d++) {
      u[d] = b[d] - a[d];
      v[d] = c[d] - a[d];
    }
    for (int d = 0; d < 3; d++) {
      const double x = u[(d + 1) % 3] * v[(d + 2) % 3] -
                       u[(d + 2) % 3] * v[(d + 1) % 3];

      n += x * x;
    }
    sum += sqrt(n) / 2;
  }
  return sum;
}
