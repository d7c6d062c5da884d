/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Points adjacent to interface points: these have moved, so the adjacent
 * points get another sweep. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/delaunay/tets.h"
#include "partition/repair/repair_parts.h"

struct strip {
  const struct vg_piece *q;
  const struct vg_sizing *sizing;
  size_t n_hit;
  const uint32_t *hit;   /* [n_hit] Cells with a corner on an interface. */
  const uint8_t *shared; /* [q.n_point] Points that stay, or NULL: none. */
  uint8_t *moves;        /* [q.n_in + q.n_point] 1: may move. */
  size_t n;
  uint32_t *point;            /* [n] Points that may move. */
  struct vg_tets t;           /* Cells around them, without links; x is q's. */
  struct vg_metrics *metrics; /* Of the corners of the cells, or NULL. */
  size_t cap_flag, cap_on;
  float *shape, *old; /* [t.n_cell] Now, before. */
  uint8_t *on;        /* [t.n_cell] 1: has a corner on an interface. */
};

static vg_status find_points(struct strip *s)
{
  const struct vg_piece *q = s->q;

  s->t.n_point = q->n_in + q->n_point;
  s->t.x = q->x;
  s->moves = vg_calloc(s->t.n_point, 1);
  s->point = vg_alloc(q->n_point, sizeof *s->point);
  if (!s->moves || !s->point) return VG_ERR_MEMORY;
  for (size_t k = 0; k < s->n_hit; k++) {
    uint32_t v[4];

    vg_piece_cell(q, s->hit[k], v);
    for (int i = 0; i < 4; i++)
      s->moves[v[i]] = v[i] >= q->n_in &&
                       !(s->shared && s->shared[v[i] - q->n_in]);
  }
  for (size_t v = q->n_in; v < s->t.n_point; v++)
    if (s->moves[v]) s->point[s->n++] = (uint32_t)v;
  return VG_OK;
}

static int add_cell(struct strip *s, const uint32_t *v, int on)
{
  size_t n = s->t.n_cell;

  if (vg_reserve(&s->t.cell, &s->t.cap_cell, n + 1, sizeof *s->t.cell) ||
      vg_reserve(&s->t.flag, &s->cap_flag, n + 1, 1) ||
      vg_reserve(&s->on, &s->cap_on, n + 1, 1))
    return -1;
  memcpy(s->t.cell[n].v, v, sizeof s->t.cell->v);
  s->t.flag[n] = 0;
  s->on[n] = (uint8_t)on;
  s->t.n_cell++;
  return 0;
}

static vg_status take_cells(struct strip *s)
{
  const struct vg_piece *q = s->q;
  size_t k = 0;

  for (size_t c = 0; c < q->n_cell; c++) {
    uint32_t v[4];

    vg_piece_cell(q, c, v);
    while (k < s->n_hit && s->hit[k] < c) k++;
    if ((s->moves[v[0]] | s->moves[v[1]] | s->moves[v[2]] | s->moves[v[3]]) &&
        add_cell(s, v, k < s->n_hit && s->hit[k] == c))
      return VG_ERR_MEMORY;
  }
  return VG_OK;
}

static vg_status find_shapes(struct strip *s)
{
  s->shape = vg_alloc(s->t.n_cell, sizeof *s->shape);
  s->old = vg_alloc(s->t.n_cell, sizeof *s->old);
  if (!s->shape || !s->old ||
      vg_metrics_of_corners(s->sizing, &s->t, &s->metrics) < 0)
    return VG_ERR_MEMORY;
  for (size_t c = 0; c < s->t.n_cell; c++)
    s->old[c] = s->shape[c] = (float)vg_cell_shape(s->metrics, &s->t,
                                                   s->t.cell[c].v);
  return VG_OK;
}

/* Lists cells that got worse away from the interface, where no other step
 * detects them. */
static vg_status list_bad(const struct strip *s, struct vg_spots *out)
{
  double target = vg_repair_levels(s->sizing)->target;

  for (size_t c = 0; c < s->t.n_cell; c++) {
    const double *x[4];

    if (s->shape[c] >= target || s->shape[c] >= s->old[c] || s->on[c]) continue;
    for (int i = 0; i < 4; i++) x[i] = s->t.x[s->t.cell[c].v[i]];
    if (vg_spots_add(out, s->sizing, x, s->shape[c]) < 0) return VG_ERR_MEMORY;
  }
  return VG_OK;
}

vg_status vg_repair_adjacent(const struct vg_piece *q,
                             const struct vg_sizing *sizing, size_t n,
                             const uint32_t *hit, const uint8_t *shared,
                             struct vg_spots *out)
{
  struct strip s = {
    .q = q, .sizing = sizing, .n_hit = n, .hit = hit, .shared = shared
  };
  struct vg_optimise_report r;
  vg_status st = VG_OK;

  if (!n) return VG_OK;
  st = find_points(&s);
  if (st == VG_OK) st = take_cells(&s);
  if (st == VG_OK) st = find_shapes(&s);
  if (st == VG_OK)
    st = vg_optimise_points(&s.t, s.n, s.point,
                            vg_repair_levels(sizing)->adjacent, sizing,
                            s.metrics, s.shape, &r, NULL);
  if (st == VG_OK) st = list_bad(&s, out);
  vg_metrics_free(s.metrics);
  free(s.moves);
  free(s.point);
  free(s.t.cell);
  free(s.t.flag);
  free(s.shape);
  free(s.old);
  free(s.on);
  return st;
}
