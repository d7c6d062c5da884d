/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outline: the parent's octants and the front of each child are descended
 * together. In a node without any front, all octants are inside or all are
 * outside. In an octant that the front crosses, inside samples are counted. The
 * samples of an octant are always the same. Parts that earlier cuts have
 * dropped are therefore outside the children too, and errors do not accumulate
 * over generations. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "partition/engine/engine.h"
#include "partition/load/load.h"
#include "partition/load/load_tree.h"

struct share {
  uint32_t octant;
  double part;
};

/* State for one child. */
struct split {
  const struct vg_load *parent;
  struct vg_load_tree tree;
  struct vg_load_stack stack;
  size_t n_share, cap_share;
  struct share *share; /* Sorted by octant. */
};

static int add_share(struct split *s, size_t octant, int samples)
{
  struct share *to;

  if (vg_reserve(&s->share, &s->cap_share, s->n_share + 1, sizeof *to))
    return -1;
  to = &s->share[s->n_share++];
  to->octant = (uint32_t)octant;
  to->part = (double)samples / VG_LOAD_SAMPLES;
  return 0;
}

static int share_octant(struct split *s, const struct vg_load_node *node,
                        size_t octant)
{
  int32_t owner[VG_LOAD_SAMPLES];
  uint32_t at[3];
  int n = 0;

  vg_load_sample(&s->tree, &s->stack, node, owner, at);
  for (int i = 0; i < VG_LOAD_SAMPLES; i++) n += owner[i] == 1;
  return n ? add_share(s, octant, n) : 0;
}

/* Octant, of a node with centre mid, that contains an octant. */
static int octant_of(const struct vg_load_octant *c, const double mid[3])
{
  int o = 0;

  for (int k = 0; k < 3; k++) o |= ((double)c->at[k] > mid[k]) << k;
  return o;
}

static void middle(const struct split *s, const struct vg_load_node *node,
                   double mid[3])
{
  const double half = 0.5 * vg_load_side(node);

  for (int k = 0; k < 3; k++)
    mid[k] = s->tree.lo[k] + (node->at[k] + half) * s->tree.unit;
}

/* First of octants a .. b - 1, sorted by octant, that is in octant o or later.
 */
static size_t first_of(const struct split *s, size_t a, size_t b,
                       const double mid[3], int o)
{
  while (a < b) {
    const size_t m = a + (b - a) / 2;

    if (octant_of(&s->parent->octant[m], mid) < o) a = m + 1;
    else b = m;
  }
  return a;
}

/* Is the node identical to the single octant a .. b - 1? */
static int is_octant(const struct split *s, const struct vg_load_node *node,
                     size_t a, size_t b)
{
  return node->level >= VG_LOAD_LEVELS ||
         (b - a == 1 && vg_load_side(node) * s->tree.unit <
                          2.5 * (double)s->parent->octant[a].half);
}

static int descend(struct split *s, const struct vg_load_node *node, size_t a,
                   size_t b)
{
  const size_t keep = s->stack.n;
  struct vg_load_node part[8];
  double mid[3];
  int bad = 0;

  if (a == b || (!node->n && node->owner != 1)) return 0;
  if (!node->n) {
    for (; a < b && !bad; a++) bad = add_share(s, a, VG_LOAD_SAMPLES);
    return bad;
  }
  if (is_octant(s, node, a, b)) return share_octant(s, node, a);
  if (vg_load_octants(&s->tree, &s->stack, node, part, 1)) return -1;
  middle(s, node, mid);
  for (int o = 0; o < 8 && !bad; o++) {
    const size_t to = o < 7 ? first_of(s, a, b, mid, o + 1) : b;

    bad = descend(s, &part[o], a, to);
    a = to;
  }
  s->stack.n = keep;
  return bad;
}

/* Finds the smallest node around the child that is at least as large as the
 * parent's octant there, and the parent's octants a .. b - 1 in it. */
static void find_start(const struct split *s, struct vg_load_node *node,
                       size_t *a, size_t *b)
{
  uint32_t lo[3], hi[3];

  for (int k = 0; k < 3; k++) {
    lo[k] = UINT32_MAX;
    hi[k] = 0;
  }
  for (size_t i = 0; i < s->tree.n_tri; i++)
    for (int k = 0; k < 3; k++) {
      if (s->tree.tri[i].lo[k] < lo[k]) lo[k] = s->tree.tri[i].lo[k];
      if (s->tree.tri[i].hi[k] > hi[k]) hi[k] = s->tree.tri[i].hi[k];
    }
  *a = 0;
  *b = s->parent->n;
  while (!is_octant(s, node, *a, *b)) {
    const uint32_t half = vg_load_side(node) / 2;
    double mid[3];
    size_t from, to;
    int o = 0;

    for (int k = 0; k < 3; k++) {
      o |= (lo[k] >= node->at[k] + half) << k;
      if (lo[k] < node->at[k] + half && hi[k] >= node->at[k] + half) return;
    }
    middle(s, node, mid);
    from = first_of(s, *a, *b, mid, o);
    to = o < 7 ? first_of(s, *a, *b, mid, o + 1) : *b;
    if (from == to) return;
    for (int k = 0; k < 3; k++) node->at[k] += o >> k & 1 ? half : 0;
    node->level++;
    *a = from;
    *b = to;
  }
}

static int share_all(struct split *s)
{
  struct vg_load_node node = { .n = s->tree.n_tri };
  size_t a, b;

  if (vg_reserve(&s->stack.item, &s->stack.cap, 3 * node.n + 1,
                 sizeof *s->stack.item))
    return -1;
  for (size_t i = 0; i < node.n; i++) s->stack.item[i] = (uint32_t)i;
  s->stack.n = node.n;
  find_start(s, &node, &a, &b);
  return descend(s, &node, a, b);
}

/* --- children ------------------------------------------------------------ */

/* The parent's octant around x, or close to it, in which a descent ends; it
 * gives the density and the edge length there. */
static const struct vg_load_octant *octant_at(const struct split *s,
                                              const double x[3])
{
  struct vg_load_node node = { .level = 0 };
  size_t a = 0, b = s->parent->n;

  while (b - a > 1 && node.level < VG_LOAD_LEVELS) {
    const uint32_t half = vg_load_side(&node) / 2;
    double mid[3];
    size_t from, to;
    int o = 0;

    middle(s, &node, mid);
    for (int k = 0; k < 3; k++) o |= (x[k] > mid[k]) << k;
    from = first_of(s, a, b, mid, o);
    to = o < 7 ? first_of(s, a, b, mid, o + 1) : b;
    if (from == to) {
      a = from < b ? from : b - 1;
      break;
    }
    for (int k = 0; k < 3; k++) node.at[k] += o >> k & 1 ? half : 0;
    node.level++;
    a = from;
    b = to;
  }
  return &s->parent->octant[a];
}

/* A child that is too small for any sample gets one octant around it. */
static int lone_octant(const struct split *s, const struct vg_front *v,
                       double volume, double correction, struct vg_load *out)
{
  double lo[3], hi[3], x[3], side = 0, old;
  const struct vg_load_octant *near;
  struct vg_load_octant *c;

  vg_load_box(v, lo, hi);
  for (int k = 0; k < 3; k++) {
    x[k] = 0.5 * (lo[k] + hi[k]);
    if (hi[k] - lo[k] > side) side = hi[k] - lo[k];
  }
  if (!s->parent->n || !(volume > 0) || !(side > 0)) return 0;
  c = vg_alloc(1, sizeof *c);
  if (!c) return -1;
  near = octant_at(s, x);
  old = 2 * (double)near->half;
  for (int k = 0; k < 3; k++) c->at[k] = (float)x[k];
  c->half = (float)(0.5 * side);
  c->h = near->h;
  memcpy(c->across, near->across, sizeof c->across);
  c->part = (float)(volume / (side * side * side));
  c->cells = (float)(correction * (double)near->cells * volume /
                     (old * old * old * (double)near->part));
  out->octant = c;
  out->n = 1;
  out->cells = (double)c->cells;
  out->is_block = 0;
  return 0;
}

static void take_share(const struct split *s, const struct share *from,
                       double correction, struct vg_load_octant *to)
{
  const struct vg_load_octant *c = &s->parent->octant[from->octant];

  *to = *c;
  to->part = (float)from->part;
  to->cells = (float)(correction * (double)c->cells * from->part /
                      (double)c->part);
}

static int distribute(const struct split *s, const struct vg_front *child,
                      double correction, struct vg_load *made)
{
  const double volume = vg_load_volume(child);

  vg_load_copy_frame(s->parent, made);
  made->n = s->n_share;
  made->octant = made->n ? vg_alloc(made->n, sizeof *made->octant) : NULL;
  if (made->n && !made->octant) return -1;
  for (size_t i = 0; i < made->n; i++)
    take_share(s, &s->share[i], correction, &made->octant[i]);
  if (made->n) vg_load_fit(made, volume);
  else if (lone_octant(s, child, volume, correction, made)) return -1;
  return vg_load_index(made, 1, NULL) < 0 ? -1 : 0;
}

struct children {
  const struct vg_load *parent;
  const struct vg_front *child;
  double correction;
  struct vg_load *made;
  int *bad;
};

static int split_child(const struct children *w, size_t c)
{
  struct split s = { .parent = w->parent, .stack = VG_LOAD_STACK_INIT };
  int bad;

  memcpy(s.tree.lo, w->parent->lo, sizeof s.tree.lo);
  s.tree.unit = w->parent->unit > 0 ? w->parent->unit : 1;
  bad = vg_load_tree_new(&s.tree, 1, &w->child[c], 1, NULL) < 0 ||
        share_all(&s) ||
        distribute(&s, &w->child[c], w->correction, &w->made[c]);
  free(s.share);
  vg_load_tree_release(&s.tree);
  vg_load_stack_release(&s.stack);
  return bad;
}

static void split_part(void *context, size_t first, size_t end, int worker)
{
  const struct children *w = context;

  (void)worker;
  for (size_t c = first; c < end; c++) w->bad[c] = split_child(w, c);
}

vg_status vg_load_split(const struct vg_load *parent, size_t n,
                        const struct vg_front *child, double correction,
                        const struct vg_engine *e, struct vg_load *out,
                        struct vg_error *err)
{
  struct children w = { parent, child, correction, vg_calloc(n, sizeof *w.made),
                        vg_calloc(n, sizeof *w.bad) };
  int bad = !w.made || !w.bad;

  assert((child && out) || !n);
  assert(correction > 0);
  if (!bad) vg_engine_loop(e, n, 1, split_part, &w);
  for (size_t c = 0; c < n && !bad; c++) bad = w.bad[c];
  if (!bad && n) memcpy(out, w.made, n * sizeof *out);
  for (size_t c = 0; bad && w.made && c < n; c++) vg_load_release(&w.made[c]);
  free(w.made);
  free(w.bad);
  return bad ? vg_fail_memory(err, "the load estimate") : VG_OK;
}
