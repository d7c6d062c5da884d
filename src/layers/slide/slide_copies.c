/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Inner surfaces that end on a remeshed slide patch, and whose columns have no
 * levels there, are slits in it. If the mesh continues through the surface,
 * both sides of the slit have the same points. Otherwise they have copies of
 * them: the region is remeshed with one point for all copies, and each new
 * triangle then gets the copy of its side:
 *
 *        \ | /             edges of the boundary run along both sides of the
 *     ----a-b-c            slit; the triangles from one of them counter-
 *     ----a'b'c            clockwise around its first point, up to the next
 *        / | \             edge of the boundary, have its copy of the point */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/mesh/edges.h"
#include "core/mesh/sheets.h"
#include "layers/slide/slide_parts.h"

vg_status vg_slide_hold(struct vg_slide_work *w)
{
  const struct vg_mesh *m = w->m;
  size_t n = 0;

  for (size_t t = 0; t < m->n_tri; t++)
    n += 3 * (size_t)vg_patch_is_passed(&m->patch[m->tri_patch[t]]);
  if (!n) return VG_OK;
  w->held = vg_calloc(m->n_point, 1);
  w->held_edge = vg_alloc(n, sizeof *w->held_edge);
  if (!w->held || !w->held_edge) return vg_fail_memory(w->err, "the sheets");
  for (size_t t = 0; t < m->n_tri; t++)
    for (int k = 0; k < 3 && vg_patch_is_passed(&m->patch[m->tri_patch[t]]);
         k++) {
      const uint32_t a = m->tri[t][k], b = m->tri[t][k < 2 ? k + 1 : 0];

      w->held[a] = 1;
      w->held_edge[w->n_held++] = vg_slide_key(a, b);
    }
  qsort(w->held_edge, n, sizeof *w->held_edge, vg_compare_edge_keys);
  return VG_OK;
}

int vg_slide_is_held(const struct vg_slide_work *w, uint32_t a, uint32_t b)
{
  const uint32_t n = (uint32_t)w->m->n_point;
  uint64_t key;

  if (!w->held || a >= n || b >= n || !w->held[a] || !w->held[b]) return 0;
  key = vg_slide_key(a, b);
  return bsearch(&key, w->held_edge, w->n_held, sizeof key,
                 vg_compare_edge_keys) != NULL;
}

/* New triangles by the first points of their half-edges. */
struct turns {
  size_t n_tri;
  const uint32_t (*tri)[3];
  uint32_t *first, *half;
  uint8_t *is_border; /* [3 n_tri] 1: the half-edge is on the boundary. */
};

static vg_status sort_turns(struct turns *t, size_t n_point,
                            struct vg_error *err)
{
  t->first = vg_calloc(n_point + 2, sizeof *t->first);
  t->half = vg_alloc(3 * t->n_tri, sizeof *t->half);
  t->is_border = vg_calloc(3 * t->n_tri, 1);
  if (!t->first || !t->half || !t->is_border)
    return vg_fail_memory(err, "a slide patch");
  for (size_t h = 0; h < 3 * t->n_tri; h++)
    t->first[t->tri[h / 3][h % 3] + 2]++;
  for (size_t i = 2; i <= n_point + 1; i++) t->first[i] += t->first[i - 1];
  for (size_t h = 0; h < 3 * t->n_tri; h++)
    t->half[t->first[t->tri[h / 3][h % 3] + 1]++] = (uint32_t)h;
  return VG_OK;
}

static uint32_t find_half(const struct turns *t, uint32_t from, uint32_t to)
{
  for (uint32_t i = t->first[from]; i < t->first[from + 1]; i++)
    if (vg_half_to(t->tri, t->half[i]) == to) return t->half[i];
  return VG_NO_INDEX;
}

/* Gives the triangles around the first point of half-edge h the copy `point`,
 * up to the next edge of the boundary. */
static void turn(const struct turns *t, uint32_t h, uint32_t point,
                 uint32_t (*number)[3])
{
  const uint32_t from = vg_half_from(t->tri, h);

  while (h != VG_NO_INDEX) {
    const uint32_t prev = vg_half_prev(h);

    number[h / 3][h % 3] = point;
    h = t->is_border[prev] ? VG_NO_INDEX
                           : find_half(t, from, vg_half_from(t->tri, prev));
  }
}

vg_status vg_slide_use_copies(const struct vg_slide_work *w,
                              const struct vg_slide_loops *l, size_t n_point,
                              size_t n_tri, const uint32_t (*tri)[3],
                              uint32_t (*number)[3])
{
  struct turns t = { .n_tri = n_tri, .tri = tri };
  vg_status st = VG_OK;

  if (!w->copy_of) return VG_OK;
  VG_TRY(sort_turns(&t, n_point, w->err));
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < l->n; i++) {
      const uint32_t *e = l->edge[i];
      const uint32_t h = find_half(&t, vg_slide_local(w, e[0]),
                                   vg_slide_local(w, e[1]));

      assert(h != VG_NO_INDEX);
      if (!pass) t.is_border[h] = 1;
      else turn(&t, h, e[0], number);
    }
done:
  free(t.first);
  free(t.half);
  free(t.is_border);
  return st;
}
