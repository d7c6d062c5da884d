/* Checks the shape of the cells of all columns. Declared in
 * layers/grow/grow_parts.h. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/team.h"
#include "core/geometry/vector.h"
#include "layers/expand/join.h"
#include "layers/grow/grow_parts.h"

#define GRAIN 1024
/* L3: least sine between a column and a layer. */
#define FLAT (0.25 * VG_VISIBILITY_MIN)
/* Least area of a layer, relative to its area at the wall. */
#define SHRUNK 0.04
#define LOWER 0.75        /* Factor on the allowed height at a bad cell. */
#define RESERVE 2.0       /* Multiple of the least height of all levels. */
#define NEAR_FARTHEST 0.5 /* Share of the farthest reach at a bad cell. */

/* The face of one call: three columns with ascending levels. */
struct stack {
  const struct vg_column *c[3];
  int order[3]; /* Corners by increasing column number. */
  double d[3][VG_LEVELS_MAX + 1];
  double x[3][VG_LEVELS_MAX + 1][3];
};

struct search {
  struct vg_layer_work *w;
  const uint8_t *moved;
  int16_t *level;      /* [n_face] first bad level; -1: none. */
  uint8_t *faulty;     /* [n_face] bit k: corner k is at fault. */
  struct stack *stack; /* [worker] scratch. */
};

static int positive(double det, double area2, const double up[3])
{
  return det > 0 && det * det >= FLAT * FLAT * area2 * vg_dot(up, up);
}

static int same_point(const struct stack *s, int a, int la, int b, int lb)
{
  return la == 0 && lb == 0 && s->c[a]->root == s->c[b]->root;
}

/* Tests tetrahedron (p at l, p at l + 1, q, r at their levels), where q and r
 * follow p around the face. Tetrahedra with a repeated point do not exist and
 * count as valid. */
static int lifted(const struct stack *s, int p, int l, int lq, int lr)
{
  int q = (p + 1) % 3, r = (p + 2) % 3;
  const double *o = s->x[p][l];
  double a[3], b[3], up[3], n[3];

  if (same_point(s, p, l, q, lq) || same_point(s, p, l, r, lr) ||
      same_point(s, q, lq, r, lr))
    return 1;
  vg_sub(s->x[q][lq], o, a);
  vg_sub(s->x[r][lr], o, b);
  vg_sub(s->x[p][l + 1], o, up);
  vg_cross(a, b, n);
  return positive(vg_dot(n, up), vg_dot(n, n), up);
}

/* Tests all cells raised from level l by the lift rule. */
static int lifts(const struct stack *s, int l)
{
  int at[3];

  for (int k = 0; k < 3; k++) at[k] = l < s->c[k]->n ? l : s->c[k]->n;
  for (int i = 0; i < 3; i++) {
    int p = s->order[i], q = (p + 1) % 3, r = (p + 2) % 3;

    if (l >= s->c[p]->n) continue;
    if (!lifted(s, p, l, at[q], at[r])) return 0;
    at[p]++;
  }
  return 1;
}

/* The first and the last of the three tetrahedra of a prism are among its
 * corner tetrahedra; this is the one between them. */
static int middle(const struct stack *s, int l)
{
  int p = s->order[1], q = (p + 1) % 3, r = (p + 2) % 3;

  return lifted(s, p, l, l + (q == s->order[0]), l + (r == s->order[0]));
}

static void area(const struct stack *s, int l, double n[3])
{
  double a[3], b[3];

  vg_sub(s->x[1][l], s->x[0][l], a);
  vg_sub(s->x[2][l], s->x[0][l], b);
  vg_cross(a, b, n);
}

/* Tests the corner tetrahedra of the prism between l and l + 1; returns the bad
 * corners. */
static int corners(const struct stack *s, int l, const double low[3],
                   const double high[3])
{
  double a = vg_dot(low, low), b = vg_dot(high, high);
  int bad = 0;

  for (int k = 0; k < 3; k++) {
    double up[3];

    vg_sub(s->x[k][l + 1], s->x[k][l], up);
    if (!positive(vg_dot(low, up), a, up) || !positive(vg_dot(high, up), b, up))
      bad |= 1 << k;
  }
  return bad;
}

static int is_virtual(const struct stack *s)
{
  return s->c[0]->root == s->c[1]->root || s->c[1]->root == s->c[2]->root ||
         s->c[2]->root == s->c[0]->root;
}

/* Tests the pyramid on the quadrilateral of the two columns other than corner
 * k, which are raised from l: all four of its corner volumes. Its apex is the
 * top of column k, which may be lower than l. */
static int pyramid(const struct stack *s, int l, int k)
{
  int p = (k + 1) % 3, q = (k + 2) % 3;
  const double *apex = s->x[k][s->c[k]->n];
  const double *ring[4] = { s->x[p][l], s->x[q][l], s->x[q][l + 1],
                            s->x[p][l + 1] };

  if (l == 0 && is_virtual(s)) return 1; /* See wall_cells(). */
  for (int i = 0; i < 4; i++)
    if (!(vg_det(ring[i], ring[(i + 1) % 4], apex, ring[(i + 3) % 4]) > 0))
      return 0;
  return 1;
}

/* At the wall, mixed output makes other cells on faces at a fan than the lift
 * rule. */
static int wall_cells(const struct stack *s, const struct vg_columns *c,
                      size_t f)
{
  struct vg_wall_cell cell[3];
  int n, fan = 0;

  for (int k = 0; k < 3; k++) fan |= vg_shares_root(c, c->face[f][k]);
  n = fan ? vg_join_wall_cells(c, f, cell) : 0;
  for (int i = 0; i < n; i++) {
    static const int8_t corner[3][6][4] = {
      { { 0, 1, 2, 3 } },
      { { 0, 1, 2, 3 }, { 1, 4, 2, 0 }, { 4, 3, 2, 1 }, { 3, 0, 2, 4 } },
      { { 0, 1, 2, 3 },
        { 1, 2, 0, 4 },
        { 2, 0, 1, 5 },
        { 3, 5, 4, 0 },
        { 4, 3, 5, 1 },
        { 5, 4, 3, 2 } }
    };
    static const int n_corner[3] = { 1, 4, 6 };
    int kind = cell[i].n_node - 4;

    for (int j = 0; j < n_corner[kind]; j++) {
      const double *x[4];

      for (int m = 0; m < 4; m++) {
        int node = (int)cell[i].node[corner[kind][j][m]];

        x[m] = node < 3 ? s->x[node][0] : s->x[node - 3][1];
      }
      if (!(vg_det(x[0], x[1], x[2], x[3]) > 0)) return 0;
    }
  }
  return 1;
}

/* First level below a bad cell, or -1. */
static int first_bad(const struct stack *s, uint8_t *faulty)
{
  int whole = s->c[0]->n, most = whole, from = is_virtual(s);
  double base[3], low[3], high[3];

  for (int k = 1; k < 3; k++) {
    if (s->c[k]->n < whole) whole = s->c[k]->n;
    if (s->c[k]->n > most) most = s->c[k]->n;
  }
  area(s, from <= whole ? from : 0, base);
  memcpy(low, base, sizeof low);
  *faulty = 7;
  for (int l = 0; l < whole; l++) {
    int bad = 0;

    if (l >= from) {
      area(s, l + 1, high);
      bad = corners(s, l, low, high);
      if (vg_dot(high, base) < SHRUNK * vg_dot(base, base)) bad = 7;
      memcpy(low, high, sizeof low);
    }
    if (!bad && !(l < from ? lifts(s, l) : middle(s, l))) bad = 7;
    if (!bad) continue;
    if (l == 0) *faulty = (uint8_t)bad;
    return l;
  }
  for (int l = whole; l < most; l++) {
    if (!lifts(s, l)) return l;
    for (int k = 0; k < 3; k++)
      if (s->c[k]->n <= l && s->c[(k + 1) % 3]->n > l &&
          s->c[(k + 2) % 3]->n > l && !pyramid(s, l, k))
        return l;
  }
  return -1;
}

static void load(struct stack *s, const struct vg_layer_work *w, size_t f)
{
  const uint32_t *face = w->c->face[f];

  for (int k = 0; k < 3; k++) {
    s->c[k] = &w->c->column[face[k]];
    s->order[k] = k;
    vg_column_points(w->c, w->m, face[k], s->d[k], s->x[k]);
  }
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < 2; k++)
      if (face[s->order[k]] > face[s->order[k + 1]]) {
        int swap = s->order[k];

        s->order[k] = s->order[k + 1];
        s->order[k + 1] = swap;
      }
}

static void search_body(void *context, size_t first, size_t end, int worker)
{
  struct search *q = context;
  struct stack *s = &q->stack[worker];

  for (size_t f = first; f < end; f++) {
    const uint32_t *c = q->w->c->face[f];

    q->level[f] = -1;
    if (q->moved && !q->moved[c[0]] && !q->moved[c[1]] && !q->moved[c[2]])
      continue;
    load(s, q->w, f);
    q->level[f] = (int16_t)first_bad(s, &q->faulty[f]);
    if (q->level[f] && !wall_cells(s, q->w->c, f)) {
      q->level[f] = 0;
      q->faulty[f] = 7;
    }
  }
}

/* A cell that fails at some height will fail there regardless of the number of
 * layers below. Therefore the columns at fault that reach farthest are lowered,
 * and not a column that is already low. A cell that fails at the wall itself
 * leaves no height at all. least: [3] out, INFINITY for columns that are not
 * lowered. */
static void limits(const struct vg_layer_work *w, const uint32_t face[3],
                   int level, int faulty, double least[3])
{
  double reach[3] = { 0, 0, 0 }, far = 0;

  for (int k = 0; k < 3; k++) {
    const struct vg_column *c = &w->c->column[face[k]];
    double d[VG_LEVELS_MAX + 1];
    int top = level + 1 < c->n ? level + 1 : c->n;

    least[k] = level && !w->last_resort ? INFINITY : 0;
    if (least[k] == 0 || !(faulty >> k & 1)) continue;
    vg_growth_law_heights(&w->c->law[c->law], c->cap, top, d);
    least[k] = fmin(LOWER * w->allowed[face[k]], d[top]);
    reach[k] = d[top] * vg_norm(c->dir);
    far = fmax(far, reach[k]);
  }
  for (int k = 0; k < 3; k++)
    if (!(faulty >> k & 1) || reach[k] < NEAR_FARTHEST * far)
      least[k] = INFINITY;
}

/* Whether lowering to these limits would cost levels. */
static int costs_levels(const struct vg_layer_work *w, const uint32_t face[3],
                        const double limit[3])
{
  for (int k = 0; k < 3; k++) {
    const struct vg_column *c = &w->c->column[face[k]];

    if (limit[k] < RESERVE * c->n_wanted * w->c->law[c->law].delta1) return 1;
  }
  return 0;
}

/* A column gets the least of the limits of its bad faces, not their product.
 * turn: [n_face] out, 1 for faces whose columns are turned instead. */
static void judge(struct vg_layer_work *w, const struct search *q, int may_turn,
                  double *least, uint8_t *turn, size_t *n_bad, size_t *n_turn)
{
  for (size_t i = 0; i < w->c->n_column; i++) least[i] = INFINITY;
  for (size_t f = 0; f < w->c->n_face; f++) {
    const uint32_t *face = w->c->face[f];
    double l[3];

    turn[f] = 0;
    if (q->level[f] < 0) continue;
    ++*n_bad;
    limits(w, face, q->level[f], q->faulty[f], l);
    if (may_turn && q->level[f] > 0 && costs_levels(w, face, l)) {
      turn[f] = 1;
      ++*n_turn;
    } else {
      for (int k = 0; k < 3; k++) least[face[k]] = fmin(least[face[k]], l[k]);
    }
  }
}

/* Faces whose columns could not be turned are lowered after all. The columns of
 * every bad face are marked as turned, so that the face is tested again. */
static void lower_unturned(const struct vg_layer_work *w,
                           const struct search *q, const uint8_t *turn,
                           uint8_t *turned, double *least)
{
  for (size_t f = 0; f < w->c->n_face; f++) {
    const uint32_t *face = w->c->face[f];
    double l[3];

    if (!turn[f] || turned[face[0]] || turned[face[1]] || turned[face[2]])
      continue;
    limits(w, face, q->level[f], q->faulty[f], l);
    for (int k = 0; k < 3; k++) least[face[k]] = fmin(least[face[k]], l[k]);
  }
  for (size_t f = 0; f < w->c->n_face; f++)
    for (int k = 0; q->level[f] >= 0 && k < 3; k++)
      turned[w->c->face[f][k]] = 1;
}

static vg_status search_all(const struct vg_layer_work *w, struct search *q,
                            int threads, struct vg_error *err)
{
  const struct vg_team_out out[] = { { q->level, sizeof *q->level, 0, NULL },
                                     { q->faulty, sizeof *q->faulty, 0,
                                       NULL } };

  return vg_team_for(w->o->team, threads, w->c->n_face, GRAIN, search_body, q,
                     sizeof out / sizeof *out, out, err);
}

vg_status vg_cells_lower(struct vg_layer_work *w, const uint8_t *moved,
                         int may_turn, uint8_t *turned, size_t *n_bad,
                         struct vg_error *err)
{
  assert(n_bad && (turned || !may_turn));

  size_t n = w->c->n_face, n_turn = 0;
  int threads = w->o->threads > 0 ? w->o->threads : vg_cores();
  struct search q = { w, moved, vg_alloc(n, sizeof *q.level), vg_alloc(n, 1),
                      vg_alloc((size_t)threads, sizeof *q.stack) };
  double *least = vg_alloc(w->c->n_column, sizeof *least);
  uint8_t *turn = vg_alloc(n, 1);
  vg_status st = VG_OK;

  *n_bad = 0;
  if (!q.level || !q.faulty || !q.stack || !least || !turn) {
    st = vg_fail_memory(err, "the layers");
    goto done;
  }
  VG_TRY(search_all(w, &q, threads, err));
  judge(w, &q, may_turn, least, turn, n_bad, &n_turn);
  if (n_turn) VG_TRY(vg_directions_even(w, turn, turned, err));
  lower_unturned(w, &q, turn, turned, least);
  for (size_t i = 0; i < w->c->n_column; i++)
    vg_heights_lower(w, i, least[i], VG_CAUSE_CELL);
done:
  free(least);
  free(turn);
  free(q.level);
  free(q.faulty);
  free(q.stack);
  return st;
}
