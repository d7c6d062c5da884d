/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Recovery by flips: first the edges, then the triangles. */
#include "core/recover/recover_flip.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"

/* Depth of each round. A round that follows another one finds different cells
 * and recovers more. */
static const int edge_round[] = { 0, 1, 1, 2, 2, 3, 3 };
static const int tri_round[] = { 0, 1, 2, 3 };

/* List the edges of the missing triangles, each once. Returns their number, or
 * SIZE_MAX if memory is refused. */
static size_t list_edges(const struct vg_flip_front *s, size_t n,
                         const uint32_t *missing, uint32_t (*edge)[2])
{
  uint8_t *listed = vg_calloc(s->first_edge[s->n_point], 1);
  size_t m = 0;

  if (!listed) return SIZE_MAX;
  for (size_t k = 0; k < n; k++)
    for (int i = 0; i < 3; i++) {
      uint32_t a = s->tri[missing[k]][i];
      uint32_t b = s->tri[missing[k]][(i + 1) % 3];
      uint32_t at = vg_flip_edge_at(s, a, b);

      if (listed[at]) continue;
      listed[at] = 1;
      edge[m][0] = a < b ? a : b;
      edge[m++][1] = a < b ? b : a;
    }
  free(listed);
  return m;
}

static size_t make_edges(struct vg_flipper *f, size_t n, uint32_t (*edge)[2],
                         int depth)
{
  size_t left = 0;

  for (size_t k = 0; k < n && !f->refused; k++) {
    uint32_t a = edge[k][0], b = edge[k][1];

    if (vg_flip_make_edge(f, a, b, depth)) continue;
    edge[left][0] = a;
    edge[left++][1] = b;
  }
  return left;
}

static size_t make_tris(struct vg_flipper *f, size_t n, uint32_t *missing,
                        int depth)
{
  size_t left = 0;

  for (size_t k = 0; k < n && !f->refused; k++) {
    const uint32_t *v = f->front.tri[missing[k]];

    if (!vg_flip_has_edge(f, v[0], v[1]) || !vg_flip_has_edge(f, v[1], v[2]) ||
        !vg_flip_has_edge(f, v[2], v[0]) || !vg_flip_make_tri(f, v, depth))
      missing[left++] = missing[k];
  }
  return left;
}

static vg_status flipper_init(struct vg_flipper *f, struct vg_tets *t,
                              size_t n_tri, const uint32_t (*tri)[3],
                              struct vg_error *err)
{
  vg_status st;

  f->t = t;
  VG_TRY(vg_flip_front_init(&f->front, t->n_point, n_tri, tri, err));
  f->star = vg_alloc(t->n_point, sizeof *f->star);
  if (!f->star) {
    st = vg_fail_memory(err, "boundary recovery");
    goto done;
  }
  memset(f->star, 0xff, t->n_point * sizeof *f->star);
  for (uint32_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4 && !(t->flag[c] & VG_DEAD); i++)
      f->star[t->cell[c].v[i]] = c;
done:
  return st;
}

vg_status vg_recover_flips(struct vg_tets *t, size_t n_tri,
                           const uint32_t (*tri)[3], size_t *n_missing,
                           uint32_t *missing, struct vg_error *err)
{
  assert(n_missing && *n_missing <= n_tri && missing);

  struct vg_flipper f = { 0 };
  uint32_t(*edge)[2] = vg_alloc(3 * *n_missing, sizeof *edge);
  size_t n = SIZE_MAX;
  vg_status st = flipper_init(&f, t, n_tri, tri, err);

  VG_TRY(st);
  if (edge) n = list_edges(&f.front, *n_missing, missing, edge);
  f.refused = n == SIZE_MAX;
  for (size_t k = 0; k < sizeof edge_round / sizeof *edge_round; k++)
    if (!f.refused && n) n = make_edges(&f, n, edge, edge_round[k]);
  for (size_t k = 0; k < sizeof tri_round / sizeof *tri_round; k++)
    if (!f.refused && *n_missing)
      *n_missing = make_tris(&f, *n_missing, missing, tri_round[k]);
  if (f.refused) st = vg_fail_memory(err, "boundary recovery");
  VG_CHECK("the recovery of faces by flips", vg_tets_defects(t));
done:
  vg_flip_front_release(&f.front);
  free(f.star);
  free(f.seen);
  free(edge);
  return st;
}
