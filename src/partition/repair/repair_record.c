/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Times of repairs, as tasks in the trace of a run: they wait for all leaves
 * and for nothing else. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/memory.h"
#include "partition/repair/repair_parts.h"

void vg_repair_begin(struct vg_span *s, int worker)
{
  memset(s, 0, sizeof *s);
  s->kind = VG_SPAN_REPAIR;
  s->thread = worker;
  s->start = vg_clock();
  s->cpu = vg_clock_thread();
}

void vg_repair_end(struct vg_span *s, const char *what, size_t number,
                   size_t n_cell)
{
  assert(what);
  s->end = vg_clock();
  s->cpu = vg_clock_thread() - s->cpu;
  s->n_cell = n_cell;
  s->estimate = (double)n_cell;
  snprintf(s->path, sizeof s->path, "0R%s%06zu", what, number);
}

/* Collects the lists of all ranks on rank 0; other ranks keep their own. The
 * clocks of two nodes are unrelated, so times are relative to the start of the
 * repairs on their rank. */
static vg_status collect(const struct vg_partition *p, struct vg_comm *comm,
                         double begin, struct vg_spans *own,
                         struct vg_spans *spans, struct vg_error *err)
{
  struct vg_bytes *all = vg_calloc((size_t)p->size, sizeof *all);
  struct vg_bytes mine = { own->n * sizeof *own->span, (void *)own->span };
  vg_status st = all ? VG_OK : vg_fail_memory(err, "the trace of tasks");

  for (size_t k = 0; k < own->n; k++) {
    own->span[k].rank = own->span[k].home = p->rank;
    own->span[k].start -= begin;
    own->span[k].end -= begin;
  }
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = vg_comm_allgather(comm, &mine, all, err);
  for (int r = 0; st == VG_OK && r < p->size; r++)
    for (size_t at = 0; at < all[r].n && st == VG_OK; at += sizeof *own->span) {
      struct vg_span s;

      if (p->rank && r != p->rank) break;
      memcpy(&s, all[r].data + at, sizeof s);
      st = vg_spans_add(spans, &s, err);
    }
  vg_bytes_release(all, (size_t)p->size);
  return st;
}

vg_status vg_repair_record(const struct vg_partition *p, struct vg_comm *comm,
                           double begin, struct vg_spans *own,
                           struct vg_spans *spans, struct vg_error *err)
{
  size_t first = spans->n, leaf = 0;
  double wall = vg_clock() - begin;
  vg_status st = collect(p, comm, begin, own, spans, err);

  while (leaf < first && spans->span[leaf].kind != VG_SPAN_LEAF) leaf++;
  for (size_t k = first; k < spans->n; k++) {
    struct vg_span *s = &spans->span[k];

    s->start += spans->wall;
    s->end += spans->wall;
    if (s->thread >= spans->n_thread) s->thread = spans->n_thread - 1;
    if (leaf < first) memcpy(s->after, spans->span[leaf].path, sizeof s->after);
  }
  vg_spans_sort(spans);
  st = vg_comm_agree(comm, st, err);
  if (st == VG_OK) st = vg_comm_max(comm, 1, &wall, err);
  spans->wall += wall;
  return st;
}
