/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Copies of a sizing field: one shared by the ranks of a node, and a coarser
 * one. */
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/sizing/sizing_octree.h"

/* --- shared copy ---------------------------------------------------------- */

/* The scalar members, the tree, its smallest spacings, the leaves, their
 * tensors, the bounds of these. */
enum { PARTS = 6 };

static struct vg_bytes part(size_t n, const void *data)
{
  return (struct vg_bytes){ n, (unsigned char *)(uintptr_t)data };
}

static void list_parts(const struct vg_sizing *s, struct vg_bytes p[PARTS])
{
  const struct vg_octree *t = &s->octree;

  p[0] = part(sizeof *s, s);
  p[1] = part(t->n_split * sizeof *t->child, t->child);
  p[2] = part(t->n_split * sizeof *t->least, t->least);
  p[3] = part(t->n_leaf * sizeof *t->leaf, t->leaf);
  p[4] = part(t->n_tensor * sizeof *t->tensor, t->tensor);
  p[5] = part(t->is_stretched ? t->n_split * sizeof *t->bounds : 0, t->bounds);
}

void vg_sizing_show(const struct vg_sizing *s,
                    void (*look)(void *user, size_t n, const void *data),
                    void *user)
{
  struct vg_bytes p[PARTS];

  list_parts(s, p);
  look(user, sizeof s->octree.lo, s->octree.lo);
  look(user, sizeof s->octree.side, &s->octree.side);
  look(user, sizeof s->growth, &s->growth);
  look(user, sizeof s->cap, &s->cap);
  for (int k = 1; k < PARTS - 1; k++)
    if (k < 4 || p[k].n) look(user, p[k].n, p[k].data);
}

/* Takes over the shared memory. Returns NULL if memory is refused. */
static struct vg_sizing *view(const struct vg_shmem *common)
{
  struct vg_sizing *s = vg_alloc(1, sizeof *s);
  unsigned char *at = (unsigned char *)(uintptr_t)common->data;
  struct vg_bytes p[PARTS];

  if (!s) return NULL;
  memcpy(s, at, sizeof *s);
  s->common = *common;
  list_parts(s, p);
  at += vg_shmem_padded(p[0].n);
  s->octree.child = (void *)at;
  at += vg_shmem_padded(p[1].n);
  s->octree.least = (void *)at;
  at += vg_shmem_padded(p[2].n);
  s->octree.leaf = (void *)at;
  at += vg_shmem_padded(p[3].n);
  s->octree.tensor = (void *)at;
  at += vg_shmem_padded(p[4].n);
  s->octree.bounds = p[5].n ? (void *)at : NULL;
  return s;
}

vg_status vg_sizing_share(struct vg_comm *c, struct vg_sizing **s,
                          struct vg_error *err)
{
  struct vg_bytes p[PARTS];
  struct vg_shmem common;
  struct vg_sizing *got;
  vg_status st;

  if (vg_comm_node_size(c) == 1) return VG_OK;
  if (!vg_comm_node_rank(c)) list_parts(*s, p);
  st = vg_comm_node_shmem(c, PARTS, p, &common, err);
  if (st < 0) return st;
  got = view(&common);
  if (!got) {
    vg_shmem_release(&common);
    return vg_fail_memory(err, "the sizing field");
  }
  vg_sizing_free(*s);
  *s = got;
  return VG_OK;
}

size_t vg_sizing_shmem(const struct vg_sizing *s)
{
  return vg_shared_bytes(&s->common);
}

/* --- coarser copy --------------------------------------------------------- */

struct coarsening {
  const struct vg_sizing *from, *most;
  double factor;
  struct vg_octree *to;
};

static float size_at(const struct coarsening *c, const double x[3], float h)
{
  return (float)fmin(c->factor * (double)h, vg_sizing_at(c->most, x));
}

static void tensor_at(const struct coarsening *c, const double x[3],
                      const float from[6], float to[6])
{
  struct vg_size_limits l = { 0, vg_sizing_at(c->most, x), INFINITY };
  double h[6], range[2];

  for (int k = 0; k < 6; k++) h[k] = c->factor * (double)from[k];
  vg_size_limit(h, &l, range);
  for (int k = 0; k < 6; k++) to[k] = (float)h[k];
}

/* Coarsen corner i, at x, of the leaf of entry e. Returns its spacing. */
static float coarsen_corner(const struct coarsening *c, uint32_t e, int i,
                            const double x[3])
{
  union vg_octree_leaf *leaf = c->to->leaf + (e & VG_OCTREE_LEAF_INDEX);
  const struct vg_octree *from = &c->from->octree;
  double h[6];
  float *to;

  if (!(e & VG_OCTREE_TENSOR)) return leaf->h[i] = size_at(c, x, leaf->h[i]);
  to = c->to->tensor[leaf->corner[i]];
  tensor_at(c, x, from->tensor[leaf->corner[i]], to);
  for (int k = 0; k < 6; k++) h[k] = (double)to[k];
  return (float)vg_size_mean(h);
}

/* Coarsen entry e of the tree, the cube at lo. Returns the smallest spacing in
 * it. */
static float coarsen(const struct coarsening *c, uint32_t e, const double lo[3],
                     double side)
{
  float least = INFINITY;
  double x[3];

  for (int i = 0; i < 8; i++) {
    double part = e & VG_OCTREE_LEAF ? side : 0.5 * side;
    float h;

    for (int k = 0; k < 3; k++) x[k] = lo[k] + (i >> k & 1 ? part : 0);
    h = e & VG_OCTREE_LEAF ? coarsen_corner(c, e, i, x)
                           : coarsen(c, c->to->child[e][i], x, part);
    if (h < least) least = h;
  }
  if (!(e & VG_OCTREE_LEAF)) c->to->least[e] = least;
  return least;
}

static void *copy_of(const void *from, size_t n, size_t size)
{
  void *to = vg_alloc(n, size);

  if (to && n) memcpy(to, from, n * size);
  return to;
}

vg_status vg_sizing_coarsened(const struct vg_sizing *s, double factor,
                              const struct vg_sizing *most,
                              struct vg_sizing **out, struct vg_error *err)
{
  assert(s && most && out && factor >= 1);
  assert(!most->octree.is_stretched);

  struct vg_sizing *to = copy_of(s, 1, sizeof *s);
  const struct vg_octree *t = &s->octree;
  struct coarsening c = { s, most, factor, to ? &to->octree : NULL };

  if (!to) return vg_fail_memory(err, "the sizing field");
  to->octree.child = copy_of(t->child, t->n_split, sizeof *t->child);
  to->octree.least = copy_of(t->least, t->n_split, sizeof *t->least);
  to->octree.leaf = copy_of(t->leaf, t->n_leaf, sizeof *t->leaf);
  to->octree.tensor = copy_of(t->tensor, t->n_tensor, sizeof *t->tensor);
  to->octree.bounds = NULL;
  memset(&to->common, 0, sizeof to->common);
  if (!to->octree.child || !to->octree.least || !to->octree.leaf ||
      !to->octree.tensor) {
    vg_sizing_free(to);
    return vg_fail_memory(err, "the sizing field");
  }
  to->least = (double)coarsen(&c, t->root, t->lo, t->side);
  to->most = fmin(factor * s->most, most->most);
  to->growth = fmin(factor * s->growth, most->growth);
  to->cap = fmin(factor * s->cap, most->cap);
  to->slope = fmax(factor * s->slope, most->slope);
  if (t->is_stretched && vg_octree_bounds(&to->octree, 1, err)) {
    vg_sizing_free(to);
    return VG_ERR_MEMORY;
  }
  *out = to;
  return VG_OK;
}
