/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Cyclic schedule: static assignment of leaves to workers before any leaf is
 * filled. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/model/model_parts.h"

#define NONE VG_MODEL_NONE

void vg_assignment_release(struct vg_assignment *d)
{
  free(d->held);
  free(d->first);
  free(d->last);
  free(d->next);
  free(d->woken);
  free(d->is_idle);
  memset(d, 0, sizeof *d);
}

vg_status vg_assignment_new(struct vg_assignment *d, uint32_t n,
                            uint32_t n_worker, struct vg_error *err)
{
  assert(n_worker > 0);
  d->n_worker = n_worker;
  d->held = vg_alloc(n, sizeof *d->held);
  d->next = vg_alloc(n, sizeof *d->next);
  d->first = vg_alloc(n_worker, sizeof *d->first);
  d->last = vg_alloc(n_worker, sizeof *d->last);
  d->woken = vg_alloc(n_worker, sizeof *d->woken);
  d->is_idle = vg_calloc(n_worker, sizeof *d->is_idle);
  if (!d->held || !d->next || !d->first || !d->last || !d->woken || !d->is_idle)
    return vg_fail_memory(err, "the simulation");
  for (uint32_t w = 0; w < n_worker; w++) d->first[w] = NONE;
  return VG_OK;
}

vg_status vg_assignment_check(const struct vg_model_graph *g,
                              struct vg_error *err)
{
  const struct vg_span *leaf = NULL;

  for (uint32_t i = 0; i < g->n; i++) {
    if (g->span[i].kind != VG_SPAN_LEAF) continue;
    if (g->span[i].work > 0) return VG_OK;
    leaf = &g->span[i];
  }
  if (!leaf) return VG_OK;
  return vg_fail(err, VG_ERR_INPUT,
                 "task '%s' of the trace has no 'work', by which leaves "
                 "are assigned, nor has any other leaf: trace the run again, "
                 "or replay it with a dynamic schedule",
                 leaf->path);
}

static void append(struct vg_assignment *d, uint32_t worker, uint32_t task)
{
  d->next[task] = NONE;
  if (d->first[worker] == NONE) d->first[worker] = task;
  else d->next[d->last[worker]] = task;
  d->last[worker] = task;
}

struct held {
  double work;
  uint32_t task;
};

static int by_work(const void *a, const void *b)
{
  const struct held *s = a, *t = b;

  if (s->work != t->work) return s->work > t->work ? -1 : 1;
  return (s->task > t->task) - (s->task < t->task);
}

vg_status vg_assignment_make(struct vg_assignment *d,
                             const struct vg_span *span, struct vg_error *err)
{
  struct held *list = vg_alloc(d->n_held, sizeof *list);

  if (!list) return vg_fail_memory(err, "the simulation");
  for (uint32_t i = 0; i < d->n_held; i++)
    list[i] = (struct held){ span[d->held[i]].work, d->held[i] };
  qsort(list, d->n_held, sizeof *list, by_work);
  for (uint32_t i = 0; i < d->n_held; i++)
    append(d, i % d->n_worker, list[i].task);
  free(list);
  d->n_held = 0;
  for (uint32_t w = 0; w < d->n_worker; w++) d->woken[w] = w;
  d->n_woken = d->n_worker;
  return VG_OK;
}
