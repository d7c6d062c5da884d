/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Zones without cells: their triangles go away, and interfaces that separate
 * them from other zones become walls. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/copies.h"
#include "run/input/zone_table.h"

/* Sides of an interface on which there are cells. */
enum { NO_SIDE = 1, ONE_SIDE = 2, BOTH_SIDES = 4 };

struct cut {
  struct vg_boundary *b;
  const struct vg_zone_map *map;
  const uint8_t *is_empty; /* [map->n] */
  uint8_t *sides;          /* [n_patch] of fronts: sets of the above */
  uint32_t *front;         /* [n_patch] front of a back; itself for others */
};

static vg_status refuse_mixed(const struct cut *c, size_t patch,
                              struct vg_error *err)
{
  const struct vg_patch *p = &c->b->surface.patch[patch];

  return vg_fail(
    err, VG_ERR_INPUT,
    "interface %d%s%s is on a zone without cells in one part only; "
    "split it where that zone begins, or mesh the zone (mesh yes "
    "in the table zones)",
    (int)p->id, *p->name ? " " : "", p->name);
}

static vg_status find_sides(struct cut *c, struct vg_error *err)
{
  const struct vg_mesh *m = &c->b->surface;
  uint32_t *first = NULL, *other = vg_alloc(m->n_tri, sizeof *other);
  vg_status st = other ? vg_mesh_inner_points(m, &first, err)
                       : vg_fail_memory(err, "the zones");

  VG_TRY(st);
  VG_TRY(vg_mesh_inner_pairs(m, first, other, err));
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t p = m->tri_patch[t];
    int n;

    if (!m->patch[p].is_interface || m->patch[p].inner != VG_INNER_FRONT)
      continue;
    n = !c->is_empty[c->map->of[t]] + !c->is_empty[c->map->of[other[t]]];
    c->sides[p] |= n == 2 ? BOTH_SIDES : n ? ONE_SIDE : NO_SIDE;
  }
  for (size_t p = 0; p < m->n_patch && st >= 0; p++)
    if (c->sides[p] & (c->sides[p] - 1)) st = refuse_mixed(c, p, err);
done:
  free(first);
  free(other);
  return st;
}

/* Triangles that look into zones with cells; those of a wall are in its front
 * patch. */
static void keep_triangles(const struct cut *c)
{
  struct vg_surface_report *r = &c->b->check;
  struct vg_mesh *m = &c->b->surface;
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t p = m->tri_patch[t], front = c->front[p];

    if (c->is_empty[c->map->of[t]]) continue;
    memmove(m->tri[n], m->tri[t], sizeof *m->tri);
    m->tri_patch[n] = c->sides[front] == ONE_SIDE ? front : p;
    r->face_kinds[n] = r->face_kinds[t];
    r->tri_shell[n++] = r->tri_shell[t];
  }
  m->n_tri = n;
}

static void turn_patches(const struct cut *c)
{
  struct vg_mesh *m = &c->b->surface;

  for (size_t p = 0; p < m->n_patch; p++) {
    struct vg_patch *patch = &m->patch[p];
    const int sides = c->sides[c->front[p]];

    if (sides != ONE_SIDE && sides != NO_SIDE) continue;
    patch->is_split = 0;
    if (sides == ONE_SIDE && c->front[p] == p) {
      patch->is_sheet = 0;
      patch->inner = VG_INNER_NOT;
      vg_note(c->b->notes,
              "interface %d%s%s is a wall: a zone on one side has "
              "no cells",
              (int)patch->id, *patch->name ? " " : "", patch->name);
    } else {
      patch->is_sheet = VG_SHEET_GONE;
      patch->inner = VG_INNER_BACK;
    }
  }
}

/* Removes the points that no triangle has. */
static vg_status keep_points(struct vg_mesh *m, struct vg_error *err)
{
  uint32_t *to = vg_calloc(m->n_point, sizeof *to);
  uint32_t n = 0;

  if (!to) return vg_fail_memory(err, "the zones");
  for (size_t k = 0; k < 3 * m->n_tri; k++) to[m->tri[k / 3][k % 3]] = 1;
  for (size_t p = 0; p < m->n_point; p++) {
    if (to[p]) memmove(m->point[n], m->point[p], sizeof *m->point);
    n += to[p];
    to[p] = n - to[p];
  }
  m->n_point = n;
  for (size_t k = 0; k < 3 * m->n_tri; k++)
    m->tri[k / 3][k % 3] = to[m->tri[k / 3][k % 3]];
  free(to);
  return VG_OK;
}

vg_status vg_boundary_cut_zones(struct vg_boundary *b,
                                const struct vg_zone_map *map,
                                const uint8_t *is_empty, struct vg_error *err)
{
  struct vg_mesh *m = &b->surface;
  struct cut c = { .b = b, .map = map, .is_empty = is_empty };
  vg_status st = VG_OK;

  assert(map->surface == m);
  c.sides = vg_calloc(m->n_patch, 1);
  c.front = vg_alloc(m->n_patch, sizeof *c.front);
  if (!c.sides || !c.front) VG_TRY(vg_fail_memory(err, "the zones"));
  for (size_t p = 0; p < m->n_patch; p++)
    c.front[p] = (uint32_t)vg_mesh_front_patch(m, p);
  VG_TRY(find_sides(&c, err));
  keep_triangles(&c);
  turn_patches(&c);
  st = keep_points(m, err);
done:
  free(c.sides);
  free(c.front);
  return st;
}
