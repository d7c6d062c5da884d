/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/zones.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/sheets.h"

const char *const vg_zone_kind_word[VG_ZONE_KINDS + 1] = { "fluid", "rotating",
                                                           "porous", "solid",
                                                           NULL };

size_t vg_mesh_zone_of(const struct vg_mesh *m, int kind, uint64_t cell)
{
  size_t z = 0;

  assert(kind >= 0 && kind < VG_ZONE_KINDS);
  while (z + 1 < m->n_zone && cell >= m->zone[z].n_cell[kind])
    cell -= m->zone[z++].n_cell[kind];
  return z;
}

uint64_t vg_mesh_zone_start(const struct vg_mesh *m, size_t z, int kind)
{
  uint64_t n = 0;

  assert(z <= m->n_zone);
  while (z--) n += m->zone[z].n_cell[kind];
  return n;
}

vg_status vg_mesh_zone_numbers(const struct vg_mesh *m, int32_t **id,
                               struct vg_error *err)
{
  int32_t *to;

  *id = NULL;
  if (!m->n_zone) return VG_OK;
  *id = to = vg_alloc(vg_mesh_n_cell(m), sizeof *to);
  if (!to) return vg_fail_memory(err, "the zones");
  for (int k = 0; k < VG_ZONE_KINDS; k++)
    for (size_t z = 0; z < m->n_zone; z++)
      for (uint64_t n = m->zone[z].n_cell[k]; n; n--) *to++ = m->zone[z].id;
  return VG_OK;
}

uint64_t vg_mesh_zone_cells(const struct vg_mesh *m, size_t z)
{
  const uint64_t *n = m->zone[z].n_cell;

  return n[0] + n[1] + n[2] + n[3];
}

void vg_mesh_drop_zones(struct vg_mesh *m)
{
  free(m->zone);
  m->zone = NULL;
  m->n_zone = 0;
}

/* Sorts cells of one kind. at: [n_zone] first cell of each zone, changed */
static void sort_kind(const uint32_t *of, size_t n, int width, uint64_t *at,
                      const uint32_t *from, uint32_t *to)
{
  const size_t w = (size_t)width;

  for (size_t c = 0; c < n; c++)
    memcpy(to + w * at[of[c]]++, from + w * c, w * sizeof *to);
}

vg_status vg_mesh_sort_zones(struct vg_mesh *m, const uint32_t *of,
                             struct vg_error *err)
{
  static const int width[VG_ZONE_KINDS] = { 4, 5, 6, 8 };
  const size_t n[VG_ZONE_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  uint64_t *at = vg_alloc(m->n_zone, sizeof *at);
  uint32_t *to = NULL;
  size_t most = 0;

  for (int k = 0; k < VG_ZONE_KINDS; k++)
    if (n[k] * (size_t)width[k] > most) most = n[k] * (size_t)width[k];
  to = vg_alloc(most, sizeof *to);
  if (!at || !to) {
    free(at);
    free(to);
    return vg_fail_memory(err, "the zones");
  }
  for (int k = 0; k < VG_ZONE_KINDS; of += n[k++]) {
    for (size_t c = 1; c < n[k]; c++) m->is_resorted |= of[c] < of[c - 1];
    for (size_t z = 0; z < m->n_zone; z++) m->zone[z].n_cell[k] = 0;
    for (size_t c = 0; c < n[k]; c++) m->zone[of[c]].n_cell[k]++;
    for (size_t z = 0; z < m->n_zone; z++) at[z] = vg_mesh_zone_start(m, z, k);
    sort_kind(of, n[k], width[k], at, vg_mesh_nodes(m, k), to);
    if (n[k])
      memcpy(vg_mesh_nodes(m, k), to, n[k] * (size_t)width[k] * sizeof *to);
  }
  free(at);
  free(to);
  return VG_OK;
}

/* --- from tags ------------------------------------------------------------ */

static int by_value(const void *a, const void *b)
{
  const int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;

  return p < q ? -1 : p > q;
}

/* The distinct tags, ascending. */
static vg_status list_tags(const int32_t *tag, size_t n, int32_t **out,
                           size_t *n_tag, struct vg_error *err)
{
  int32_t *list = NULL;
  size_t cap = 0, count = 0;

  *n_tag = 0;
  for (size_t c = 0; c < n; c++) {
    if (c && tag[c] == tag[c - 1]) continue;
    if (vg_reserve(&list, &cap, count + 1, sizeof *list)) {
      free(list);
      return vg_fail_memory(err, "the zones");
    }
    list[count++] = tag[c];
  }
  if (count) qsort(list, count, sizeof *list, by_value);
  for (size_t k = 0; k < count; k++)
    if (!k || list[k] != list[*n_tag - 1]) list[(*n_tag)++] = list[k];
  *out = list;
  return VG_OK;
}

/* Numbers of zones: their tags, or the lowest free ones. */
static void number_zones(struct vg_zone *zone, const int32_t *list, size_t n)
{
  int32_t next = 1;

  for (size_t z = 0; z < n; z++) {
    zone[z] = (struct vg_zone){ .id = list[z] };
    if (list[z] > 0) continue;
    while (bsearch(&next, list, n, sizeof *list, by_value)) next++;
    zone[z].id = next++;
  }
}

vg_status vg_mesh_zones_from_tags(struct vg_mesh *m, const int32_t *tag,
                                  int one, struct vg_error *err)
{
  const size_t n = vg_mesh_n_cell(m);
  int32_t *list = NULL;
  uint32_t *of = NULL;
  size_t n_tag = 0;
  vg_status st;

  assert(!m->n_zone && !m->zone);
  VG_TRY(list_tags(tag, n, &list, &n_tag, err));
  if (n_tag < (one ? 1 : 2)) goto done;
  m->zone = vg_alloc(n_tag, sizeof *m->zone);
  of = vg_alloc(n, sizeof *of);
  if (!m->zone || !of) VG_TRY(vg_fail_memory(err, "the zones"));
  number_zones(m->zone, list, n_tag);
  m->n_zone = n_tag;
  for (size_t c = 0; c < n; c++) {
    const int32_t *at = bsearch(&tag[c], list, n_tag, sizeof *list, by_value);

    of[c] = (uint32_t)(at - list);
  }
  st = vg_mesh_sort_zones(m, of, err);
done:
  if (st < 0) vg_mesh_drop_zones(m);
  free(list);
  free(of);
  return st;
}

/* --- interfaces -------------------------------------------------------------
 */

/* The triangles of sheets that are faces of a cell in zone z, or stand for its
 * quadrilaterals. */
static void meet(const struct vg_sheet_table *t, int kind, const uint32_t *node,
                 uint32_t z, uint32_t (*zone)[2])
{
  int n = 0;

  for (int k = 0; k < vg_cell_faces[kind].width; k++)
    n += vg_sheet_table_on(t, node[k]);
  for (int f = 0; n > 2 && f < vg_cell_faces[kind].n_face; f++) {
    const unsigned char *face = vg_cell_faces[kind].face[f];
    const uint32_t quad[4] = { node[face[0]], node[face[1]], node[face[2]],
                               node[face[3]] };
    uint32_t v[3] = { quad[0], quad[1], quad[2] }, at;
    int is_same;

    if (face[2] != face[3]) vg_quad_low_corners(quad, v);
    at = vg_sheet_table_find(t, v, &is_same);
    if (at != UINT32_MAX) zone[at][!is_same] = z;
  }
}

vg_status vg_mesh_zone_sides(const struct vg_mesh *m, uint32_t (*zone)[2],
                             struct vg_error *err)
{
  const size_t n[VG_ZONE_KINDS] = { m->n_tet, m->n_pyr, m->n_pri, m->n_hex };
  struct vg_sheet_table t;
  vg_status st;

  if (!m->n_sheet_tri) return VG_OK;
  VG_TRY(vg_sheet_table_new(&t, m, err));
  memset(zone, 0xff, m->n_sheet_tri * sizeof *zone);
  for (int k = 0; k < VG_ZONE_KINDS; k++) {
    const uint32_t *node = vg_mesh_nodes(m, k);
    const size_t width = (size_t)vg_cell_faces[k].width;
    uint32_t z = 0;
    uint64_t end = m->n_zone ? m->zone[0].n_cell[k] : n[k];

    for (size_t c = 0; c < n[k]; c++) {
      while (c >= end) end += m->zone[++z].n_cell[k];
      meet(&t, k, node + c * width, z, zone);
    }
  }
  vg_sheet_table_release(&t);
done:
  return st;
}

vg_status vg_mesh_mark_interfaces(struct vg_mesh *m, struct vg_error *err)
{
  uint32_t(*zone)[2] = NULL;
  uint8_t *is = NULL;
  vg_status st = VG_OK;

  if (!m->n_zone || !m->n_sheet_tri) return VG_OK;
  zone = vg_alloc(m->n_sheet_tri, sizeof *zone);
  is = vg_alloc(m->n_sheet, 1);
  if (!zone || !is) VG_TRY(vg_fail_memory(err, "the zones"));
  memset(is, 1, m->n_sheet);
  VG_TRY(vg_mesh_zone_sides(m, zone, err));
  for (size_t t = 0; t < m->n_sheet_tri; t++)
    is[m->sheet_of[t]] &= zone[t][0] != zone[t][1] && zone[t][0] < m->n_zone &&
                          zone[t][1] < m->n_zone;
  for (size_t i = 0; i < m->n_sheet; i++) m->sheet[i].is_interface |= is[i];
done:
  free(zone);
  free(is);
  return st;
}

size_t vg_mesh_interface_triangles(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t t = 0; t < m->n_sheet_tri; t++)
    n += m->sheet[m->sheet_of[t]].is_interface != 0;
  return n;
}

void vg_zone_name(const struct vg_zone *z, char name[VG_NAME_MAX])
{
  if (*z->name) memcpy(name, z->name, VG_NAME_MAX);
  else snprintf(name, VG_NAME_MAX, "zone_%d", (int)z->id);
}
