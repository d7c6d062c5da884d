/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/recover/recover_flip.h"

#include <assert.h>
#include <limits.h>

#include "core/delaunay/cavity.h"
#include "core/geometry/shape.h"

enum { NEW_MAX = 2 * VG_FLIP_RING };

struct ring {
  uint32_t a, b;
  int n;
  uint32_t cell[VG_FLIP_RING]; /* cell k has the corners a, b, v[k], v[k + 1] */
  uint32_t v[VG_FLIP_RING];    /* (v[k], v[k + 1], a, b) is positive */
};

struct change { /* cells to remove, cells to add */
  int n_old, n_new;
  const uint32_t *old;
  uint32_t v[NEW_MAX][4];
};

/* --- replacing cells ------------------------------------------------------ */

/* Mark faces between new cells that are triangles of the front as fixed. */
static void fix_inside(struct vg_flipper *f, int n, const uint32_t *slot)
{
  struct vg_tets *t = f->t;

  for (int k = 0; k < n; k++) t->flag[slot[k]] |= VG_MARK;
  for (int k = 0; k < n; k++)
    for (int i = 0; i < 4; i++) {
      uint32_t link = t->cell[slot[k]].link[i], v[3];

      if (link == VG_NONE || !(t->flag[link >> 2] & VG_MARK)) continue;
      vg_cavity_face(&t->cell[slot[k]], i, v);
      if (vg_flip_is_tri(&f->front, v)) t->flag[slot[k]] |= (uint8_t)(1 << i);
    }
  for (int k = 0; k < n; k++) t->flag[slot[k]] &= (uint8_t)~VG_MARK;
}

static int replace(struct vg_flipper *f, const struct change *g)
{
  uint32_t slot[NEW_MAX];

  if (vg_cavity_reserve(f->t, g->n_old, g->n_new)) {
    f->refused = 1;
    return 0;
  }
  vg_cavity_refill(f->t, g->n_old, g->old, g->n_new, (const uint32_t(*)[4])g->v,
                   slot);
  for (int k = 0; k < g->n_new; k++)
    for (int i = 0; i < 4; i++) f->star[g->v[k][i]] = slot[k];
  fix_inside(f, g->n_new, slot);
  f->n_change++;
  return 1;
}

static void add_cell(struct change *g, uint32_t a, uint32_t b, uint32_t c,
                     uint32_t d)
{
  uint32_t *v = g->v[g->n_new++];

  v[0] = a;
  v[1] = b;
  v[2] = c;
  v[3] = d;
}

static double side(const struct vg_tets *t, uint32_t a, uint32_t b, uint32_t c,
                   uint32_t d)
{
  return vg_orient3d(t->x[a], t->x[b], t->x[c], t->x[d]);
}

/* --- face removal --------------------------------------------------------- */

int vg_flip_face(struct vg_flipper *f, uint32_t c, int i)
{
  assert(c < f->t->n_cell && i >= 0 && i < 4);
  assert(!(f->t->flag[c] & VG_DEAD));

  const struct vg_tets *t = f->t;
  uint32_t link = t->cell[c].link[i], old[2] = { c, link >> 2 }, v[3], a, b;
  struct change g = { .n_old = 2, .old = old };
  int before, after;

  if (link == VG_NONE || t->flag[c] >> i & 1) return 0;
  a = t->cell[c].v[i];
  b = t->cell[old[1]].v[link & 3];
  for (int k = 0; k < 3; k++) v[k] = t->cell[c].v[vg_face[i][k]];
  for (int k = 0; k < 3; k++) {
    if (!(side(t, v[k], v[(k + 1) % 3], b, a) > 0)) return 0;
    add_cell(&g, v[k], v[(k + 1) % 3], b, a);
  }
  before = vg_flip_obstructs(f, v[0], v[1], v[2]);
  after = vg_flip_pierces(f, a, b);
  for (int k = 0; k < 3; k++) after += vg_flip_obstructs(f, a, b, v[k]);
  return after < before && replace(f, &g);
}

/* --- the star of an edge -------------------------------------------------- */

static int in_the_way(const struct vg_flipper *f, const struct ring *r)
{
  int n = vg_flip_pierces(f, r->a, r->b);

  for (int k = 0; k < r->n && f->n_target == 2; k++)
    n += vg_flip_obstructs(f, r->a, r->b, r->v[k]);
  return n;
}

/* --- triangulation of the polygon around the edge ------------------------- */

struct plan {
  const struct vg_flipper *f;
  const struct ring *r;
  int most;                             /* largest number of obstructions
                                           allowed */
  int cost[VG_FLIP_RING][VG_FLIP_RING]; /* obstructions of polygon i..j;
                                           INT_MAX: not possible */
  double worst[VG_FLIP_RING][VG_FLIP_RING];
  int split[VG_FLIP_RING][VG_FLIP_RING];
};

/* Number of obstructions caused by the chord i j, whose ends are not
 * neighbours. */
static int cost_of_chord(const struct plan *p, int i, int j)
{
  const struct ring *r = p->r;

  return vg_flip_pierces(p->f, r->v[i], r->v[j]) +
         vg_flip_obstructs(p->f, r->v[i], r->v[j], r->a) +
         vg_flip_obstructs(p->f, r->v[i], r->v[j], r->b);
}

/* Shape of the worse of the two cells on triangle i k j; 0 if one of them is
 * not positive. */
static double shape_at(const struct plan *p, int i, int k, int j)
{
  const struct vg_tets *t = p->f->t;
  const struct ring *r = p->r;
  const double *x = t->x[r->v[i]], *y = t->x[r->v[k]], *z = t->x[r->v[j]];
  const double *a = t->x[r->a], *b = t->x[r->b];
  double lo, hi;

  if (!(vg_orient3d(x, y, z, b) > 0) || !(vg_orient3d(x, z, y, a) > 0))
    return 0;
  lo = vg_shape(x, y, z, b);
  hi = vg_shape(x, z, y, a);
  if (hi < lo) lo = hi;
  return lo > 1e-300 ? lo : 1e-300;
}

/* Try the triangulation of polygon i..j by triangle i k j and the polygons
 * i..k and k..j. */
static void try_split(struct plan *p, int i, int k, int j, int chord)
{
  const struct ring *r = p->r;
  int cost;
  double worst;

  if (p->cost[i][k] == INT_MAX || p->cost[k][j] == INT_MAX) return;
  cost = p->cost[i][k] + p->cost[k][j] + chord;
  if (cost > p->most || cost > p->cost[i][j]) return;
  worst = shape_at(p, i, k, j);
  if (!(worst > 0)) return;
  cost += vg_flip_obstructs(p->f, r->v[i], r->v[k], r->v[j]);
  if (p->worst[i][k] < worst) worst = p->worst[i][k];
  if (p->worst[k][j] < worst) worst = p->worst[k][j];
  if (cost > p->most || cost > p->cost[i][j] ||
      (cost == p->cost[i][j] && worst <= p->worst[i][j]))
    return;
  p->cost[i][j] = cost;
  p->worst[i][j] = worst;
  p->split[i][j] = k;
}

/* For every sub-polygon, find the triangulation with the fewest obstructions,
 * and among those the one with the best shape. is_ear: the last corner must be
 * an ear. */
static int make_plan(struct plan *p, int is_ear)
{
  int n = p->r->n;

  for (int i = 0; i + 1 < n; i++) {
    p->cost[i][i + 1] = 0;
    p->worst[i][i + 1] = 1;
  }
  for (int span = 2; span < n; span++)
    for (int i = 0; i + span < n; i++) {
      int j = i + span, root = span == n - 1, chord = 0;

      p->cost[i][j] = INT_MAX;
      p->worst[i][j] = 0;
      if (!root) chord = cost_of_chord(p, i, j);
      if (is_ear && j == n - 1 && !root) continue;
      for (int k = root && is_ear ? j - 1 : i + 1; k < j; k++)
        try_split(p, i, k, j, chord);
    }
  return p->cost[0][n - 1] != INT_MAX;
}

static void emit(const struct plan *p, struct change *g, int i, int j)
{
  const struct ring *r = p->r;
  int k;

  if (j - i < 2) return;
  k = p->split[i][j];
  add_cell(g, r->v[i], r->v[k], r->v[j], r->b);
  add_cell(g, r->v[i], r->v[j], r->v[k], r->a);
  emit(p, g, i, k);
  emit(p, g, k, j);
}

/* Rotate the ring so that `ear` becomes its last corner. */
static int turn_ring(struct ring *r, uint32_t ear)
{
  struct ring old = *r;
  int at = 0;

  while (at < r->n && old.v[at] != ear) at++;
  if (at == r->n) return 0;
  for (int k = 0; k < r->n; k++) {
    r->v[k] = old.v[(at + 1 + k) % r->n];
    r->cell[k] = old.cell[(at + 1 + k) % r->n];
  }
  return 1;
}

/* --- edge removal --------------------------------------------------------- */

/* ear: VG_NONE, or a corner of the ring that only one triangle may use. gain:
 * required reduction of the number of obstructions. */
struct removal {
  uint32_t a, b, ear;
  int depth, gain;
};

static int remove_edge(struct vg_flipper *f, uint32_t c,
                       const struct removal *m);

/* A cell of the former star that still has the edge. Only the cells next to
 * the removed corner are gone, unless other edges were removed before. */
static uint32_t still_there(const struct vg_tets *t, const struct ring *r)
{
  for (int k = 0; k < r->n; k++) {
    uint32_t c = r->cell[k];
    int n = 0;

    for (int i = 0; i < 4 && !(t->flag[c] & VG_DEAD); i++)
      n += t->cell[c].v[i] == r->a || t->cell[c].v[i] == r->b;
    if (n == 2) return c;
  }
  return VG_NONE;
}

/* Reduce the ring by a corner whose edge to a or b can be removed. This helps
 * if the neighbours of the corner do not see each other past that edge.
 * Changes remain even if the edge a b cannot be removed then: another attempt
 * will find different cells, which succeeds more often than undoing the
 * changes. */
static int reduce_ring(struct vg_flipper *f, const struct ring *r,
                       const struct removal *m)
{
  const struct vg_tets *t = f->t;
  size_t before = f->n_change;

  for (int k = 0; k < r->n; k++) {
    uint32_t p = r->v[k], from = r->v[(k + r->n - 1) % r->n];
    uint32_t to = r->v[(k + 1) % r->n];

    for (int end = 0; end < 2 && p != m->ear; end++) {
      uint32_t q = end ? r->b : r->a, c;
      struct removal sub = { p, q, end ? r->a : r->b, m->depth - 1, 0 };
      double see = end ? side(t, from, p, to, q) : side(t, from, to, p, q);
      int is_gone = see <= 0 && remove_edge(f, r->cell[k], &sub);

      if (!is_gone && f->n_change == before) continue;
      c = is_gone ? still_there(t, r) : VG_NONE;
      return c != VG_NONE && remove_edge(f, c, m);
    }
  }
  return 0;
}

/* Returns 1 if the edge was removed. */
static int remove_edge(struct vg_flipper *f, uint32_t c,
                       const struct removal *m)
{
  struct ring r = { .a = m->a, .b = m->b };
  struct plan p = { .f = f, .r = &r };
  struct change g = { .n_old = 0 };

  if (f->budget <= 0 || vg_flip_edge_at(&f->front, m->a, m->b) != VG_NONE)
    return 0;
  f->budget--;
  r.n = vg_cavity_ring(f->t, c, m->a, m->b, VG_FLIP_RING, 1, r.cell, r.v);
  if (!r.n) return 0;
  if (m->ear != VG_NONE && !turn_ring(&r, m->ear)) return 0;
  p.most = in_the_way(f, &r) - m->gain;
  if (p.most >= 0 && make_plan(&p, m->ear != VG_NONE)) {
    g.old = r.cell;
    g.n_old = r.n;
    emit(&p, &g, 0, r.n - 1);
    return replace(f, &g);
  }
  return m->depth > 0 && r.n > 3 && reduce_ring(f, &r, m);
}

int vg_flip_edge(struct vg_flipper *f, uint32_t c, uint32_t a, uint32_t b,
                 int depth)
{
  assert(c < f->t->n_cell && a != b && depth >= 0);
  assert(!(f->t->flag[c] & VG_DEAD));

  struct removal m = { a, b, VG_NONE, depth, 1 };
  size_t before = f->n_change;

  return remove_edge(f, c, &m) || f->n_change > before;
}
