/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/optimise/optimise_parts.h"

#include <assert.h>
#include <string.h>

#include "base/memory.h"

int vg_ball(struct vg_optimiser *o, uint32_t p)
{
  assert(p < o->t->n_point);

  struct vg_tets *t = o->t;
  uint32_t c = o->star[p];
  int whole = 1;

  if (c == VG_NONE) return 0;
  o->n_ball = 1;
  for (uint32_t i = 0; i < 4; i++)
    if (t->cell[c].v[i] == p) o->ball[0] = 4 * c + i;
  t->flag[c] |= VG_MARK;
  for (size_t k = 0; k < o->n_ball && whole; k++) {
    uint32_t at = o->ball[k] >> 2, centre = o->ball[k] & 3;

    for (uint32_t i = 0; i < 4; i++) {
      uint32_t link = t->cell[at].link[i], other = link >> 2, j = 0;

      if (i == centre) continue;
      if (link == VG_NONE || t->flag[at] >> i & 1 || o->n_ball == VG_BALL_MAX) {
        whole = 0;
        break;
      }
      if (t->flag[other] & VG_MARK) continue;
      while (t->cell[other].v[j] != p) j++;
      t->flag[other] |= VG_MARK;
      vg_tets_prefetch(t, other);
      o->ball[o->n_ball++] = 4 * other + j;
    }
  }
  for (size_t k = 0; k < o->n_ball; k++)
    t->flag[o->ball[k] >> 2] &= (uint8_t)~VG_MARK;
  return whole;
}

/* --- replacing cells ------------------------------------------------------ */

static int grow_shapes(struct vg_optimiser *o)
{
  size_t n = o->t->cap_cell;

  return vg_reserve(&o->q, &o->cap_q, n, sizeof *o->q) ||
         vg_reserve(&o->failed_cell, &o->cap_failed_cell, n,
                    sizeof *o->failed_cell);
}

/* Steps that failed for a cell may work after a change of its neighbours. In a
 * metric this matters for sheets of flat cells, which disappear one by one. */
static void retry_neighbours(struct vg_optimiser *o, uint32_t c)
{
  for (int i = 0; i < 4; i++) {
    uint32_t link = o->t->cell[c].link[i];

    if (link == VG_NONE || o->q[link >> 2] >= VG_SHAPE_FLAT) continue;
    o->t->flag[link >> 2] &= (uint8_t)~VG_TRIED;
    o->failed_cell[link >> 2] = 0;
  }
}

int vg_replace(struct vg_optimiser *o, int n_old, const uint32_t *old,
               int n_new, const uint32_t (*v)[4], const float *q,
               uint32_t *made)
{
  uint32_t slot[VG_NEW_MAX];

  assert(n_old > 0 && n_old <= VG_OLD_MAX);
  assert(n_new > 0 && n_new <= VG_NEW_MAX);
  if (vg_cavity_reserve(o->t, n_old, n_new) || grow_shapes(o)) {
    o->refused = 1;
    return -1;
  }
  vg_cavity_refill(o->t, n_old, old, n_new, v, slot);
  for (int k = 0; k < n_new; k++) {
    o->q[slot[k]] = q[k];
    vg_changed(o, slot[k]);
    for (int i = 0; i < 4; i++) o->star[v[k][i]] = slot[k];
  }
  for (int k = 0; k < n_new && o->metrics; k++) retry_neighbours(o, slot[k]);
  if (made) memcpy(made, slot, (size_t)n_new * sizeof *slot);
  return 0;
}
