/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Flips that restore Delaunay tetrahedra once all triangles of the surface are
 * recovered. A face is locally Delaunay if the circumsphere of one of its
 * cells does not contain the far corner of the other. Each flip lowers the
 * paraboloid |x|^2 interpolated over the cells. Delaunay tetrahedra minimise
 * it, so the process ends. (B. Joe, "Three-dimensional triangulations from
 * local transformations", SIAM J. Sci. Stat. Comput. 10, 1989.) */
#include "core/recover/recover.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/checks.h"
#include "base/memory.h"
#include "core/delaunay/cavity.h"
#include "core/geometry/predicates.h"
#include "core/geometry/vector.h"

enum { RING = 10, NEW_MAX = 2 * (RING - 2), ROUNDS = 64 };

/* An edge is removed if this lowers the paraboloid by at least this share of
 * its present value. The margin is needed because the sum is not exact. */
static const double gain = 1e-9; /* K3 */

/* Limit of the number of flips: this many per face in the initial list, plus
 * 100. Fronts of aircraft take 0.4 to 0.9 per face, small parts up to 4. Where
 * a whole edge star is flat, the sums consist of rounding errors only, and
 * flips decided by exact signs may undo forever those decided by the sums. The
 * cells at the limit are valid, but not Delaunay. */
static const size_t flips_each = 8;

struct faces {
  size_t n, cap;
  uint32_t *link;
};

struct restorer {
  struct vg_tets *t;
  struct faces next; /* faces to examine in the next round */
  size_t n_flip;
  int refused;
};

static double side(const struct vg_tets *t, uint32_t a, uint32_t b, uint32_t c,
                   uint32_t d)
{
  return vg_orient3d(t->x[a], t->x[b], t->x[c], t->x[d]);
}

static void add(struct restorer *r, uint32_t link)
{
  struct faces *f = &r->next;

  if (vg_reserve(&f->link, &f->cap, f->n + 1, sizeof *f->link)) r->refused = 1;
  else f->link[f->n++] = link;
}

/* Is face i of live cell c not locally Delaunay, and may flips remove it? */
static int is_wrong(const struct vg_tets *t, uint32_t c, int i)
{
  uint32_t link = t->cell[c].link[i];
  const uint32_t *v = t->cell[c].v;

  if (t->flag[c] >> i & 1 || link == VG_NONE) return 0;
  return vg_insphere(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]],
                     t->x[t->cell[link >> 2].v[link & 3]]) > 0;
}

static int replace(struct restorer *r, int n_old, const uint32_t *old,
                   int n_new, const uint32_t (*v)[4])
{
  uint32_t slot[NEW_MAX];

  if (vg_cavity_reserve(r->t, n_old, n_new)) {
    r->refused = 1;
    return 0;
  }
  vg_cavity_refill(r->t, n_old, old, n_new, v, slot);
  for (int k = 0; k < n_new; k++)
    for (uint32_t i = 0; i < 4; i++) add(r, 4 * slot[k] + i);
  r->n_flip++;
  return 1;
}

/* --- the star of an edge -------------------------------------------------- */

struct ring {
  const struct vg_tets *t;
  uint32_t a, b;
  int n;
  uint32_t cell[RING], v[RING]; /* as returned by vg_cavity_ring */
  double cost[RING][RING];      /* cost of the polygon i..j; INFINITY: none
                                   found */
  int split[RING][RING];
};

/* Six times the volume of a cell, times the mean of |x|^2 at its corners
 * (times four), with x relative to the first end of the edge. */
static double lifted(const struct ring *r, uint32_t p, uint32_t q, uint32_t s,
                     uint32_t u)
{
  const uint32_t v[4] = { p, q, s, u };
  const double *o = r->t->x[r->a];
  double e[4][3], sum = 0;

  for (int i = 0; i < 4; i++)
    for (int k = 0; k < 3; k++) {
      e[i][k] = r->t->x[v[i]][k] - o[k];
      sum += e[i][k] * e[i][k];
    }
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++) e[i][k] -= e[3][k];
  return sum * fabs(vg_triple(e[0], e[1], e[2]));
}

static void try_split(struct ring *r, int i, int k, int j)
{
  uint32_t x = r->v[i], y = r->v[k], z = r->v[j];
  double cost = r->cost[i][k] + r->cost[k][j];

  if (!(cost < r->cost[i][j])) return;
  if (!(side(r->t, x, y, z, r->b) > 0) || !(side(r->t, x, z, y, r->a) > 0))
    return;
  cost += lifted(r, x, y, z, r->b) + lifted(r, x, z, y, r->a);
  if (!(cost < r->cost[i][j])) return;
  r->cost[i][j] = cost;
  r->split[i][j] = k;
}

static void plan(struct ring *r)
{
  for (int i = 0; i + 1 < r->n; i++) r->cost[i][i + 1] = 0;
  for (int span = 2; span < r->n; span++)
    for (int i = 0; i + span < r->n; i++) {
      r->cost[i][i + span] = INFINITY;
      for (int k = i + 1; k < i + span; k++) try_split(r, i, k, i + span);
    }
}

static int emit(const struct ring *r, int i, int j, int n, uint32_t (*v)[4])
{
  uint32_t *w;
  int k;

  if (j - i < 2) return n;
  k = r->split[i][j];
  w = v[n++];
  w[0] = r->v[i];
  w[1] = r->v[k];
  w[2] = r->v[j];
  w[3] = r->b;
  w = v[n++];
  w[0] = r->v[i];
  w[1] = r->v[j];
  w[2] = r->v[k];
  w[3] = r->a;
  return emit(r, k, j, emit(r, i, k, n, v), v);
}

/* Remove the edge a b of cell c if this lowers the paraboloid. */
static int remove_edge(struct restorer *f, uint32_t c, uint32_t a, uint32_t b)
{
  struct ring r = { .t = f->t, .a = a, .b = b };
  uint32_t v[NEW_MAX][4];
  double before = 0;

  r.n = vg_cavity_ring(f->t, c, a, b, RING, 0, r.cell, r.v);
  if (r.n < 3) return 0;
  for (int k = 0; k < r.n; k++)
    before += lifted(&r, r.v[k], r.v[(k + 1) % r.n], a, b);
  plan(&r);
  if (!(r.cost[0][r.n - 1] < (1 - gain) * before)) return 0;
  return replace(f, r.n, r.cell, emit(&r, 0, r.n - 1, 0, v),
                 (const uint32_t(*)[4])v);
}

/* --- faces ---------------------------------------------------------------- */

/* Replace two cells by three around the edge between their far corners. If
 * that edge does not pass through the face, try to remove an edge of the face
 * that it passes outside. */
static void restore_face(struct restorer *r, uint32_t c, int i)
{
  const struct vg_tets *t = r->t;
  uint32_t link = t->cell[c].link[i], old[2] = { c, link >> 2 };
  uint32_t a = t->cell[c].v[i], b = t->cell[link >> 2].v[link & 3];
  uint32_t v[3], new[3][4];
  int is_in[3];

  for (int k = 0; k < 3; k++) v[k] = t->cell[c].v[vg_face[i][k]];
  for (int k = 0; k < 3; k++) {
    uint32_t w[4] = { v[k], v[(k + 1) % 3], b, a };

    is_in[k] = side(t, w[0], w[1], w[2], w[3]) > 0;
    memcpy(new[k], w, sizeof w);
  }
  if (is_in[0] && is_in[1] && is_in[2]) {
    replace(r, 2, old, 3, (const uint32_t(*)[4]) new);
    return;
  }
  for (int k = 0; k < 3; k++)
    if (!is_in[k] && remove_edge(r, c, v[k], v[(k + 1) % 3])) return;
}

static int is_as_before(const struct vg_tets *t, size_t n,
                        const struct vg_cell *before, uint32_t c)
{
  return c < n && !memcmp(t->cell[c].v, before[c].v, sizeof before[c].v);
}

/* Faces between unchanged cells need no test. */
static void list_wrong(struct restorer *r, size_t n,
                       const struct vg_cell *before)
{
  const struct vg_tets *t = r->t;

  for (uint32_t c = 0; c < t->n_cell; c++) {
    int is_old = is_as_before(t, n, before, c);

    for (int i = 0; i < 4 && !(t->flag[c] & VG_DEAD); i++) {
      uint32_t other = t->cell[c].link[i] >> 2;

      if (other > c && !(is_old && is_as_before(t, n, before, other)) &&
          is_wrong(t, c, i))
        add(r, 4 * c + (uint32_t)i);
    }
  }
}

vg_status vg_recover_delaunay(struct vg_tets *t, size_t n_before,
                              const struct vg_cell *before, size_t *n_flip,
                              struct vg_error *err)
{
  struct restorer r = { .t = t };
  struct faces now = { 0 };
  size_t limit;

  assert((before || !n_before) && n_flip);
  list_wrong(&r, n_before, before);
  limit = flips_each * r.next.n + 100;
  for (int round = 0; round < ROUNDS && r.next.n && !r.refused; round++) {
    struct faces keep = now;

    now = r.next;
    r.next = keep;
    r.next.n = 0;
    for (size_t k = 0; k < now.n && !r.refused && r.n_flip < limit; k++) {
      uint32_t c = now.link[k] >> 2;
      int i = now.link[k] & 3;

      if (!(t->flag[c] & VG_DEAD) && is_wrong(t, c, i)) restore_face(&r, c, i);
    }
  }
  VG_CHECK("flips towards Delaunay cells", vg_tets_defects(t));
  free(now.link);
  free(r.next.link);
  *n_flip = r.n_flip;
  return r.refused ? vg_fail_memory(err, "boundary recovery") : VG_OK;
}
