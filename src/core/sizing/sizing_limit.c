/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/sizing/sizing_build.h"

/* Gradient limit. Laws of sources may be steeper than the growth rate, so
 * their values at the points are lowered until no two corners of a leaf differ
 * by more than the slope times their distance. Lowering is monotone, and in
 * any order it converges to the same largest values that satisfy all
 * conditions. Many threads may therefore process leaves, and each lowered
 * value is stored at once. */
struct limit {
  struct vg_octree_build *b;
  _Atomic uint32_t *bits;    /* [n_point] bits of positive floats, which have
                                the same order */
  float *before;             /* [n_point] values before */
  _Atomic uint8_t *round_of; /* [n_point] round in which the point was
                                lowered last */
  uint8_t round;
  int backwards;
  atomic_int changed;
};

static float value(uint32_t bits)
{
  float h;

  memcpy(&h, &bits, sizeof h);
  return h;
}

static uint32_t bits_of(float h)
{
  uint32_t bits;

  memcpy(&bits, &h, sizeof bits);
  return bits;
}

/* Lower a value to h. Returns whether it changed. */
static int lower(_Atomic uint32_t *at, float h)
{
  uint32_t bits = bits_of(h);
  uint32_t old = atomic_load_explicit(at, memory_order_relaxed);

  while (bits < old &&
         !atomic_compare_exchange_weak_explicit(at, &old, bits,
                                                memory_order_relaxed,
                                                memory_order_relaxed))
    ;
  return bits < old;
}

static int lower_corners(const struct limit *l, const struct vg_octree_cell *c)
{
  static const unsigned char apart[8] = { 0, 1, 1, 2, 1, 2, 2, 3 };
  const struct vg_octree_build *b = l->b;
  double side = b->unit *
                (b->point[c->corner[1]].at[0] - vg_octree_corner(b, c)[0]);
  float reach[4], h[8], low = INFINITY, high = 0;
  int changed = 0;

  for (int i = 0; i < 8; i++) {
    h[i] = value(
      atomic_load_explicit(l->bits + c->corner[i], memory_order_relaxed));
    low = h[i] < low ? h[i] : low;
    high = h[i] > high ? h[i] : high;
  }
  reach[1] = (float)(b->f->slope * side);
  if (high <= low + reach[1]) return 0;
  for (int k = 0; k < 4; k++)
    reach[k] = (float)(b->f->slope * side * sqrt((double)k));
  for (int i = 0; i < 8; i++)
    for (int j = 0; j < 8; j++) {
      float most = h[i] + reach[apart[i ^ j]];

      if (h[j] <= most) continue;
      h[j] = most;
      changed = 1;
    }
  for (int i = 0; changed && i < 8; i++) {
    if (lower(l->bits + c->corner[i], h[i]))
      atomic_store_explicit(l->round_of + c->corner[i], l->round,
                            memory_order_relaxed);
  }
  return changed;
}

/* Was a corner lowered since the leaf was last processed? */
static int is_due(const struct limit *l, const struct vg_octree_cell *c)
{
  for (int i = 0; i < 8; i++) {
    uint8_t r = atomic_load_explicit(l->round_of + c->corner[i],
                                     memory_order_relaxed);

    if (r == l->round || r == (uint8_t)(l->round - 1)) return 1;
  }
  return 0;
}

static void lower_body(void *context, size_t first, size_t end, int worker)
{
  struct limit *l = context;
  int changed = 0;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    size_t at = l->backwards ? l->b->n_cell - 1 - i : i;
    const struct vg_octree_cell *c = l->b->cell + at;

    if (!c->child && is_due(l, c)) changed |= lower_corners(l, c);
  }
  if (changed) atomic_store(&l->changed, 1);
}

static void source_body(void *context, size_t first, size_t end, int worker)
{
  struct limit *l = context;
  struct vg_octree_build *b = l->b;
  double x[3];

  (void)worker;
  for (size_t i = first; i < end; i++) {
    vg_octree_place(b, b->point[i].at, x);
    l->before[i] = (float)vg_stat_clamp(b->f, vg_source_at(&b->f->set, x));
    atomic_init(l->bits + i, bits_of(l->before[i]));
  }
}

static void remesh_body(void *context, size_t first, size_t end, int worker)
{
  struct limit *l = context;
  struct vg_octree_build *b = l->b;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct vg_octree_point *p = b->point + i;
    float h = value(atomic_load_explicit(l->bits + i, memory_order_relaxed));
    double x[3];

    if (p->n_parent || h == l->before[i]) continue;
    vg_octree_place(b, p->at, x);
    p->h = (float)vg_stat_combine(b->f, x, (double)h, NULL, &p->hint);
  }
}

/* Update the field at points whose source value was lowered, and at hanging
 * points. This is done in order, because the parents of a hanging point may
 * hang, too. */
static void renew(struct limit *l)
{
  struct vg_octree_build *b = l->b;

  vg_parallel_for(b->threads, b->n_point, VG_OCTREE_GRAIN, remesh_body, l);
  for (size_t i = 0; i < b->n_point; i++)
    if (b->point[i].n_parent)
      b->point[i].h = vg_octree_hanging_size(b, b->point + i);
}

vg_status vg_octree_limit(struct vg_octree_build *b, struct vg_error *err)
{
  struct limit l = { .b = b,
                     .bits = vg_alloc(b->n_point, sizeof *l.bits),
                     .before = vg_alloc(b->n_point, sizeof *l.before),
                     .round_of = vg_calloc(b->n_point, 1),
                     .round = 1 };
  const struct vg_team_out out[] = { { l.bits, sizeof *l.bits, 0, NULL },
                                     { l.before, sizeof *l.before, 0, NULL } };
  vg_status st = VG_OK;
  int any = -1;

  if (!l.bits || !l.before || !l.round_of)
    st = vg_fail_memory(err, "the octree of the sizing field");
  else
    st = vg_team_for(b->team, b->threads, b->n_point, VG_OCTREE_GRAIN,
                     source_body, &l, sizeof out / sizeof *out, out, err);
  do {
    if (st < 0) break;
    atomic_store(&l.changed, 0);
    vg_parallel_for(b->threads, b->n_cell, VG_OCTREE_GRAIN, lower_body, &l);
    l.backwards = !l.backwards;
    l.round++;
    any++;
  } while (atomic_load(&l.changed));
  if (any > 0) renew(&l);
  free(l.bits);
  free(l.before);
  free(l.round_of);
  return st;
}
