/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Removes and adds cells of a piece. */
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/repair/repair_parts.h"

void vg_edit_release(struct vg_edit *c)
{
  free(c->gone);
  free(c->cell);
  free(c->name);
  free(c->x);
  memset(c, 0, sizeof *c);
}

/* Lists the remaining cells, then the new ones. cell out: [q.n_cell +
 * c.n_cell]; returns their number. */
static size_t list_cells(const struct vg_piece *q, const struct vg_edit *c,
                         uint32_t (*cell)[4])
{
  size_t kept = 0;

  for (size_t k = 0; k < q->n_cell; k++)
    if (!c->gone || !c->gone[k]) vg_piece_cell(q, k, cell[kept++]);
  if (c->n_cell) memcpy(cell + kept, c->cell, c->n_cell * sizeof *cell);
  return kept + c->n_cell;
}

/* Makes room for new points of other pieces. */
static vg_status make_room(struct vg_piece *q, size_t more)
{
  size_t n = q->n_in + q->n_point;
  uint64_t *in;
  double(*x)[3];

  if (!more) return VG_OK;
  in = vg_alloc(q->n_in + more, sizeof *in);
  x = vg_alloc(n + more, sizeof *x);
  if (!in || !x) {
    free(in);
    free(x);
    return VG_ERR_MEMORY;
  }
  if (q->n_in) memcpy(in, q->in, q->n_in * sizeof *in);
  if (n) memcpy(x, q->x, n * sizeof *x);
  free(q->in);
  free(q->x);
  q->in = in;
  q->x = x;
  return VG_OK;
}

/* Renumbers the used points of other pieces, old ones first, then the piece's
 * own. to: [n_in + n_point + c.n_point] 0: used; out: new numbers. */
static void edit_points(struct vg_piece *q, const struct vg_edit *c,
                        uint32_t *to)
{
  size_t n = q->n_in + q->n_point, kept = 0, more = 0;

  for (size_t k = 0; k < q->n_in; k++) kept += to[k] != UINT32_MAX;
  for (size_t k = 0; k < c->n_point; k++) more += to[n + k] != UINT32_MAX;
  for (size_t k = 0; k < q->n_point; k++)
    to[q->n_in + k] = (uint32_t)(kept + more + k);
  if (kept + more > q->n_in)
    memmove(q->x + kept + more, q->x + q->n_in, q->n_point * sizeof *q->x);
  for (size_t k = 0, at = 0; k < q->n_in; k++) {
    if (to[k] == UINT32_MAX) continue;
    to[k] = (uint32_t)at;
    q->in[at] = q->in[k];
    memmove(q->x[at++], q->x[k], sizeof *q->x);
  }
  if (kept + more < q->n_in)
    memmove(q->x + kept + more, q->x + q->n_in, q->n_point * sizeof *q->x);
  for (size_t k = 0, at = kept; k < c->n_point; k++) {
    if (to[n + k] == UINT32_MAX) continue;
    to[n + k] = (uint32_t)at;
    q->in[at] = c->name[k];
    memcpy(q->x[at++], c->x[k], sizeof *q->x);
  }
  q->n_in = kept + more;
}

vg_status vg_piece_edit(struct vg_piece *q, const struct vg_edit *c)
{
  size_t n = q->n_in + q->n_point + c->n_point, n_cell;
  uint32_t *to = vg_alloc(n, sizeof *to);
  uint32_t(*cell)[4] = vg_alloc(q->n_cell + c->n_cell, sizeof *cell);
  struct vg_packed_cells packed = { 0 };
  vg_status st = to && cell ? make_room(q, c->n_point) : VG_ERR_MEMORY;

  if (st < 0) goto done;
  n_cell = list_cells(q, c, cell);
  memset(to, 0xff, n * sizeof *to);
  for (size_t k = 0; k < n_cell; k++)
    for (int i = 0; i < 4; i++) to[cell[k][i]] = 0;
  edit_points(q, c, to);
  for (size_t k = 0; k < n_cell; k++)
    for (int i = 0; i < 4; i++) cell[k][i] = to[cell[k][i]];
  if (vg_packed_cells_new(n_cell, (const uint32_t(*)[4])cell,
                          q->n_in + q->n_point, &packed)) {
    st = VG_ERR_MEMORY;
    goto done;
  }
  vg_packed_cells_release(&q->cell);
  q->cell = packed;
  q->n_cell = n_cell;
done:
  free(to);
  free(cell);
  return st;
}
