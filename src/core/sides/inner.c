/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/sides/inner.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/sides/inner_parts.h"

/* Finds the sectors that the mesh connects through sheets. */
static vg_status connect(struct vg_inner_work *s, struct vg_error *err)
{
  const uint32_t *sector = s->sides.sector;

  free(s->room);
  s->room = vg_alloc(s->sides.n_sector, sizeof *s->room);
  if (!s->room) return vg_fail_memory(err, "the sides of a sheet");
  for (uint32_t i = 0; i < s->sides.n_sector; i++) s->room[i] = i;
  for (size_t t = 0; t < s->m->n_tri; t++)
    for (int k = 0; k < 3 && vg_is_passed(s, t); k++)
      vg_union(s->room, sector[6 * t + k], sector[6 * t + 3 + k]);
  for (uint32_t i = 0; i < s->sides.n_sector; i++)
    s->room[i] = vg_root_of(s->room, i);
  return VG_OK;
}

static vg_status build(struct vg_inner_work *s, struct vg_error *err)
{
  const struct vg_mesh *m = s->m;

  vg_sides_release(&s->sides);
  return vg_sides_build(&s->sides, m->n_point, (const double(*)[3])m->point,
                        m->n_tri, (const uint32_t(*)[3])m->tri, err);
}

/* Cuts edges until both sides differ: in the complete mesh, and while it is
 * made. */
static vg_status cut(struct vg_inner_work *s, struct vg_error *err)
{
  size_t n_cut, n;
  int has_split = 0;
  vg_status st = VG_OK;

  for (size_t i = 0; i < s->m->n_patch; i++)
    has_split |= s->m->patch[i].is_split;
  do {
    n = 0;
    for (s->passes_all = has_split + 1; s->passes_all--;) {
      VG_TRY(connect(s, err));
      VG_TRY(vg_inner_cut(s, &n_cut, err));
      if (n_cut) VG_TRY(build(s, err));
      n += n_cut;
    }
    s->report->n_cut += n;
    s->passes_all = 0;
  } while (n);
done:
  return st;
}

/* --- copies of points ----------------------------------------------------- */

/* Half-face corner e looks into the fluid. */
static int is_fluid(const struct vg_inner_work *s, uint32_t e)
{
  return !(e / 3 & 1) || vg_is_sheet(s, e / 6);
}

/* Gives each sector of the points of sheets a point: the first one the point
 * itself, the others copies. Sectors that the mesh connects through sheets are
 * one. point: [n_sector] */
static vg_status number_sectors(struct vg_inner_work *s, uint32_t *point,
                                struct vg_error *err)
{
  const struct vg_sides *a = &s->sides;
  size_t n = s->m->n_point, cap = n;

  memset(point, 0xff, a->n_sector * sizeof *point);
  for (uint32_t p = 0; p < a->n_point; p++) {
    int is_first = 1;

    for (uint32_t k = 2 * a->first[p]; k < 2 * a->first[p + 1]; k++) {
      const uint32_t c = a->corner[k / 2];
      const uint32_t e = 3 * (2 * (c / 3) + k % 2) + c % 3;
      uint32_t *at = &point[s->room[a->sector[e]]];

      if (!is_fluid(s, e) || *at != UINT32_MAX) continue;
      *at = is_first ? p : (uint32_t)n++;
      if (is_first) {
        is_first = 0;
        continue;
      }
      if (vg_reserve(&s->m->point, &cap, n, sizeof *s->m->point))
        return vg_fail_memory(err, "the sides of a sheet");
      memcpy(s->m->point[n - 1], s->m->point[p], sizeof *s->m->point);
    }
  }
  s->report->n_point += n - s->m->n_point;
  s->m->n_point = n;
  return VG_OK;
}

/* Triangles of walls and first sides in place, second sides at the end. */
static vg_status take_sides(struct vg_inner_work *s, const uint32_t *point,
                            const uint32_t *back, struct vg_error *err)
{
  struct vg_mesh *m = s->m;
  const struct vg_sides *a = &s->sides;
  const size_t n_tri = m->n_tri, n = n_tri + s->report->n_tri;
  uint32_t(*tri)[3] = vg_alloc(n, sizeof *tri);
  uint32_t *patch = vg_realloc(m->tri_patch, n, sizeof *patch);

  if (patch) m->tri_patch = patch;
  if (!tri || !patch) {
    free(tri);
    return vg_fail_memory(err, "the sides of a sheet");
  }
  for (size_t t = 0; t < n_tri; t++) {
    const uint32_t *first = a->sector + 6 * t, *second = first + 3;

    for (int k = 0; k < 3; k++) tri[t][k] = point[s->room[first[k]]];
    if (!vg_is_sheet(s, t)) continue;
    for (int k = 0; k < 3; k++)
      tri[m->n_tri][k] = point[s->room[second[k ? 3 - k : 0]]];
    patch[m->n_tri++] = back[patch[t]];
  }
  free(m->tri);
  m->tri = tri;
  return VG_OK;
}

static vg_status make_copies(struct vg_inner_work *s, const uint32_t *back,
                             struct vg_error *err)
{
  uint32_t *point = vg_alloc(s->sides.n_sector, sizeof *point);
  vg_status st = point ? number_sectors(s, point, err)
                       : vg_fail_memory(err, "the sides of a sheet");

  if (st >= 0) st = take_sides(s, point, back, err);
  free(point);
  return st;
}

/* --- whole -----------------------------------------------------------------
 */

static vg_status make(struct vg_inner_work *s, const uint32_t *back,
                      struct vg_error *err)
{
  vg_status st;

  VG_TRY(vg_inner_orient(s, err));
  VG_TRY(build(s, err));
  VG_TRY(vg_inner_check(s, err));
  VG_TRY(vg_inner_near(s, err));
  VG_TRY(cut(s, err));
  for (size_t t = 0; t < s->m->n_tri; t++)
    s->report->n_tri += (size_t)vg_is_sheet(s, t);
  st = make_copies(s, back, err);
done:
  return st;
}

vg_status vg_inner_double(struct vg_mesh *m, const uint8_t *is_inner,
                          const uint32_t *back, struct vg_inner_report *report,
                          struct vg_error *err)
{
  struct vg_mesh work = VG_MESH_INIT;
  struct vg_inner_work s = { .m = &work,
                             .is_inner = is_inner,
                             .report = report };
  vg_status st;

  assert(is_inner && back && report && !m->n_quad);
  memset(report, 0, sizeof *report);
  VG_TRY(vg_mesh_copy(&work, m, err));
  VG_TRY(make(&s, back, err));
  vg_mesh_move(m, &work);
done:
  free(s.room);
  vg_sides_release(&s.sides);
  vg_mesh_release(&work);
  return st;
}
