/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/zone_meshes.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/tri_key.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/sheets.h"

/* --- zones of faces ------------------------------------------------------- */

/* Zones of the boundary faces, which point into their cells: as triangles of
 * sheets, of which those are known. Of two triangles with the same points, the
 * sides of a baffle, the first one is known. */
static vg_status find_face_zones(struct vg_zone_parts *p, struct vg_error *err)
{
  const struct vg_mesh *m = p->m;
  const size_t n = m->n_tri + m->n_quad;
  struct vg_mesh view = *m;
  struct vg_sheet_table t = VG_SHEET_TABLE_INIT;
  uint32_t(*side)[2] = vg_alloc(n, sizeof *side);
  vg_status st = VG_OK;

  view.n_sheet_tri = n;
  view.sheet_tri = vg_alloc(n, sizeof *view.sheet_tri);
  if (!side || !view.sheet_tri) VG_TRY(vg_fail_memory(err, "the zones"));
  for (size_t f = 0; f < n; f++)
    if (f < m->n_tri) memcpy(view.sheet_tri[f], m->tri[f], sizeof *m->tri);
    else vg_quad_low_corners(m->quad[f - m->n_tri], view.sheet_tri[f]);
  VG_TRY(vg_mesh_zone_sides(&view, side, err));
  VG_TRY(vg_sheet_table_new(&t, &view, err));
  for (size_t f = 0; f < n && st >= 0; f++) {
    int is_same = 1;
    const uint32_t at = vg_sheet_table_find(&t, view.sheet_tri[f], &is_same);
    const double *x = m->point[view.sheet_tri[f][0]];

    p->face_zone[f] = side[at][!is_same];
    if (p->face_zone[f] >= m->n_zone)
      st = vg_fail(err, VG_ERR_INPUT,
                   "the boundary face %zu at (%g, %g, %g) belongs to no cell; "
                   "vanguard check lists such faces",
                   f + 1, x[0], x[1], x[2]);
  }
done:
  vg_sheet_table_release(&t);
  free(view.sheet_tri);
  free(side);
  return st;
}

/* --- pairs ---------------------------------------------------------------- */

static int by_pair(const void *a, const void *b)
{
  const struct vg_zone_pair *p = a, *q = b;

  if (p->sheet != q->sheet) return p->sheet < q->sheet ? -1 : 1;
  if (p->zone[0] != q->zone[0]) return p->zone[0] < q->zone[0] ? -1 : 1;
  return p->zone[1] < q->zone[1] ? -1 : p->zone[1] > q->zone[1];
}

static int is_between(const struct vg_mesh *m, const uint32_t side[2])
{
  return side[0] != side[1] && side[0] < m->n_zone && side[1] < m->n_zone;
}

static vg_status find_pairs(struct vg_zone_parts *p, struct vg_error *err)
{
  const struct vg_mesh *m = p->m;
  uint32_t(*const side)[2] = p->side;
  size_t n = 0;
  vg_status st;

  VG_TRY(vg_mesh_zone_sides(m, side, err));
  for (size_t t = 0; t < m->n_sheet_tri; t++)
    if (is_between(m, side[t]))
      p->pair[n++] = (struct vg_zone_pair){ { side[t][0], side[t][1] },
                                            m->sheet_of[t] };
  if (n) qsort(p->pair, n, sizeof *p->pair, by_pair);
  for (size_t k = 0; k < n; k++)
    if (!k || by_pair(&p->pair[k], &p->pair[k - 1]))
      p->pair[p->n_pair++] = p->pair[k];
  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    const struct vg_zone_pair key = { { side[t][0], side[t][1] },
                                      m->sheet_of[t] },
                              *at = NULL;

    if (p->n_pair) at = bsearch(&key, p->pair, p->n_pair, sizeof *at, by_pair);
    p->pair_of[t] = at ? (uint32_t)(at - p->pair) : UINT32_MAX;
  }
done:
  return st;
}

/* Patches of m, and two of each pair with numbers of their own. */
static vg_status make_patches(struct vg_zone_parts *p, struct vg_error *err)
{
  const struct vg_mesh *m = p->m;
  const int32_t last = vg_mesh_last_id(m);

  p->n_patch = m->n_patch + 2 * p->n_pair;
  p->patch = vg_calloc(p->n_patch, sizeof *p->patch);
  if (!p->patch) return vg_fail_memory(err, "the patches");
  if (m->n_patch) memcpy(p->patch, m->patch, m->n_patch * sizeof *m->patch);
  for (size_t k = 0; k < 2 * p->n_pair; k++) {
    const struct vg_patch *sheet = &m->sheet[p->pair[k / 2].sheet];
    struct vg_patch *to = &p->patch[m->n_patch + k];
    char name[VG_NAME_MAX + 24];

    if (*sheet->name) snprintf(name, sizeof name, "%s", sheet->name);
    else snprintf(name, sizeof name, "patch_%d", (int)sheet->id);
    *to = (struct vg_patch){ .bc = VG_BC_NONE, .bc_fun3d = VG_BC_NONE };
    to->id = (int32_t)((uint32_t)last + (uint32_t)k + 1);
    snprintf(to->name, sizeof to->name, "%.*s%s", VG_NAME_MAX - 6, name,
             k % 2 ? "_back" : "");
  }
  return VG_OK;
}

vg_status vg_zone_parts_new(const struct vg_mesh *m, struct vg_zone_parts *p,
                            struct vg_error *err)
{
  vg_status st = VG_OK;

  assert(m->n_zone);
  *p = (struct vg_zone_parts){ .m = m };
  p->face_zone = vg_alloc(m->n_tri + m->n_quad, sizeof *p->face_zone);
  p->pair_of = vg_alloc(m->n_sheet_tri, sizeof *p->pair_of);
  p->pair = vg_alloc(m->n_sheet_tri, sizeof *p->pair);
  p->side = vg_alloc(m->n_sheet_tri, sizeof *p->side);
  p->number = vg_alloc(m->n_point, sizeof *p->number);
  if (!p->face_zone || !p->pair_of || !p->pair || !p->side || !p->number)
    VG_TRY(vg_fail_memory(err, "the zones"));
  VG_TRY(find_face_zones(p, err));
  VG_TRY(find_pairs(p, err));
  st = make_patches(p, err);
done:
  if (st < 0) vg_zone_parts_release(p);
  return st;
}

void vg_zone_parts_release(struct vg_zone_parts *p)
{
  free(p->pair);
  free(p->patch);
  free(p->face_zone);
  free(p->pair_of);
  free(p->side);
  free(p->number);
  *p = (struct vg_zone_parts)VG_ZONE_PARTS_INIT;
}

/* --- a zone --------------------------------------------------------------- */

/* Cells of a kind in zone z, with the numbers of the points of m. */
static void copy_cells(const struct vg_mesh *m, size_t z, struct vg_mesh *out)
{
  for (int k = 0; k < VG_ZONE_KINDS; k++) {
    const size_t w = (size_t)vg_cell_faces[k].width,
                 n = w * m->zone[z].n_cell[k];

    if (n)
      memcpy(vg_mesh_nodes(out, k),
             vg_mesh_nodes(m, k) + w * vg_mesh_zone_start(m, z, k),
             n * sizeof(uint32_t));
  }
}

/* Faces of the boundary, then those of interfaces on both sides. */
static void copy_faces(const struct vg_zone_parts *p, uint32_t z,
                       struct vg_mesh *out)
{
  const struct vg_mesh *m = p->m;

  for (size_t t = 0; t < m->n_tri; t++) {
    if (p->face_zone[t] != z) continue;
    memcpy(out->tri[out->n_tri], m->tri[t], sizeof *m->tri);
    out->tri_patch[out->n_tri++] = m->tri_patch[t];
  }
  for (size_t q = 0; q < m->n_quad; q++) {
    if (p->face_zone[m->n_tri + q] != z) continue;
    memcpy(out->quad[out->n_quad], m->quad[q], sizeof *m->quad);
    out->quad_patch[out->n_quad++] = m->quad_patch[q];
  }
  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    const uint32_t at = p->pair_of[t], *v = m->sheet_tri[t];
    const int is_back = at != UINT32_MAX && p->pair[at].zone[1] == z;

    if (at == UINT32_MAX || p->pair[at].zone[is_back] != z) continue;
    out->tri[out->n_tri][0] = v[0];
    out->tri[out->n_tri][1] = v[1 + is_back];
    out->tri[out->n_tri][2] = v[2 - is_back];
    out->tri_patch[out->n_tri++] = (uint32_t)(m->n_patch + 2 * (size_t)at +
                                              (size_t)is_back);
  }
}

static void renumber(const uint32_t *number, size_t n, uint32_t *v)
{
  for (size_t i = 0; i < n; i++) v[i] = number[v[i]];
}

/* Points of the cells, in their order. Faces have the points of cells. */
static vg_status take_points(struct vg_zone_parts *p, struct vg_mesh *out,
                             struct vg_error *err)
{
  const size_t n[] = { 4 * out->n_tet, 5 * out->n_pyr, 6 * out->n_pri,
                       8 * out->n_hex, 3 * out->n_tri, 4 * out->n_quad };
  uint32_t *const node[] = { (uint32_t *)out->tet, (uint32_t *)out->pyr,
                             (uint32_t *)out->pri, (uint32_t *)out->hex,
                             (uint32_t *)out->tri, (uint32_t *)out->quad };

  memset(p->number, 0, p->m->n_point * sizeof *p->number);
  for (size_t k = 0; k < sizeof n / sizeof *n; k++)
    for (size_t i = 0; i < n[k]; i++) p->number[node[k][i]] = 1;
  for (size_t i = 0; i < p->m->n_point; i++) out->n_point += p->number[i];
  out->point = vg_alloc(out->n_point, sizeof *out->point);
  if (!out->point) return vg_fail_memory(err, "a zone");
  out->n_point = 0;
  for (size_t i = 0; i < p->m->n_point; i++) {
    if (!p->number[i]) continue;
    memcpy(out->point[out->n_point], p->m->point[i], sizeof *out->point);
    p->number[i] = (uint32_t)out->n_point++;
  }
  for (size_t k = 0; k < sizeof n / sizeof *n; k++)
    renumber(p->number, n[k], node[k]);
  return VG_OK;
}

/* Room for the faces of zone z; the counts of faces are 0 afterwards. */
static int make_room(const struct vg_zone_parts *p, uint32_t z,
                     struct vg_mesh *out)
{
  const struct vg_mesh *m = p->m;
  size_t n_tri = 0, n_quad = 0;

  for (size_t f = 0; f < m->n_tri + m->n_quad; f++)
    *(f < m->n_tri ? &n_tri : &n_quad) += p->face_zone[f] == z;
  for (size_t t = 0; t < m->n_sheet_tri; t++)
    n_tri += p->pair_of[t] != UINT32_MAX;
  out->n_tet = m->zone[z].n_cell[0];
  out->n_pyr = m->zone[z].n_cell[1];
  out->n_pri = m->zone[z].n_cell[2];
  out->n_hex = m->zone[z].n_cell[3];
  out->tet = vg_alloc(out->n_tet, sizeof *out->tet);
  out->pyr = vg_alloc(out->n_pyr, sizeof *out->pyr);
  out->pri = vg_alloc(out->n_pri, sizeof *out->pri);
  out->hex = vg_alloc(out->n_hex, sizeof *out->hex);
  out->tri = vg_alloc(n_tri, sizeof *out->tri);
  out->tri_patch = vg_alloc(n_tri, sizeof *out->tri_patch);
  out->quad = vg_alloc(n_quad, sizeof *out->quad);
  out->quad_patch = vg_alloc(n_quad, sizeof *out->quad_patch);
  out->patch = vg_alloc(p->n_patch, sizeof *out->patch);
  return out->tet && out->pyr && out->pri && out->hex && out->tri &&
         out->tri_patch && out->quad && out->quad_patch && out->patch;
}

vg_status vg_zone_part(struct vg_zone_parts *p, size_t z, struct vg_mesh *out,
                       struct vg_error *err)
{
  struct vg_mesh part = VG_MESH_INIT;
  vg_status st = VG_OK;

  assert(p->m && z < p->m->n_zone);
  if (!make_room(p, (uint32_t)z, &part)) VG_TRY(vg_fail_memory(err, "a zone"));
  if (p->n_patch) memcpy(part.patch, p->patch, p->n_patch * sizeof *p->patch);
  part.n_patch = p->n_patch;
  copy_cells(p->m, z, &part);
  copy_faces(p, (uint32_t)z, &part);
  VG_TRY(take_points(p, &part, err));
  vg_mesh_move(out, &part);
done:
  vg_mesh_release(&part);
  return st;
}
