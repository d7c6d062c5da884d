/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Finds triangles of a surface that share more than their common nodes and
 * edges: all pairs, sorted by their numbers. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/geometry/triangles.h"
#include "core/search/box_pairs.h"

/* Findings of one thread. Beyond the limit, pairs are counted only. */
struct found {
  size_t n_pair, n_listed, cap;
  uint32_t (*pair)[2];
};

struct search {
  struct vg_crossing *c;
  const struct vg_faces *s;
  const uint32_t *first;
  const uint32_t (*fan)[3];
  const uint32_t *shell;
  const struct vg_stop *stop;
  struct found *found; /* By worker. */
};

/* Atomic minimum over all threads, independent of their order. */
static void note_partner(struct vg_crossing *c, uint32_t f, uint32_t g)
{
  uint32_t *at = &c->partner[f], now = __atomic_load_n(at, __ATOMIC_RELAXED);

  while (g < now &&
         !__atomic_compare_exchange_n(at, &now, g, 0, __ATOMIC_RELAXED,
                                      __ATOMIC_RELAXED)) {
  }
}

static vg_status list_pair(struct found *p, uint32_t f, uint32_t g)
{
  if (p->n_pair > VG_SURFACE_PAIR_MAX) return VG_OK;
  if (vg_reserve(&p->pair, &p->cap, p->n_listed + 1, sizeof *p->pair))
    return VG_ERR_MEMORY;
  p->pair[p->n_listed][0] = f < g ? f : g;
  p->pair[p->n_listed++][1] = f < g ? g : f;
  return VG_OK;
}

static vg_status check_pair(void *context, int worker, uint32_t f, uint32_t g)
{
  struct search *x = context;
  struct vg_crossing *c = x->c;

  if (vg_stops(x->stop)) return VG_ERR_STOPPED;
  if (x->first[f] != f || x->first[g] != g ||
      vg_faces_source(x->s, f) == vg_faces_source(x->s, g) ||
      !vg_triangles_meet(x->s->point, x->s->node[f], x->s->node[g], x->fan[f],
                         x->fan[g]))
    return VG_OK;
  x->found[worker].n_pair++;
  note_partner(c, f, g);
  note_partner(c, g, f);
  if (x->shell[f] != x->shell[g]) {
    __atomic_store_n(&c->other_shell[x->shell[f]], 1, __ATOMIC_RELAXED);
    __atomic_store_n(&c->other_shell[x->shell[g]], 1, __ATOMIC_RELAXED);
  }
  return list_pair(&x->found[worker], f, g);
}

static int compare_pair(const void *a, const void *b)
{
  const uint32_t *p = a, *q = b;

  if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
  return (p[1] > q[1]) - (p[1] < q[1]);
}

/* Collect and sort the pairs of all threads. Each pair is found once, so that
 * the result does not depend on the order in which they were found. */
static vg_status gather_pairs(struct vg_crossing *c, const struct found *found,
                              int n_found)
{
  for (int i = 0; i < n_found; i++) c->n_pair += found[i].n_pair;
  if (!c->n_pair || c->n_pair > VG_SURFACE_PAIR_MAX) return VG_OK;
  c->pair = vg_alloc(c->n_pair, sizeof *c->pair);
  if (!c->pair) return VG_ERR_MEMORY;
  for (int i = 0; i < n_found; i++) {
    if (!found[i].n_listed) continue;
    memcpy(c->pair + c->n_listed, found[i].pair,
           found[i].n_listed * sizeof *c->pair);
    c->n_listed += found[i].n_listed;
  }
  qsort(c->pair, c->n_listed, sizeof *c->pair, compare_pair);
  return VG_OK;
}

vg_status vg_find_crossings(struct vg_crossing *c, const struct vg_faces *s,
                            const uint32_t *first, const uint32_t (*fan)[3],
                            const struct vg_box_tree *t, const uint32_t *shell,
                            size_t n_shell, int threads,
                            const struct vg_stop *stop, struct vg_error *err)
{
  assert(!c->pair && !c->partner && threads >= 0);

  int n_found = vg_box_tree_workers(threads);
  struct search x = {
    c, s, first, fan, shell, stop, vg_calloc((size_t)n_found, sizeof *x.found)
  };
  vg_status st = VG_ERR_MEMORY;

  c->partner = vg_alloc(s->n, sizeof *c->partner);
  c->other_shell = vg_calloc(n_shell, 1);
  if (x.found && c->partner && c->other_shell) {
    memset(c->partner, 0xff, s->n * sizeof *c->partner);
    st = vg_box_tree_pairs(t, threads, check_pair, &x);
    if (st >= 0) st = gather_pairs(c, x.found, n_found);
  }
  for (int i = 0; x.found && i < n_found; i++) free(x.found[i].pair);
  free(x.found);
  if (st >= 0) return VG_OK;
  vg_crossing_release(c);
  if (st == VG_ERR_STOPPED) return vg_stopped(stop, err);
  return vg_fail_memory(err, "the list of intersections");
}

void vg_crossing_release(struct vg_crossing *c)
{
  free(c->pair);
  free(c->partner);
  free(c->other_shell);
  memset(c, 0, sizeof *c);
}
