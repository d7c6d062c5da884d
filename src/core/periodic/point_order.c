/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Order of the points of periodic patches. Declared in
 * core/periodic/periodic.h. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/periodic/periodic.h"

/* Sorts points by the first point of which they are images, and the images of
 * one point by the pairs that lead to them: bit i is set for images by pair
 * i. */
struct place {
  uint32_t leader, point;
  uint64_t pairs;
};

static int by_leader(const void *a, const void *b)
{
  const struct place *p = a, *q = b;

  if (p->leader != q->leader) return p->leader < q->leader ? -1 : 1;
  if (p->pairs != q->pairs) return p->pairs < q->pairs ? -1 : 1;
  return p->point < q->point ? -1 : p->point > q->point;
}

/* One pass over a pair; returns the number of leaders that changed. */
static size_t lead(const struct vg_periodic_match *match, size_t n_point,
                   struct place *place)
{
  size_t n = 0;

  for (size_t i = 0; i < n_point; i++) {
    const uint32_t j = match->point[i];
    struct place *a = &place[i], *b = j == VG_PERIODIC_NONE ? a : &place[j];

    if (a->leader == b->leader) continue;
    if (a->leader < b->leader) b->leader = a->leader;
    else a->leader = b->leader;
    n++;
  }
  return n;
}

static void find_leaders(size_t n, const struct vg_periodic_match *match,
                         size_t n_point, struct place *place)
{
  size_t n_changed;

  for (uint32_t i = 0; i < n_point; i++) place[i] = (struct place){ i, i, 0 };
  do {
    n_changed = 0;
    for (size_t p = 0; p < n; p++) n_changed += lead(&match[p], n_point, place);
  } while (n_changed);
  for (size_t p = 0; p < n && p < 64; p++)
    for (size_t i = 0; i < n_point; i++) {
      const uint32_t j = match[p].point[i];

      if (j != VG_PERIODIC_NONE && j != i) place[j].pairs |= (uint64_t)1 << p;
    }
}

vg_status vg_periodic_order(struct vg_mesh *m, size_t n,
                            const struct vg_periodic_match *match,
                            int *is_changed, struct vg_error *err)
{
  struct place *place = vg_alloc(m->n_point, sizeof *place);
  double(*x)[3] = vg_alloc(m->n_point, sizeof *x);
  uint32_t *to = vg_alloc(m->n_point, sizeof *to);
  vg_status st = VG_OK;

  assert(!m->n_tet && !m->n_sheet_tri);
  *is_changed = 0;
  if (!place || !x || !to) VG_TRY(vg_fail_memory(err, "the periodic patches"));
  find_leaders(n, match, m->n_point, place);
  qsort(place, m->n_point, sizeof *place, by_leader);
  memcpy(x, m->point, m->n_point * sizeof *x);
  for (uint32_t i = 0; i < m->n_point; i++) {
    const uint32_t from = place[i].point;

    *is_changed |= from != i;
    to[from] = i;
    memcpy(m->point[i], x[from], sizeof x[from]);
  }
  for (size_t i = 0; i < 3 * m->n_tri; i++)
    m->tri[i / 3][i % 3] = to[m->tri[i / 3][i % 3]];
  for (size_t i = 0; i < 4 * m->n_quad; i++)
    m->quad[i / 4][i % 4] = to[m->quad[i / 4][i % 4]];
done:
  free(place);
  free(x);
  free(to);
  return st;
}
