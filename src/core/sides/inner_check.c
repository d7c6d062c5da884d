/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Whether sheets are in the fluid, and connected with other surfaces by edges
 * or not at all. */
#include <assert.h>
#include <stdlib.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/geometry/predicates.h"
#include "core/sides/inner_parts.h"
#include "core/sides/zone_line.h"

static vg_status fail_at(const struct vg_inner_work *s, size_t t,
                         const char *why, struct vg_error *err)
{
  const struct vg_mesh *m = s->m;
  const struct vg_patch *p = &m->patch[m->tri_patch[t]];
  double x[3] = { 0, 0, 0 };

  for (int k = 0; k < 3; k++)
    for (int d = 0; d < 3; d++) x[d] += m->point[m->tri[t][k]][d] / 3;
  return vg_fail(err, VG_ERR_GEOMETRY,
                 "patch %d%s%s, an inner surface, %s at (%g, %g, %g)",
                 (int)p->id, *p->name ? " " : "", p->name, why, x[0], x[1],
                 x[2]);
}

/* --- points --------------------------------------------------------------- */

static vg_status check_points(const struct vg_inner_work *s,
                              struct vg_error *err)
{
  uint32_t *n_fan = vg_alloc(s->sides.n_point, sizeof *n_fan);
  vg_status st = n_fan ? vg_sides_fans(&s->sides, n_fan, err)
                       : vg_fail_memory(err, "the sides of a sheet");

  for (size_t t = 0; st >= 0 && t < s->m->n_tri; t++)
    for (int k = 0; k < 3 && st >= 0 && vg_is_sheet(s, t); k++)
      if (n_fan[s->m->tri[t][k]] > 1)
        st = fail_at(s, t,
                     "touches a surface or itself in a single point; let them "
                     "share an edge, or move them apart,",
                     err);
  free(n_fan);
  return st;
}

/* --- sheets that no other surface touches -----------------------------------
 */

static int crosses(const struct vg_mesh *m, size_t t, const double *a,
                   const double *b)
{
  const double *x[3];

  for (int k = 0; k < 3; k++) x[k] = m->point[m->tri[t][k]];
  return vg_line_crosses(x, a, b);
}

/* A place in triangle t that is not a special one such as the centroid, so that
 * few lines through it meet corners and edges. */
static void place_in(const struct vg_mesh *m, size_t t, const double share[3],
                     double x[3])
{
  for (int d = 0; d < 3; d++) {
    x[d] = 0;
    for (int k = 0; k < 3; k++) x[d] += share[k] * m->point[m->tri[t][k]][d];
  }
}

/* Is point x in the fluid? A straight line to a place in triangle `last` of a
 * wall arrives from one of its sides; each wall that it crosses before changes
 * between fluid and solid. -1: the line meets a border, -2: it is in the plane
 * of the triangle. */
static int is_in_fluid(const struct vg_inner_work *s, const double *x,
                       size_t last)
{
  static const double share[3] = { .361, .293, .346 };
  const struct vg_mesh *m = s->m;
  const uint32_t *v = m->tri[last];
  double to[3], side;
  int is_fluid;

  place_in(m, last, share, to);
  side = vg_orient3d(m->point[v[0]], m->point[v[1]], m->point[v[2]], x);
  if (side == 0) return -2;
  is_fluid = side > 0;
  for (size_t t = 0; t < m->n_tri && side != 0; t++) {
    const int hit = t == last || vg_is_sheet(s, t) ? 0 : crosses(m, t, x, to);

    if (hit < 0) side = 0;
    is_fluid ^= hit > 0;
  }
  return side == 0 ? -1 : is_fluid;
}

enum { TRIES = 64 }; /* Lines for one sheet; nearly always the first decides. */

static vg_status check_alone(const struct vg_inner_work *s, size_t t,
                             struct vg_error *err)
{
  static const double share[3] = { .227, .342, .431 };
  double x[3];
  int n = 0;

  place_in(s->m, t, share, x);
  for (size_t last = 0; last < s->m->n_tri && n < TRIES; last++) {
    int is;

    if (vg_is_sheet(s, last)) continue;
    is = is_in_fluid(s, x, last);
    n += is != -2;
    if (is > 0) return VG_OK;
    if (is == 0) return fail_at(s, t, "is not in the fluid", err);
  }
  return fail_at(s, t,
                 "has an unknown place, since lines from it to the walls meet "
                 "their edges; move it a little,",
                 err);
}

/* --- regions ----------------------------------------------------------------
 */

enum { HAS_SHEET = 1, HAS_FLUID = 2, HAS_SOLID = 4 };

static void mark_regions(const struct vg_inner_work *s, uint8_t *has)
{
  for (size_t h = 0; h < 2 * s->m->n_tri; h++)
    has[s->sides.region[h]] |= vg_is_sheet(s, h / 2) ? HAS_SHEET
                             : h % 2                 ? HAS_SOLID
                                                     : HAS_FLUID;
}

/* Triangles that edges connect belong to one component, which has one region of
 * fluid unless its sheets divide it. Sheets through which the mesh continues do
 * not divide regions. */
static vg_status count_sealed(const struct vg_inner_work *s, const uint8_t *has,
                              struct vg_error *err)
{
  const struct vg_sides *a = &s->sides;
  uint32_t *up = vg_alloc(a->n_region, sizeof *up);
  size_t n_fluid = 0, n_component = 0;

  if (!up) return vg_fail_memory(err, "the sides of a sheet");
  for (uint32_t r = 0; r < a->n_region; r++) up[r] = r;
  for (size_t t = 0; t < a->n_tri; t++)
    if (vg_is_sheet(s, t) && s->m->patch[s->m->tri_patch[t]].is_sheet)
      vg_union(up, a->region[2 * t], a->region[2 * t + 1]);
  for (uint32_t r = 0; r < a->n_region; r++)
    n_fluid += up[r] == r && !(has[r] & HAS_SOLID);
  for (size_t t = 0; t < a->n_tri; t++)
    vg_union(up, a->region[2 * t], a->region[2 * t + 1]);
  for (uint32_t r = 0; r < a->n_region; r++) n_component += up[r] == r;
  s->report->n_sealed = n_fluid - n_component;
  free(up);
  return VG_OK;
}

/* A region on the solid side of walls has no sheets. A sheet without walls is
 * one region with both sides, or encloses a part of the space: then one of its
 * points decides, once for each region. */
static vg_status check_regions(const struct vg_inner_work *s,
                               struct vg_error *err)
{
  uint8_t *has = vg_calloc(s->sides.n_region, 1);
  vg_status st = has ? VG_OK : vg_fail_memory(err, "the sides of a sheet");

  if (has) mark_regions(s, has);
  for (size_t h = 0; st >= 0 && h < 2 * s->m->n_tri; h++) {
    uint8_t *is = &has[s->sides.region[h]];

    if (!vg_is_sheet(s, h / 2)) continue;
    if (*is & HAS_SOLID) st = fail_at(s, h / 2, "is not in the fluid", err);
    else if (!(*is & HAS_FLUID)) st = check_alone(s, h / 2, err);
    *is |= HAS_FLUID;
  }
  if (st >= 0) st = count_sealed(s, has, err);
  free(has);
  return st;
}

vg_status vg_inner_check(const struct vg_inner_work *s, struct vg_error *err)
{
  vg_status st = check_points(s, err);

  return st < 0 ? st : check_regions(s, err);
}
