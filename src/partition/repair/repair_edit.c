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

/* Keeps the remaining cells and appends the new ones. */
static vg_status edit_cells(struct vg_piece *q, const struct vg_edit *c)
{
  size_t kept = 0;

  for (size_t k = 0; k < q->n_cell; k++) {
    if (c->gone && c->gone[k]) continue;
    if (kept < k) memcpy(q->cell[kept], q->cell[k], sizeof *q->cell);
    kept++;
  }
  if (kept + c->n_cell > q->n_cell) {
    uint32_t(*cell)[4] = vg_alloc(kept + c->n_cell, sizeof *cell);

    if (!cell) return VG_ERR_MEMORY;
    if (kept) memcpy(cell, q->cell, kept * sizeof *cell);
    free(q->cell);
    q->cell = cell;
  }
  if (c->n_cell) memcpy(q->cell + kept, c->cell, c->n_cell * sizeof *q->cell);
  q->n_cell = kept + c->n_cell;
  return VG_OK;
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
  size_t n = q->n_in + q->n_point + c->n_point;
  uint32_t *to = vg_alloc(n, sizeof *to);

  if (!to || make_room(q, c->n_point) < 0 || edit_cells(q, c) < 0) {
    free(to);
    return VG_ERR_MEMORY;
  }
  memset(to, 0xff, n * sizeof *to);
  for (size_t k = 0; k < q->n_cell; k++)
    for (int i = 0; i < 4; i++) to[q->cell[k][i]] = 0;
  edit_points(q, c, to);
  for (size_t k = 0; k < q->n_cell; k++)
    for (int i = 0; i < 4; i++) q->cell[k][i] = to[q->cell[k][i]];
  free(to);
  return VG_OK;
}
