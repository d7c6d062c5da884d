/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the octree is refined together with the triangles of the front,
 * which determine what is in the void, until octants are as narrow as the
 * sizes require. It is then balanced, and each triangle removes the octants
 * that it is too close to. */
#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/engine/engine.h"
#include "partition/octree/octree_parts.h"

/* Distance between octants and front, in sizes, as room for cells graded
 * between them. */
#define ROOM 1.5 /* O1 */

enum { MOST = 1 << 24 };

struct maker {
  struct vg_load_tree triangles;
  struct vg_load_stack stack;
  const struct vg_sizing *sizing;
  const struct vg_engine *engine;
  double coarsening;
  struct vg_octants *t;
};

void vg_octants_release(struct vg_octants *t)
{
  free(t->octant);
  free(t->leaf);
  free(t->face);
  memset(t, 0, sizeof *t);
}

/* --- octants ------------------------------------------------------------- */

static vg_status too_many(const struct maker *m, struct vg_error *err)
{
  return vg_fail(err, VG_ERR_UNSUPPORTED,
                 "an octree with octants %g sizes wide has more than "
                 "%d octants; raise the coarsening",
                 m->coarsening, (int)MOST);
}

/* Makes eight leaves below leaf i, with its state. */
static vg_status split(struct maker *m, uint32_t i, struct vg_error *err)
{
  struct vg_octants *t = m->t;
  struct vg_octant *o;
  uint32_t half;

  if (t->n + 8 > MOST) return too_many(m, err);
  if (vg_reserve(&t->octant, &t->cap, t->n + 8, sizeof *t->octant))
    return vg_fail_memory(err, "the octants");
  o = &t->octant[i];
  o->child = (uint32_t)t->n;
  half = vg_octant_side(o) / 2;
  for (int c = 0; c < 8; c++) {
    struct vg_octant *to = &t->octant[t->n++];

    *to = *o;
    to->child = 0;
    to->level++;
    for (int k = 0; k < 3; k++) to->at[k] += c >> k & 1 ? half : 0;
  }
  return VG_OK;
}

static int is_wide(const struct maker *m, const struct vg_octant *o)
{
  const double side = vg_octant_side(o) * m->t->unit;
  double lo[3], x[3];

  for (int k = 0; k < 3; k++) lo[k] = vg_octants_place(m->t, k, o->at[k]);
  return side > m->coarsening * vg_sizing_least(m->sizing, lo, side, x);
}

static vg_status refine(struct maker *m, uint32_t i,
                        const struct vg_load_node *node, struct vg_error *err)
{
  const size_t keep = m->stack.n;
  struct vg_load_node part[8];
  struct vg_octant *o = &m->t->octant[i];
  vg_status st = VG_OK;

  o->state = node->n         ? VG_OCTANT_GAP
           : node->owner < 1 ? VG_OCTANT_OUT
                             : VG_OCTANT_FREE;
  if (o->state == VG_OCTANT_OUT || o->level == VG_LOAD_LEVELS || !is_wide(m, o))
    return VG_OK;
  if (m->engine && vg_engine_stopping(m->engine)) return VG_ERR_STOPPED;
  if (vg_load_octants(&m->triangles, &m->stack, node, part, 1))
    return vg_fail_memory(err, "the octants");
  st = split(m, i, err);
  for (uint32_t c = 0; st == VG_OK && c < 8; c++)
    st = refine(m, m->t->octant[i].child + c, &part[c], err);
  m->stack.n = keep;
  return st;
}

static vg_status refine_all(struct maker *m, const struct vg_front *v,
                            struct vg_error *err)
{
  struct vg_octants *t = m->t;
  struct vg_load_node root = { .n = v->n_face };
  vg_status st = vg_load_tree_new(&m->triangles, 1, v, 1, err);

  if (st < 0) return st;
  if (vg_reserve(&t->octant, &t->cap, 1, sizeof *t->octant) ||
      vg_reserve(&m->stack.item, &m->stack.cap, 2 * v->n_face,
                 sizeof *m->stack.item)) {
    st = vg_fail_memory(err, "the octants");
  } else {
    t->octant[t->n++] = (struct vg_octant){ .level = 0 };
    for (size_t k = 0; k < v->n_face; k++) m->stack.item[k] = (uint32_t)k;
    m->stack.n = v->n_face;
    st = refine(m, 0, &root, err);
  }
  vg_load_stack_release(&m->stack);
  vg_load_tree_release(&m->triangles);
  return st;
}

/* The neighbour of o, at its level or a leaf above it. */
static uint32_t adjacent(const struct vg_octants *t, const struct vg_octant *o,
                         int axis, int up)
{
  uint32_t p[3] = { o->at[0], o->at[1], o->at[2] }, i = 0;

  p[axis] += up ? vg_octant_side(o) : UINT32_MAX;
  if (p[axis] >> VG_LOAD_BITS) return VG_OCTANT_NONE;
  while (t->octant[i].child && t->octant[i].level < o->level) {
    const int bit = VG_LOAD_BITS - 1 - t->octant[i].level;
    uint32_t c = 0;

    for (int k = 0; k < 3; k++) c |= (p[k] >> bit & 1) << k;
    i = t->octant[i].child + c;
  }
  return i;
}

/* Balances the octree. One pass suffices, because new leaves are visited
 * later. */
static vg_status balance(struct maker *m, struct vg_error *err)
{
  struct vg_octants *t = m->t;

  for (uint32_t i = 0; i < t->n; i++)
    for (int d = 0; d < 6; d++) {
      const struct vg_octant *o = &t->octant[i], *b;
      uint32_t at;
      vg_status st;

      if (o->child || o->state == VG_OCTANT_OUT) break;
      at = adjacent(t, o, d >> 1, d & 1);
      if (at == VG_OCTANT_NONE) continue;
      b = &t->octant[at];
      if (b->state == VG_OCTANT_OUT || b->level + 1 >= o->level) continue;
      st = split(m, at, err);
      if (st < 0) return st;
      d--; /* check this side again */
    }
  return VG_OK;
}

/* --- distance to the front ----------------------------------------------- */

static double set_reach(const struct maker *m, uint32_t i)
{
  struct vg_octant *o = &m->t->octant[i];

  o->reach = 0;
  for (uint32_t c = 0; o->child && c < 8; c++) {
    const double r = set_reach(m, o->child + c);

    if (r > o->reach) o->reach = r;
  }
  if (!o->child && o->state == VG_OCTANT_FREE) {
    double x[3];

    for (int k = 0; k < 3; k++)
      x[k] = vg_octants_place(m->t, k, o->at[k] + vg_octant_side(o) / 2);
    o->reach = ROOM * vg_sizing_at(m->sizing, x);
  }
  return o->reach;
}

/* Removes the octants that are too close to the box. */
static void take_out(const struct vg_octants *t, uint32_t i, const double lo[3],
                     const double hi[3])
{
  struct vg_octant *o = &t->octant[i];
  double sum = 0;

  for (int k = 0; k < 3; k++) {
    const double a = vg_octants_place(t, k, o->at[k]);
    const double b = vg_octants_place(t, k, o->at[k] + vg_octant_side(o));
    const double d = lo[k] > b ? lo[k] - b : a > hi[k] ? a - hi[k] : 0;

    sum += d * d;
  }
  if (!(sum < o->reach * o->reach)) return;
  if (!o->child) {
    o->state = VG_OCTANT_GAP;
    o->reach = 0;
  }
  for (uint32_t c = 0; o->child && c < 8; c++)
    take_out(t, o->child + c, lo, hi);
}

static void leave_room(const struct maker *m, const struct vg_front *v)
{
  set_reach(m, 0);
  for (size_t i = 0; i < v->n_face; i++) {
    double lo[3], hi[3];

    for (int k = 0; k < 3; k++) {
      lo[k] = hi[k] = v->x[v->face[i][0]][k];
      for (int j = 1; j < 3; j++) {
        const double x = v->x[v->face[i][j]][k];

        if (x < lo[k]) lo[k] = x;
        if (x > hi[k]) hi[k] = x;
      }
    }
    take_out(m->t, 0, lo, hi);
  }
}

/* --- leaves and faces ---------------------------------------------------- */

static void list_leaves(struct vg_octants *t, uint32_t i)
{
  const struct vg_octant *o = &t->octant[i];

  if (!o->child && o->state != VG_OCTANT_OUT) t->leaf[t->n_leaf++] = i;
  for (uint32_t c = 0; o->child && c < 8; c++) list_leaves(t, o->child + c);
}

/* Each face is found from its smaller leaf or, for equal leaves, from the
 * lower one. */
static vg_status list_faces(struct vg_octants *t, struct vg_error *err)
{
  for (size_t l = 0; l < t->n_leaf; l++)
    for (int d = 0; d < 6; d++) {
      const struct vg_octant *o = &t->octant[t->leaf[l]], *b;
      const int axis = d >> 1, up = d & 1;
      const uint32_t at = adjacent(t, o, axis, up);
      struct vg_octant_face *f;

      if (at == VG_OCTANT_NONE) continue;
      b = &t->octant[at];
      if (b->child || b->state == VG_OCTANT_OUT ||
          (b->level == o->level && !up))
        continue;
      if (vg_reserve(&t->face, &t->cap_face, t->n_face + 1, sizeof *f))
        return vg_fail_memory(err, "the faces of octants");
      f = &t->face[t->n_face++];
      memcpy(f->at, o->at, sizeof f->at);
      f->side = vg_octant_side(o);
      f->at[axis] += up ? f->side : 0;
      f->axis = (uint8_t)axis;
      f->leaf[!up] = t->leaf[l];
      f->leaf[up] = at;
    }
  return VG_OK;
}

vg_status vg_octants_make(const struct vg_front *v, const struct vg_load *load,
                          const struct vg_sizing *sizing, double coarsening,
                          const struct vg_engine *e, struct vg_octants *t,
                          struct vg_error *err)
{
  struct maker m = { .sizing = sizing,
                     .engine = e,
                     .coarsening = coarsening,
                     .stack = VG_LOAD_STACK_INIT,
                     .t = t };
  vg_status st;

  assert(coarsening >= 2 && t);
  memset(t, 0, sizeof *t);
  memcpy(t->lo, load->lo, sizeof t->lo);
  t->unit = load->unit;
  memcpy(m.triangles.lo, load->lo, sizeof load->lo);
  m.triangles.unit = load->unit;
  st = refine_all(&m, v, err);
  if (st == VG_OK) st = balance(&m, err);
  if (st != VG_OK) return st;
  leave_room(&m, v);
  t->leaf = vg_alloc(t->n, sizeof *t->leaf);
  if (!t->leaf) return vg_fail_memory(err, "the octants");
  list_leaves(t, 0);
  return list_faces(t, err);
}
