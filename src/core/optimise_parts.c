#include "core/optimise_parts.h"

#include <string.h>

#include "base/memory.h"

int vg_ball(struct vg_optimiser *o, uint32_t p)
{
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
      if (link == VG_NONE || t->flag[at] >> i & 1 ||
          o->n_ball == VG_BALL_MAX) {
        whole = 0;
        break;
      }
      if (t->flag[other] & VG_MARK) continue;
      while (t->cell[other].v[j] != p) j++;
      t->flag[other] |= VG_MARK;
      o->ball[o->n_ball++] = 4 * other + j;
    }
  }
  for (size_t k = 0; k < o->n_ball; k++)
    t->flag[o->ball[k] >> 2] &= (uint8_t)~VG_MARK;
  return whole;
}

int vg_shell(const struct vg_tets *t, uint32_t c, uint32_t a, uint32_t b,
             uint32_t *cell, uint32_t *ring)
{
  uint32_t first = c, from, to;
  int n = 0, i, j, k = 0;
  uint32_t other[2];

  for (i = 0; i < 4; i++)
    if (t->cell[c].v[i] != a && t->cell[c].v[i] != b)
      other[k++] = t->cell[c].v[i];
  from = other[0];
  to = other[1];
  /* turn so that (from, to, a, b) is positive: parity of its order in c */
  {
    uint32_t want[4] = {from, to, a, b};
    int place[4], odd = 0;

    for (i = 0; i < 4; i++)
      for (j = 0; j < 4; j++)
        if (t->cell[c].v[j] == want[i]) place[i] = j;
    for (i = 0; i < 4; i++)
      for (j = i + 1; j < 4; j++) odd ^= place[i] > place[j];
    if (odd) {
      from = other[1];
      to = other[0];
    }
  }
  do {
    const struct vg_cell *at = &t->cell[c];
    uint32_t link;

    if (n == VG_SHELL_MAX) return 0;
    cell[n] = c;
    ring[n++] = from;
    for (i = 0; at->v[i] != from; i++) {}
    if (t->flag[c] >> i & 1) return 0;
    link = at->link[i];
    if (link == VG_NONE) return 0;
    c = link >> 2;
    from = to;
    to = t->cell[c].v[link & 3];
  } while (c != first);
  return n;
}

/* --- replacing cells ----------------------------------------------------- */

struct rim {                 /* a face of the cavity, or a face waiting */
  uint32_t v[3], link;
  uint8_t fixed;
};

static void sorted(const struct vg_cell *c, int i, uint32_t v[3])
{
  uint32_t a = c->v[vg_face[i][0]], b = c->v[vg_face[i][1]];
  uint32_t d = c->v[vg_face[i][2]], keep;

#define ORDER(x, y) if (x > y) { keep = x; x = y; y = keep; }
  ORDER(a, b)
  ORDER(b, d)
  ORDER(a, b)
#undef ORDER
  v[0] = a;
  v[1] = b;
  v[2] = d;
}

static int collect_rim(const struct vg_tets *t, int n_old,
                       const uint32_t *old, struct rim *rim)
{
  int n = 0;

  for (int k = 0; k < n_old; k++)
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[old[k]].link[i];

      if (link != VG_NONE && t->flag[link >> 2] & VG_MARK) continue;
      sorted(&t->cell[old[k]], i, rim[n].v);
      rim[n].link = link;
      rim[n++].fixed = t->flag[old[k]] >> i & 1;
    }
  return n;
}

/* Link face i of new cell c with the rim or with another new cell. */
static void link_face(struct vg_tets *t, uint32_t c, uint32_t i,
                      struct rim *rim, int *n)
{
  uint32_t v[3];

  sorted(&t->cell[c], (int)i, v);
  for (int k = 0; k < *n; k++) {
    if (rim[k].v[0] != v[0] || rim[k].v[1] != v[1] || rim[k].v[2] != v[2])
      continue;
    t->cell[c].link[i] = rim[k].link;
    if (rim[k].link != VG_NONE)
      t->cell[rim[k].link >> 2].link[rim[k].link & 3] = 4 * c + i;
    if (rim[k].fixed) t->flag[c] |= (uint8_t)(1 << i);
    rim[k] = rim[--*n];
    return;
  }
  memcpy(rim[*n].v, v, sizeof v);
  rim[*n].link = 4 * c + i;
  rim[(*n)++].fixed = 0;
}

static int grow_shapes(struct vg_optimiser *o)
{
  size_t n = o->t->cap_cell;

  return vg_reserve(&o->q, &o->cap_q, n, sizeof *o->q) ||
         vg_reserve(&o->vain_cell, &o->cap_vain_cell, n,
                    sizeof *o->vain_cell);
}

int vg_replace(struct vg_optimiser *o, int n_old, const uint32_t *old,
               int n_new, const uint32_t (*v)[4], const float *q,
               uint32_t *made)
{
  struct vg_tets *t = o->t;
  struct rim rim[4 * VG_OLD_MAX + 4 * VG_NEW_MAX];
  uint32_t slot[VG_NEW_MAX];
  int n;

  if (vg_tets_reserve_cells(t, (size_t)n_new) || grow_shapes(o) ||
      vg_reserve(&t->free, &t->cap_free, t->n_free + (size_t)n_old,
                 sizeof *t->free)) {
    o->refused = 1;
    return -1;
  }
  for (int k = 0; k < n_old; k++) t->flag[old[k]] |= VG_MARK;
  n = collect_rim(t, n_old, old, rim);
  for (int k = 0; k < n_new; k++) {
    uint32_t c = slot[k] = k < n_old ? old[k] : vg_tets_take(t);

    memcpy(t->cell[c].v, v[k], sizeof t->cell[c].v);
    t->flag[c] = 0;
    o->q[c] = q[k];
    vg_changed(o, c);
    for (int i = 0; i < 4; i++) o->star[v[k][i]] = c;
  }
  for (int k = 0; k < n_new; k++)
    for (uint32_t i = 0; i < 4; i++) link_face(t, slot[k], i, rim, &n);
  for (int k = n_new; k < n_old; k++) vg_tets_drop(t, old[k]);
  if (made) memcpy(made, slot, (size_t)n_new * sizeof *slot);
  return 0;
}
