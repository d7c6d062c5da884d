/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/mesh/double_faces.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/mesh/cell_faces.h"
#include "core/mesh/zone_meshes.h"

struct doubling {
  struct vg_mesh *m;
  const uint8_t *is_doubled; /* [n_sheet] */
  struct vg_zone_parts parts;
  uint32_t *group;        /* [n_zone] lowest zone of those that stay connected;
                             later [n_sheet] */
  size_t n_side;          /* triangles that get two sides */
  size_t n_new_patch;     /* doubled sheets */
  int32_t last_id;        /* highest number of a patch */
  uint32_t *first, *last; /* [n_point] first and last group of a point */
  uint32_t *copy;         /* [n_point] its number in the last group */
  size_t n_copy;
  uint32_t *of; /* [n_copy] original of each copy; NULL: copies are counted */
};

static const char *space(const struct vg_patch *p)
{
  return *p->name ? " " : "";
}

/* --- checks --------------------------------------------------------------- */

/* Zones that stay connected, through interfaces that are not doubled. */
static vg_status group_zones(struct doubling *d, struct vg_error *err)
{
  const struct vg_zone_parts *p = &d->parts;
  const struct vg_mesh *m = d->m;

  for (size_t z = 0; z < m->n_zone; z++) d->group[z] = (uint32_t)z;
  for (size_t k = 0; k < p->n_pair; k++)
    if (!d->is_doubled[p->pair[k].sheet])
      vg_union(d->group, p->pair[k].zone[0], p->pair[k].zone[1]);
  for (size_t z = 0; z < m->n_zone; z++)
    d->group[z] = vg_root_of(d->group, (uint32_t)z);
  for (size_t k = 0; k < p->n_pair; k++) {
    const struct vg_zone_pair *q = &p->pair[k];
    const struct vg_patch *s = &m->sheet[q->sheet];

    if (!d->is_doubled[q->sheet] ||
        d->group[q->zone[0]] != d->group[q->zone[1]])
      continue;
    return vg_fail(err, VG_ERR_INPUT,
                   "interface %d%s%s cannot have two sides: other interfaces "
                   "connect the zones %d and %d next to it; double these, too",
                   (int)s->id, space(s), s->name, (int)m->zone[q->zone[0]].id,
                   (int)m->zone[q->zone[1]].id);
  }
  return VG_OK;
}

static vg_status check_sheets(struct doubling *d, struct vg_error *err)
{
  const struct vg_mesh *m = d->m;

  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    const struct vg_patch *s = &m->sheet[m->sheet_of[t]];
    const double *x = m->point[m->sheet_tri[t][0]];

    if (!d->is_doubled[m->sheet_of[t]]) continue;
    d->n_side++;
    if (d->parts.pair_of[t] == UINT32_MAX)
      return vg_fail(err, VG_ERR_INPUT,
                     "sheet %d%s%s cannot have two sides: it does not separate "
                     "two zones at (%g, %g, %g)",
                     (int)s->id, space(s), s->name, x[0], x[1], x[2]);
  }
  for (size_t i = 0; i < m->n_sheet; i++) d->n_new_patch += d->is_doubled[i];
  d->last_id = vg_mesh_last_id(m);
  if (d->n_new_patch > (size_t)(INT32_MAX - d->last_id))
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "no numbers are left for the backs of interfaces; renumber "
                   "the patches");
  return VG_OK;
}

/* --- points --------------------------------------------------------------- */

/* Copies of points in group g; those of the first group stay. */
static uint32_t take_point(struct doubling *d, uint32_t g, uint32_t p)
{
  if (d->first[p] == UINT32_MAX) d->first[p] = g;
  if (d->first[p] == g) return p;
  if (d->last[p] != g) {
    d->last[p] = g;
    d->copy[p] = (uint32_t)(d->m->n_point + d->n_copy);
    if (d->of) d->of[d->n_copy] = p;
    d->n_copy++;
  }
  return d->copy[p];
}

/* The cells of group g get its points; without d->of, they are only counted. */
static void take_cells(struct doubling *d, uint32_t g)
{
  struct vg_mesh *m = d->m;

  for (size_t z = 0; z < m->n_zone; z++)
    for (int k = 0; k < VG_ZONE_KINDS && d->group[z] == g; k++) {
      const size_t w = (size_t)vg_cell_faces[k].width,
                   n = w * m->zone[z].n_cell[k];
      uint32_t *node = n ? vg_mesh_nodes(m, k) + w * vg_mesh_zone_start(m, z, k)
                         : NULL;

      for (size_t i = 0; i < n; i++) {
        const uint32_t p = take_point(d, g, node[i]);

        if (d->of) node[i] = p;
      }
    }
}

static void start(struct doubling *d)
{
  memset(d->first, 0xff, d->m->n_point * sizeof *d->first);
  memset(d->last, 0xff, d->m->n_point * sizeof *d->last);
  d->n_copy = 0;
}

static void put_nodes(struct doubling *d, uint32_t g, size_t n,
                      const uint32_t *from, uint32_t *to)
{
  for (size_t k = 0; k < n; k++) to[k] = take_point(d, g, from[k]);
}

/* Faces of group g, whose points are those of its cells. Both sides of doubled
 * triangles are in m->tri from `first` on: fronts, then backs. */
static void take_faces(struct doubling *d, uint32_t g, size_t first)
{
  const struct vg_zone_parts *p = &d->parts;
  struct vg_mesh *m = d->m;
  size_t at = first;

  for (size_t t = 0; t < first; t++)
    if (d->group[p->face_zone[t]] == g)
      put_nodes(d, g, 3, m->tri[t], m->tri[t]);
  for (size_t q = 0; q < m->n_quad; q++)
    if (d->group[p->face_zone[first + q]] == g)
      put_nodes(d, g, 4, m->quad[q], m->quad[q]);
  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    const uint32_t *v = m->sheet_tri[t], back[3] = { v[0], v[2], v[1] },
                   zone = p->side[t][p->side[t][0] == UINT32_MAX];

    if (!d->is_doubled[m->sheet_of[t]]) {
      if (zone != UINT32_MAX && d->group[zone] == g)
        put_nodes(d, g, 3, v, m->sheet_tri[t]);
      continue;
    }
    if (d->group[p->side[t][0]] == g) put_nodes(d, g, 3, v, m->tri[at]);
    if (d->group[p->side[t][1]] == g)
      put_nodes(d, g, 3, back, m->tri[at + d->n_side]);
    at++;
  }
}

/* --- patches -------------------------------------------------------------- */

static void add_patches(struct doubling *d, size_t first)
{
  struct vg_mesh *m = d->m;
  uint32_t *to = d->group; /* not needed any more: [n_sheet] fits */
  size_t at = first, n_patch = m->n_patch;
  int32_t id = d->last_id;

  for (size_t i = 0; i < m->n_sheet; i++) {
    struct vg_patch *front = &m->patch[n_patch], *back = front + 1;

    if (!d->is_doubled[i]) continue;
    to[i] = (uint32_t)n_patch;
    *front = *back = m->sheet[i];
    front->is_sheet = front->is_split = back->is_sheet = back->is_split = 0;
    front->is_interface = back->is_interface = 1;
    front->inner = VG_INNER_FRONT;
    back->inner = VG_INNER_BACK;
    back->id = ++id;
    if (*front->name)
      snprintf(back->name, sizeof back->name, "%.*s_back", VG_NAME_MAX - 6,
               front->name);
    n_patch += 2;
  }
  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    if (!d->is_doubled[m->sheet_of[t]]) continue;
    m->tri_patch[at] = to[m->sheet_of[t]];
    m->tri_patch[at + d->n_side] = to[m->sheet_of[t]] + 1;
    at++;
  }
  m->n_patch = n_patch;
}

/* Removes the doubled sheets. */
static void drop_sheets(struct doubling *d)
{
  struct vg_mesh *m = d->m;
  uint32_t *to = d->group;
  size_t n = 0, n_tri = 0;

  for (size_t i = 0; i < m->n_sheet; i++) {
    to[i] = (uint32_t)n;
    if (!d->is_doubled[i]) m->sheet[n++] = m->sheet[i];
  }
  for (size_t t = 0; t < m->n_sheet_tri; t++) {
    if (d->is_doubled[m->sheet_of[t]]) continue;
    memmove(m->sheet_tri[n_tri], m->sheet_tri[t], sizeof *m->sheet_tri);
    m->sheet_of[n_tri++] = to[m->sheet_of[t]];
  }
  m->n_sheet = n;
  m->n_sheet_tri = n_tri;
}

/* --- all ------------------------------------------------------------------ */

static vg_status make_room(struct doubling *d, struct vg_error *err)
{
  struct vg_mesh *m = d->m;
  size_t cap[4] = { m->n_point, m->n_tri, m->n_tri, m->n_patch };

  if (m->n_point + d->n_copy > UINT32_MAX - 1)
    return vg_fail(err, VG_ERR_UNSUPPORTED,
                   "the mesh would have more points than 32-bit numbers");
  d->of = vg_alloc(d->n_copy, sizeof *d->of);
  if (!d->of ||
      vg_reserve(&m->point, &cap[0], m->n_point + d->n_copy,
                 sizeof *m->point) ||
      vg_reserve(&m->tri, &cap[1], m->n_tri + 2 * d->n_side, sizeof *m->tri) ||
      vg_reserve(&m->tri_patch, &cap[2], m->n_tri + 2 * d->n_side,
                 sizeof *m->tri_patch) ||
      vg_reserve(&m->patch, &cap[3], m->n_patch + 2 * d->n_new_patch,
                 sizeof *m->patch))
    return vg_fail_memory(err, "the interfaces");
  return VG_OK;
}

static vg_status prepare(struct doubling *d, struct vg_error *err)
{
  const struct vg_mesh *m = d->m;
  const size_t n = m->n_zone > m->n_sheet ? m->n_zone : m->n_sheet;
  vg_status st;

  d->group = vg_alloc(n, sizeof *d->group);
  d->first = vg_alloc(m->n_point, sizeof *d->first);
  d->last = vg_alloc(m->n_point, sizeof *d->last);
  d->copy = vg_alloc(m->n_point, sizeof *d->copy);
  if (!d->group || !d->first || !d->last || !d->copy)
    return vg_fail_memory(err, "the interfaces");
  VG_TRY(vg_zone_parts_new(m, &d->parts, err));
  VG_TRY(check_sheets(d, err));
  VG_TRY(group_zones(d, err));
  start(d);
  for (uint32_t g = 0; g < m->n_zone; g++) take_cells(d, g);
  st = make_room(d, err);
done:
  return st;
}

vg_status vg_mesh_double_faces(struct vg_mesh *m, const uint8_t *is_doubled,
                               struct vg_error *err)
{
  struct doubling d = { .m = m, .is_doubled = is_doubled };
  const size_t first = m->n_tri;
  vg_status st = VG_OK;

  assert(m->n_zone && is_doubled);
  VG_TRY(prepare(&d, err));
  start(&d);
  for (uint32_t g = 0; g < m->n_zone; g++) {
    take_cells(&d, g);
    take_faces(&d, g, first);
  }
  for (size_t i = 0; i < d.n_copy; i++)
    memcpy(m->point[m->n_point + i], m->point[d.of[i]], sizeof *m->point);
  m->n_point += d.n_copy;
  add_patches(&d, first);
  drop_sheets(&d);
  m->n_tri += 2 * d.n_side;
done:
  vg_zone_parts_release(&d.parts);
  free(d.group);
  free(d.first);
  free(d.last);
  free(d.copy);
  free(d.of);
  return st;
}
