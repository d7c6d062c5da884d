/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Checks the shape of the cells of all columns. Declared in
 * layers/grow/grow_parts.h. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/team.h"
#include "core/geometry/vector.h"
#include "layers/expand/stack.h"
#include "layers/grow/grow_parts.h"

#define GRAIN 1024
/* L3 */
#define LOWER 0.75        /* Factor on the allowed height at a bad cell. */
#define RESERVE 2.0       /* Multiple of the least height of all levels. */
#define NEAR_FARTHEST 0.5 /* Share of the farthest reach at a bad cell. */

struct search {
  struct vg_layer_work *w;
  const uint8_t *moved;
  int16_t *level;         /* [n_face] first bad level; -1: none. */
  uint8_t *faulty;        /* [n_face] bit k: corner k is at fault. */
  struct vg_stack *stack; /* [worker] scratch. */
};

static void search_body(void *context, size_t first, size_t end, int worker)
{
  struct search *q = context;
  struct vg_stack *s = &q->stack[worker];

  for (size_t f = first; f < end; f++) {
    const uint32_t *c = q->w->c->face[f];

    q->level[f] = -1;
    if (q->moved && !q->moved[c[0]] && !q->moved[c[1]] && !q->moved[c[2]])
      continue;
    q->level[f] = (int16_t)vg_stack_first_bad(s, q->w->c, q->w->m, f,
                                              &q->faulty[f]);
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
