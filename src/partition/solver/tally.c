/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/solver/solver_parts.h"

/* Neighbours of a partition. They are few, so a list is searched. */
struct near {
  uint32_t *part;
  size_t n, room;
};

struct vg_tally {
  size_t n;
  struct tally_part {
    uint64_t cells, cut;
    double weight;
    struct near near;
  } part[];
};

struct vg_tally *vg_tally_new(uint64_t n_part)
{
  struct vg_tally *t = NULL;

  if (n_part < SIZE_MAX / sizeof *t->part - 1)
    t = vg_calloc(1, sizeof *t + (size_t)n_part * sizeof *t->part);
  if (t) t->n = (size_t)n_part;
  return t;
}

void vg_tally_free(struct vg_tally *t)
{
  for (size_t k = 0; t && k < t->n; k++) free(t->part[k].near.part);
  free(t);
}

/* Moves the neighbour found last to the front, since faces come in runs. */
static int meet(struct near *s, uint32_t part)
{
  for (size_t k = 0; k < s->n; k++)
    if (s->part[k] == part) {
      s->part[k] = s->part[0];
      s->part[0] = part;
      return 0;
    }
  if (vg_reserve(&s->part, &s->room, s->n + 1, sizeof *s->part)) return -1;
  s->part[s->n++] = part;
  return 0;
}

int vg_tally_faces(struct vg_tally *t, uint32_t a, uint32_t b, uint64_t n)
{
  assert(a < t->n && b < t->n);
  if (a == b) return 0;
  t->part[a].cut += n;
  t->part[b].cut += n;
  return meet(&t->part[a].near, b) || meet(&t->part[b].near, a) ? -1 : 0;
}

void vg_tally_cells(struct vg_tally *t, uint32_t part, uint64_t n,
                    double weight)
{
  assert(part < t->n);
  t->part[part].cells += n;
  t->part[part].weight += weight;
}

void vg_tally_report(const struct vg_tally *t, struct vg_solver_report *r)
{
  double most = 0, sum = 0, near = 0;
  uint64_t cut = 0;

  r->n_part = t->n;
  r->least_cells = UINT64_MAX;
  r->most_cells = r->most_cut = r->most_near = r->n_cell = 0;
  for (size_t k = 0; k < t->n; k++) {
    const struct tally_part *p = &t->part[k];

    r->n_cell += p->cells;
    if (p->cells > r->most_cells) r->most_cells = p->cells;
    if (p->cells < r->least_cells) r->least_cells = p->cells;
    if (p->cut > r->most_cut) r->most_cut = p->cut;
    if (p->near.n > r->most_near) r->most_near = p->near.n;
    if (p->weight > most) most = p->weight;
    sum += p->weight;
    cut += p->cut;
    near += (double)p->near.n;
  }
  r->n_cut = cut / 2;
  r->balance = most * (double)t->n / sum;
  r->mean_cut = (double)cut / (double)t->n;
  r->mean_near = near / (double)t->n;
}
