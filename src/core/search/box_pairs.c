/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "core/search/box_pairs.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

#define TASKS 1024 /* pairs of nodes that are searched in parallel */

/* Pairs of an item below node a and an item below node b. If a = b: pairs of
 * different items below that node. */
struct task {
  size_t a, b;
};

struct pairs {
  const struct vg_box_tree *t;
  vg_box_pair_visit visit;
  void *context;
  size_t n_task, cap_task;
  struct task *task;
  int status; /* status of a visit that failed */
};

static vg_status leaf_pairs(const struct pairs *p, int worker, struct task of)
{
  const struct vg_box_tree *t = p->t;
  const size_t end_a = vg_box_tree_end(t, of.a);
  const size_t end_b = vg_box_tree_end(t, of.b);

  for (size_t i = vg_box_tree_first(t, of.a); i < end_a; i++)
    for (size_t j = of.a == of.b ? i + 1 : vg_box_tree_first(t, of.b);
         j < end_b; j++)
      if (vg_box_touch(&t->box[i], &t->box[j])) {
        vg_status st = p->visit(p->context, worker, t->item[i], t->item[j]);

        if (st < 0) return st;
      }
  return VG_OK;
}

/* Longest side of a box. */
static double extent(const struct vg_box *b)
{
  double m = b->hi[0] - b->lo[0];

  for (int k = 1; k < 3; k++)
    if (b->hi[k] - b->lo[k] > m) m = b->hi[k] - b->lo[k];
  return m;
}

/* Split a task into 0 to 3 smaller tasks, in order. Returns -1 if both nodes
 * are leaves. All leaves are on one level, but one node of a pair may be
 * higher in the tree than the other. */
static int parts_of(const struct pairs *p, struct task of, struct task out[3])
{
  const struct vg_box *a = vg_box_tree_node(p->t, of.a);
  const struct vg_box *b = vg_box_tree_node(p->t, of.b);
  const int a_leaf = of.a >= p->t->first_leaf;
  const int b_leaf = of.b >= p->t->first_leaf;
  const size_t below_a = 2 * of.a + 1, below_b = 2 * of.b + 1;

  if (of.a == of.b && a_leaf) return -1;
  if (of.a == of.b) {
    out[0] = (struct task){ below_a, below_a };
    out[1] = (struct task){ below_a + 1, below_a + 1 };
    out[2] = (struct task){ below_a, below_a + 1 };
    return 3;
  }
  if (!vg_box_touch(a, b)) return 0;
  if (a_leaf && b_leaf) return -1;
  if (a_leaf || (!b_leaf && extent(b) > extent(a))) {
    out[0] = (struct task){ of.a, below_b };
    out[1] = (struct task){ of.a, below_b + 1 };
  } else {
    out[0] = (struct task){ below_a, of.b };
    out[1] = (struct task){ below_a + 1, of.b };
  }
  return 2;
}

static vg_status pairs_below(const struct pairs *p, int worker, struct task of)
{
  struct task part[3];
  int n = parts_of(p, of, part);
  vg_status st = VG_OK;

  if (n < 0) return leaf_pairs(p, worker, of);
  for (int i = 0; i < n && st >= 0; i++) st = pairs_below(p, worker, part[i]);
  return st;
}

static void pairs_body(void *context, size_t first, size_t end, int worker)
{
  struct pairs *p = context;

  for (size_t i = first; i < end; i++) {
    vg_status st = __atomic_load_n(&p->status, __ATOMIC_RELAXED);

    if (st < 0) return;
    st = pairs_below(p, worker, p->task[i]);
    if (st < 0) __atomic_store_n(&p->status, st, __ATOMIC_RELAXED);
  }
}

/* Split all tasks repeatedly until there are enough of them. */
static vg_status list_tasks(struct pairs *p)
{
  struct task *old = NULL;
  size_t n_old, cap_old = 0;
  int changed = 1;

  if (vg_reserve(&p->task, &p->cap_task, 1, sizeof *p->task))
    return VG_ERR_MEMORY;
  p->task[p->n_task++] = (struct task){ 0, 0 };
  while (changed && p->n_task < TASKS) {
    n_old = p->n_task;
    if (vg_reserve(&old, &cap_old, n_old, sizeof *old) ||
        vg_reserve(&p->task, &p->cap_task, 3 * n_old, sizeof *p->task)) {
      free(old);
      return VG_ERR_MEMORY;
    }
    memcpy(old, p->task, n_old * sizeof *old);
    p->n_task = 0;
    changed = 0;
    for (size_t i = 0; i < n_old; i++) {
      int n = parts_of(p, old[i], p->task + p->n_task);

      if (n < 0) p->task[p->n_task++] = old[i];
      else p->n_task += (size_t)n;
      changed |= n >= 0;
    }
  }
  free(old);
  return VG_OK;
}

int vg_box_tree_workers(int threads)
{
  int n = threads > 0 ? threads : vg_cores();

  return n < TASKS ? n : TASKS;
}

vg_status vg_box_tree_pairs(const struct vg_box_tree *t, int threads,
                            vg_box_pair_visit visit, void *context)
{
  struct pairs p = { .t = t, .visit = visit, .context = context };
  vg_status st = VG_OK;

  if (!t->n) return VG_OK;
  if (threads == 1) return pairs_below(&p, 0, (struct task){ 0, 0 });
  st = list_tasks(&p);
  if (st >= 0) {
    vg_parallel_for(vg_box_tree_workers(threads), p.n_task, 1, pairs_body, &p);
    st = (vg_status)p.status;
  }
  free(p.task);
  return st;
}
