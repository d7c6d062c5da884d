/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "partition/cut/task_data.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/bytes.h"
#include "base/memory.h"
#include "core/geometry/vector.h"

double vg_front_work(const struct vg_front *f)
{
  double area = 0, volume = vg_front_volume(f);

  assert((f->x && f->face) || !f->n_face);
  for (size_t i = 0; i < f->n_face; i++) {
    const double *x = f->x[f->face[i][0]];
    double a[3], b[3], n[3];

    vg_sub(f->x[f->face[i][1]], x, a);
    vg_sub(f->x[f->face[i][2]], x, b);
    vg_cross(a, b, n);
    area += vg_norm(n) / 2;
  }
  return volume > 0 && area > 0 ? volume * (double)f->n_face / area : 0;
}

/* --- outcomes ------------------------------------------------------------ */

void vg_piece_release(struct vg_piece *p)
{
  free(p->in);
  free(p->x);
  vg_packed_cells_release(&p->cell);
  memset(p, 0, sizeof *p);
}

size_t vg_piece_bytes(const struct vg_piece *p)
{
  return p->n_in * sizeof *p->in + (p->n_in + p->n_point) * sizeof *p->x +
         vg_packed_cells_bytes(&p->cell, p->n_cell);
}

void vg_change_release(struct vg_change *c)
{
  vg_filled_release(&c->made);
  memset(c, 0, sizeof *c);
}

void vg_change_put(struct vg_writer *w, const struct vg_change *c)
{
  uint64_t head[3] = { (uint64_t)c->blocked, c->serial, c->n_part };

  assert(w && c);
  vg_put(w, 3, sizeof *head, head);
  vg_filled_put(w, &c->made, 0);
}

void vg_change_get(struct vg_reader *r, struct vg_change *c)
{
  uint64_t head[3] = { 0 };

  assert(r && c);
  memset(c, 0, sizeof *c);
  vg_get(r, 3, sizeof *head, head);
  vg_filled_get(r, &c->made, 0);
  if (r->bad) return;
  c->blocked = head[0] != 0;
  c->serial = (uint32_t)head[1];
  c->n_part = head[2];
}
