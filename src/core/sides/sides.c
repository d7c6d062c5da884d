/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Neighbours across edges from the radial order of triangles; sectors and
 * regions as sets of neighbours. */
#include "core/sides/sides.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/union_find.h"
#include "core/sides/sides_parts.h"

/* --- radial order --------------------------------------------------------- */

/* Sorts the triangles on edge i. The first one, with the lowest half-edge,
 * stays the first. */
static void sort_edge(struct vg_sides *s, size_t i)
{
  uint32_t *half = s->edge.half + s->edge.start[i];
  const uint32_t n = vg_edges_count(&s->edge, i);
  const struct vg_turn axis = vg_turn_of(s, half[0]);

  for (uint32_t k = 2; k < n; k++) {
    const uint32_t h = half[k], apex = vg_half_apex(s, h);
    uint32_t m = k;

    for (; m > 1 && vg_turn_before(&axis, s->x[apex],
                                   s->x[vg_half_apex(s, half[m - 1])]);
         m--)
      half[m] = half[m - 1];
    half[m] = h;
  }
}

/* Joins the half-faces that look into the wedge between the triangles of
 * half-edges g and h, which is counter-clockwise from g. */
static void join(struct vg_sides *s, uint32_t g, uint32_t h)
{
  const uint32_t a = vg_wedge_above(s, g), b = vg_wedge_below(s, h);

  s->across[a] = b;
  s->across[b] = a;
}

static void find_across(struct vg_sides *s)
{
  for (size_t i = 0; i < s->edge.n; i++) {
    const uint32_t *half, n = vg_edges_count(&s->edge, i);

    sort_edge(s, i);
    half = vg_edges_at(&s->edge, i);
    for (uint32_t k = 0; k < n; k++)
      join(s, half[k], half[k + 1 < n ? k + 1 : 0]);
  }
}

/* --- sectors and regions -------------------------------------------------- */

/* Corner of half-face edge e, 3 h + k, at the start or the end of the edge in
 * the direction of the triangle. */
static uint32_t corner_at(uint32_t e, int end)
{
  return end ? vg_half_next(e) : e;
}

static uint32_t point_at(const struct vg_sides *s, uint32_t corner)
{
  return s->tri[corner / 6][corner % 3];
}

static void unite_sectors(struct vg_sides *s)
{
  for (uint32_t e = 0; e < 6 * s->n_tri; e++) {
    const uint32_t g = s->across[e];
    const int turned = point_at(s, e) != point_at(s, g);

    if (g < e) continue;
    for (int end = 0; end < 2; end++)
      vg_union(s->sector, corner_at(e, end), corner_at(g, end ^ turned));
  }
}

/* Numbers the sets in the order of their first members. Returns their number.
 * Roots are the lowest members, so each is met before the others. */
static size_t number_sets(uint32_t *up, size_t n)
{
  uint32_t count = 0;

  for (uint32_t k = 0; k < n; k++) up[k] = vg_root_of(up, k);
  for (uint32_t k = 0; k < n; k++) up[k] = up[k] == k ? count++ : up[up[k]];
  return count;
}

static void find_sets(struct vg_sides *s)
{
  for (uint32_t k = 0; k < 6 * s->n_tri; k++) s->sector[k] = k;
  for (uint32_t h = 0; h < 2 * s->n_tri; h++) s->region[h] = h;
  unite_sectors(s);
  for (uint32_t e = 0; e < 6 * s->n_tri; e++)
    vg_union(s->region, e / 3, s->across[e] / 3);
  s->n_sector = number_sets(s->sector, 6 * s->n_tri);
  s->n_region = number_sets(s->region, 2 * s->n_tri);
}

/* --- whole -----------------------------------------------------------------
 */

static void list_corners(struct vg_sides *s)
{
  uint32_t sum = 0;

  for (uint32_t k = 0; k < 3 * s->n_tri; k++) s->first[s->tri[k / 3][k % 3]]++;
  for (size_t p = 0; p <= s->n_point; p++) {
    sum += s->first[p];
    s->first[p] = sum;
  }
  for (uint32_t k = (uint32_t)(3 * s->n_tri); k--;)
    s->corner[--s->first[s->tri[k / 3][k % 3]]] = k;
}

vg_status vg_sides_build(struct vg_sides *s, size_t n_point,
                         const double (*x)[3], size_t n_tri,
                         const uint32_t (*tri)[3], struct vg_error *err)
{
  vg_status st;

  assert(!s->n_tri && !s->across && !s->sector);
  assert((x && tri) || !n_tri);
  assert(n_tri < UINT32_MAX / 6);
  VG_TRY(vg_edges_build(&s->edge, n_point, n_tri, tri, NULL, 0, err));
  s->n_point = n_point;
  s->n_tri = n_tri;
  s->x = x;
  s->tri = tri;
  s->across = vg_alloc(6 * n_tri, sizeof *s->across);
  s->sector = vg_alloc(6 * n_tri, sizeof *s->sector);
  s->region = vg_alloc(2 * n_tri, sizeof *s->region);
  s->first = vg_calloc(n_point + 1, sizeof *s->first);
  s->corner = vg_alloc(3 * n_tri, sizeof *s->corner);
  if (!s->across || !s->sector || !s->region || !s->first || !s->corner)
    VG_TRY(vg_fail_memory(err, "the sides of a surface"));
  list_corners(s);
  find_across(s);
  find_sets(s);
done:
  if (st < 0) vg_sides_release(s);
  return st;
}

void vg_sides_release(struct vg_sides *s)
{
  vg_edges_release(&s->edge);
  free(s->across);
  free(s->sector);
  free(s->region);
  free(s->first);
  free(s->corner);
  *s = (struct vg_sides)VG_SIDES_INIT;
}

/* --- points where surfaces touch ------------------------------------------ */

vg_status vg_sides_fans(const struct vg_sides *s, uint32_t *n_fan,
                        struct vg_error *err)
{
  uint32_t *up = vg_alloc(3 * s->n_tri, sizeof *up);

  assert(n_fan || !s->n_point);
  if (!up) return vg_fail_memory(err, "the sides of a surface");
  for (uint32_t k = 0; k < 3 * s->n_tri; k++) up[k] = k;
  for (size_t i = 0; i < s->edge.n; i++) {
    const uint32_t *half = vg_edges_at(&s->edge, i);
    const uint32_t a = vg_half_from(s->tri, half[0]);

    for (uint32_t k = 1; k < vg_edges_count(&s->edge, i); k++) {
      const int turned = vg_half_from(s->tri, half[k]) != a;

      vg_union(up, half[0], turned ? vg_half_next(half[k]) : half[k]);
      vg_union(up, vg_half_next(half[0]),
               turned ? half[k] : vg_half_next(half[k]));
    }
  }
  memset(n_fan, 0, s->n_point * sizeof *n_fan);
  for (uint32_t k = 0; k < 3 * s->n_tri; k++)
    n_fan[s->tri[k / 3][k % 3]] += vg_root_of(up, k) == k;
  free(up);
  return VG_OK;
}
