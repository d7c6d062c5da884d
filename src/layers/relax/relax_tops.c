/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Lowers tops and moves points of the field one after the other, in the order
 * of their columns and of their numbers. Declared in
 * layers/relax/relax_parts.h.
 *
 * A mover is a top, or after the tops a point of the field. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/shape.h"
#include "core/geometry/vector.h"
#include "layers/expand/stack.h"
#include "layers/relax/relax_parts.h"

/* L25 */
#define ROUNDS 6 /* Most sweeps over the tops. */
#define STEPS                                                                  \
  10 /* Heights tried for a column, from the present height down               \
      */
#define LEAST                                                                  \
  0.5 /* to this share of the height after growth. Lower columns               \
         would end with thin layers under large cells. */
#define GAIN                                                                   \
  1.05 /* Least improvement of the worst cell, as the square of a              \
          sine. */

#define LONG 0.25  /* L25: first step of a point, of its shortest edge, */
#define HALVINGS 5 /* and how often it is halved. */

/* A list of items for each mover: items [first[i] .. first[i + 1] - 1]. */
struct lists {
  size_t *first;
  uint32_t *item;
};

struct tops {
  const struct vg_mesh *surface;
  const struct vg_front *front;
  struct vg_columns columns; /* With an own copy of the columns. */
  size_t n_point, n_cell, n_top, n_free;
  uint32_t *id;         /* [n_point] point of the field, ascending. */
  double (*x)[3];       /* [n_point] */
  uint32_t (*cell)[4];  /* [n_cell] points. */
  uint32_t *top;        /* [n_top] column, ascending. */
  uint32_t *top_of;     /* [n_column] index in top, or VG_NO_INDEX. */
  uint32_t *point;      /* [n_top + n_free] point of each mover. */
  const uint32_t *free; /* [n_free] points of the field that may move,
                           ascending; borrowed. */
  double *least;        /* [n_top] least height of the column. */
  struct lists cells, faces;
  struct vg_stack stack;
};

/* --- data ---------------------------------------------------------------- */

static int by_ids(const void *a, const void *b)
{
  const struct vg_relax_cell *s = a, *t = b;

  for (int k = 0; k < 4; k++)
    if (s->id[k] != t->id[k]) return s->id[k] < t->id[k] ? -1 : 1;
  return 0;
}

static int by_value(const void *a, const void *b)
{
  uint32_t s = *(const uint32_t *)a, t = *(const uint32_t *)b;

  return s < t ? -1 : s > t;
}

static uint32_t index_of(const struct tops *t, uint32_t id)
{
  const uint32_t *at = bsearch(&id, t->id, t->n_point, sizeof *t->id, by_value);

  assert(at);
  return (uint32_t)(at - t->id);
}

static vg_status number_points(struct tops *t, size_t n_cell,
                               const struct vg_relax_cell *cell,
                               struct vg_error *err)
{
  size_t n = 0;

  t->n_cell = n_cell;
  t->id = vg_alloc(4 * n_cell, sizeof *t->id);
  t->x = vg_alloc(4 * n_cell, sizeof *t->x);
  t->cell = vg_alloc(n_cell, sizeof *t->cell);
  if (!t->id || !t->x || !t->cell)
    return vg_fail_memory(err, "the cells on the layers");
  for (size_t i = 0; i < 4 * n_cell; i++) t->id[i] = cell[i / 4].id[i % 4];
  if (n_cell) qsort(t->id, 4 * n_cell, sizeof *t->id, by_value);
  for (size_t i = 0; i < 4 * n_cell; i++)
    if (!n || t->id[i] != t->id[n - 1]) t->id[n++] = t->id[i];
  t->n_point = n;
  for (size_t i = 0; i < 4 * n_cell; i++) {
    uint32_t p = index_of(t, cell[i / 4].id[i % 4]);

    t->cell[i / 4][i % 4] = p;
    memcpy(t->x[p], cell[i / 4].x[i % 4], sizeof *t->x);
  }
  return VG_OK;
}

static vg_status list_tops(struct tops *t, const uint8_t *mark,
                           struct vg_error *err)
{
  size_t n_column = t->columns.n_column;

  for (size_t i = 0; i < n_column; i++) t->n_top += mark[i];
  t->top = vg_alloc(t->n_top, sizeof *t->top);
  t->point = vg_alloc(t->n_top + t->n_free, sizeof *t->point);
  t->least = vg_alloc(t->n_top, sizeof *t->least);
  t->top_of = vg_alloc(n_column, sizeof *t->top_of);
  if (!t->top || !t->point || !t->least || !t->top_of)
    return vg_fail_memory(err, "the tops of the layers");
  t->n_top = 0;
  for (size_t i = 0; i < n_column; i++) {
    t->top_of[i] = VG_NO_INDEX;
    if (!mark[i]) continue;
    t->top_of[i] = (uint32_t)t->n_top;
    t->top[t->n_top++] = (uint32_t)i;
  }
  for (size_t i = 0; i < t->n_point; i++) {
    uint32_t c = vg_relax_column_of(t->front, t->id[i]);

    if (c != VG_NO_INDEX && mark[c]) t->point[t->top_of[c]] = (uint32_t)i;
  }
  for (size_t i = 0; i < t->n_free; i++)
    t->point[t->n_top + i] = index_of(t, t->free[i]);
  return VG_OK;
}

/* The lists of the items [n] whose k corners include a mover; mover_at gives
 * the mover at a corner, or VG_NO_INDEX. */
static vg_status make_lists(const struct tops *t, size_t n, int k,
                            uint32_t (*mover_at)(const struct tops *, size_t,
                                                 int),
                            struct lists *out, struct vg_error *err)
{
  const size_t n_mover = t->n_top + t->n_free;
  size_t total = 0;

  out->first = vg_calloc(n_mover + 2, sizeof *out->first);
  if (!out->first) return vg_fail_memory(err, "the tops of the layers");
  for (size_t i = 0; i < n; i++)
    for (int j = 0; j < k; j++) {
      uint32_t m = mover_at(t, i, j);

      if (m != VG_NO_INDEX) out->first[m + 2]++, total++;
    }
  out->item = vg_alloc(total, sizeof *out->item);
  if (!out->item) return vg_fail_memory(err, "the tops of the layers");
  for (size_t i = 0; i < n_mover; i++) out->first[i + 2] += out->first[i + 1];
  for (size_t i = 0; i < n; i++)
    for (int j = 0; j < k; j++) {
      uint32_t m = mover_at(t, i, j);

      if (m != VG_NO_INDEX) out->item[out->first[m + 1]++] = (uint32_t)i;
    }
  return VG_OK;
}

static uint32_t top_of_face(const struct tops *t, size_t f, int k)
{
  return t->top_of[t->columns.face[f][k]];
}

static uint32_t mover_of_cell(const struct tops *t, size_t i, int k)
{
  const uint32_t id = t->id[t->cell[i][k]];
  const uint32_t c = vg_relax_column_of(t->front, id);
  const uint32_t *at;

  if (c != VG_NO_INDEX) return t->top_of[c];
  if (id < t->front->n_point || !t->n_free) return VG_NO_INDEX;
  at = bsearch(&id, t->free, t->n_free, sizeof *t->free, by_value);
  return at ? (uint32_t)(t->n_top + (size_t)(at - t->free)) : VG_NO_INDEX;
}

/* --- moves --------------------------------------------------------------- */

static double shape_of(const struct tops *t, size_t cell)
{
  const uint32_t *v = t->cell[cell];

  return vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);
}

/* Cells at a mover. */
struct quality {
  double least; /* Least shape. */
  size_t n_flat;
};

static struct quality quality_of(const struct tops *t, size_t mover)
{
  struct quality q = { INFINITY, 0 };

  for (size_t i = t->cells.first[mover]; i < t->cells.first[mover + 1]; i++) {
    double shape = shape_of(t, t->cells.item[i]);

    q.least = fmin(q.least, shape);
    q.n_flat += shape < VG_RELAX_FLAT;
  }
  return q;
}

static int is_sound(struct tops *t, size_t top)
{
  uint8_t faulty;

  for (size_t i = t->faces.first[top]; i < t->faces.first[top + 1]; i++)
    if (vg_stack_first_bad(&t->stack, &t->columns, t->surface, t->faces.item[i],
                           &faulty) >= 0)
      return 0;
  return 1;
}

static double height(struct tops *t, size_t top)
{
  const struct vg_column *c = &t->columns.column[t->top[top]];
  double *d = t->stack.d[0];

  vg_growth_law_heights(&t->columns.law[c->law], c->cap, c->n, d);
  return d[c->n];
}

/* Gives a column another cap and moves its top. */
static void set_cap(struct tops *t, size_t top, double cap)
{
  t->columns.column[t->top[top]].cap = cap;
  vg_column_top(&t->columns, t->surface, t->top[top], t->x[t->point[top]]);
}

/* Lowers a column to the height that is best for its worst cell, without making
 * more of its cells flat. */
static int lower(struct tops *t, size_t top)
{
  const struct vg_column *c = &t->columns.column[t->top[top]];
  const struct vg_growth_law *law = &t->columns.law[c->law];
  struct quality before = quality_of(t, top);
  double least = fmax(GAIN * before.least, 0), cap = c->cap, best = cap;
  double h = height(t, top), step = (h - t->least[top]) / STEPS;

  if (!before.n_flat) return 0;
  for (int k = 1; k <= STEPS; k++) {
    double next = vg_growth_law_compress(law, c->n, h - k * step);
    struct quality q;

    if (!(next > 0)) break;
    if (!(next < cap)) continue;
    set_cap(t, top, next);
    q = quality_of(t, top);
    if (!(q.least > least) || q.n_flat > before.n_flat || !is_sound(t, top))
      continue;
    least = q.least;
    best = next;
  }
  set_cap(t, top, best);
  return best < cap;
}

/* Length of the shortest edge of the cells at a point. */
static double shortest(const struct tops *t, size_t mover)
{
  const double *x = t->x[t->point[mover]];
  double least = INFINITY;

  for (size_t i = t->cells.first[mover]; i < t->cells.first[mover + 1]; i++)
    for (int k = 0; k < 4; k++) {
      const uint32_t p = t->cell[t->cells.item[i]][k];

      if (p != t->point[mover]) least = fmin(least, vg_distance(x, t->x[p]));
    }
  return least;
}

/* Moves a point of the field by the step along the axis that is best for its
 * worst cell. Returns 0 if none improves it. */
static int step_point(struct tops *t, size_t mover, double step)
{
  const struct quality before = quality_of(t, mover);
  double *x = t->x[t->point[mover]], least = fmax(GAIN * before.least, 0);
  int best = -1;

  for (int k = 0; k < 6; k++) {
    const double old = x[k / 2];
    struct quality q;

    x[k / 2] += k % 2 ? -step : step;
    q = quality_of(t, mover);
    x[k / 2] = old;
    if (!(q.least > least) || q.n_flat > before.n_flat) continue;
    least = q.least;
    best = k;
  }
  if (best >= 0) x[best / 2] += best % 2 ? -step : step;
  return best >= 0;
}

/* Moves a point of the field to where its worst cell is better. */
static int move_point(struct tops *t, size_t mover)
{
  double step = LONG * shortest(t, mover);
  int moved = 0;

  if (!quality_of(t, mover).n_flat) return 0;
  for (int k = 0; k <= HALVINGS; k++, step /= 2)
    while (step_point(t, mover, step)) moved = 1;
  return moved;
}

static size_t count_flat(const struct tops *t)
{
  size_t n = 0;

  for (size_t i = 0; i < t->n_cell; i++) n += shape_of(t, i) < VG_RELAX_FLAT;
  return n;
}

/* The columns and points that moved. x: [n_free] old coordinates. */
static vg_status list_moves(const struct tops *t, const struct vg_columns *old,
                            const double (*x)[3], struct vg_relax_result *out,
                            struct vg_error *err)
{
  struct vg_relax_move *m = vg_calloc(t->n_top, sizeof *m);
  struct vg_slices_point *q = vg_calloc(t->n_free, sizeof *q);
  struct vg_relax_result r = { 0, 0, m, q };

  if (!m || !q) {
    free(m);
    free(q);
    return vg_fail_memory(err, "the tops of the layers");
  }
  for (size_t i = 0; i < t->n_top; i++) {
    double cap = t->columns.column[t->top[i]].cap;

    if (cap == old->column[t->top[i]].cap) continue;
    m[r.n_move].column = t->top[i];
    m[r.n_move++].cap = cap;
  }
  for (size_t i = 0; i < t->n_free; i++) {
    const double *now = t->x[t->point[t->n_top + i]];

    if (!memcmp(now, x[i], sizeof x[i])) continue;
    q[r.n_point].id = t->free[i];
    memcpy(q[r.n_point++].x, now, sizeof q->x);
  }
  *out = r;
  return VG_OK;
}

static vg_status prepare(struct tops *t, const struct vg_layers *layers,
                         const struct vg_relax_input *in, struct vg_error *err)
{
  size_t n = layers->columns.n_column;
  vg_status st;

  t->n_free = in->n_id;
  t->free = in->id;
  t->columns.column = vg_alloc(n, sizeof *t->columns.column);
  if (!t->columns.column) return vg_fail_memory(err, "the layers");
  if (n)
    memcpy(t->columns.column, layers->columns.column,
           n * sizeof *t->columns.column);
  VG_TRY(number_points(t, in->n_cell, in->cell, err));
  VG_TRY(list_tops(t, in->mark, err));
  VG_TRY(make_lists(t, in->n_cell, 4, mover_of_cell, &t->cells, err));
  st = make_lists(t, t->columns.n_face, 3, top_of_face, &t->faces, err);
done:
  return st;
}

static void release(struct tops *t)
{
  free(t->columns.column);
  free(t->id);
  free(t->x);
  free(t->cell);
  free(t->top);
  free(t->top_of);
  free(t->point);
  free(t->least);
  free(t->cells.first);
  free(t->cells.item);
  free(t->faces.first);
  free(t->faces.item);
  free(t);
}

vg_status vg_relax_tops(const struct vg_mesh *surface,
                        const struct vg_layers *layers,
                        const struct vg_relax_input *in,
                        struct vg_relax_result *out,
                        struct vg_relax_report *report, struct vg_error *err)
{
  struct tops *t = vg_calloc(1, sizeof *t);
  double(*x)[3] = vg_alloc(in->n_id, sizeof *x);
  vg_status st = VG_OK;

  if (!t || !x) VG_TRY(vg_fail_memory(err, "the tops of the layers"));
  t->surface = surface;
  t->front = &layers->front;
  t->columns = layers->columns;
  t->columns.column = NULL;
  if (in->n_cell) qsort(in->cell, in->n_cell, sizeof *in->cell, by_ids);
  VG_TRY(prepare(t, layers, in, err));
  for (size_t i = 0; i < t->n_top; i++) t->least[i] = LEAST * height(t, i);
  for (size_t i = 0; i < t->n_free; i++)
    memcpy(x[i], t->x[t->point[t->n_top + i]], sizeof *x);
  report->n_flat = count_flat(t);
  for (int round = 0, moved = 1; moved && round < ROUNDS; round++) {
    moved = 0;
    for (size_t i = 0; i < t->n_top; i++) moved |= lower(t, i);
    for (size_t i = 0; i < t->n_free; i++) moved |= move_point(t, t->n_top + i);
  }
  report->n_left = count_flat(t);
  VG_TRY(list_moves(t, &layers->columns, (const double(*)[3])x, out, err));
  report->n_column = out->n_move;
  report->n_point = out->n_point;
done:
  free(x);
  if (t) release(t);
  return st;
}
