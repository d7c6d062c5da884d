/* Tree of boxes about triangles: halved at the median of the longest side of
 * the centres, so that neither very different sizes nor many equal centres
 * unbalance it. Leaves have two to four items, hence fewer nodes than items. */
#include "core/surface_parts.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"

#define LEAF 4

struct entry {
  double mid[3];
  uint32_t face;
};

static void face_box(const struct vg_faces *s, size_t f, double box[6])
{
  for (int k = 0; k < 3; k++) {
    box[k] = box[k + 3] = s->point[s->node[f][0]][k];
    for (int i = 1; i < 3; i++) {
      double x = s->point[s->node[f][i]][k];

      if (x < box[k]) box[k] = x;
      if (x > box[k + 3]) box[k + 3] = x;
    }
  }
}

static int longest_side(const struct entry *e, size_t n)
{
  double lo[3], hi[3];
  int axis = 0;

  memcpy(lo, e[0].mid, sizeof lo);
  memcpy(hi, e[0].mid, sizeof hi);
  for (size_t i = 1; i < n; i++)
    for (int k = 0; k < 3; k++) {
      if (e[i].mid[k] < lo[k]) lo[k] = e[i].mid[k];
      if (e[i].mid[k] > hi[k]) hi[k] = e[i].mid[k];
    }
  for (int k = 1; k < 3; k++)
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  return axis;
}

static double median3(double a, double b, double c)
{
  if (a > b) {
    double t = a;

    a = b;
    b = t;
  }
  return c < a ? a : c > b ? b : c;
}

/* Order e so that the first n / 2 are not above the others along `axis`. */
static void halve(struct entry *e, size_t n, int axis)
{
  size_t lo = 0, hi = n - 1, want = n / 2;

  while (lo < hi) {
    double pivot = median3(e[lo].mid[axis], e[lo + (hi - lo) / 2].mid[axis],
                           e[hi].mid[axis]);
    size_t i = lo, j = hi;

    for (;;) {
      struct entry t;

      while (e[i].mid[axis] < pivot) i++;
      while (e[j].mid[axis] > pivot) j--;
      if (i >= j) break;
      t = e[i];
      e[i++] = e[j];
      e[j--] = t;
    }
    /* e[.. i) <= pivot <= e(j ..], with i - 1 <= j <= i */
    if (j < i) {
      if (want <= j) hi = j;
      else lo = i;
    } else if (want < i) {
      hi = i - 1;
    } else if (want > i) {
      lo = i + 1;
    } else {
      return;
    }
  }
}

static uint32_t build(struct vg_tree *t, const struct vg_faces *s,
                      struct entry *e, size_t first, size_t n)
{
  uint32_t at = (uint32_t)t->n_node++;
  struct vg_tree_node *node = &t->node[at];

  if (n > LEAF) {
    halve(e + first, n, longest_side(e + first, n));
    node->n = 0;
    build(t, s, e, first, n / 2);
    node->right = build(t, s, e, first + n / 2, n - n / 2);
    for (int k = 0; k < 3; k++) {
      const struct vg_tree_node *l = node + 1, *r = &t->node[node->right];

      node->lo[k] = l->lo[k] < r->lo[k] ? l->lo[k] : r->lo[k];
      node->hi[k] = l->hi[k] > r->hi[k] ? l->hi[k] : r->hi[k];
    }
    return at;
  }
  node->first = (uint32_t)first;
  node->n = (uint32_t)n;
  for (size_t i = first; i < first + n; i++) {
    double *box = t->box[i];

    t->item[i] = e[i].face;
    face_box(s, e[i].face, box);
    for (int k = 0; k < 3; k++) {
      if (i == first || box[k] < node->lo[k]) node->lo[k] = box[k];
      if (i == first || box[k + 3] > node->hi[k]) node->hi[k] = box[k + 3];
    }
  }
  return at;
}

vg_status vg_tree_build(struct vg_tree *t, const struct vg_faces *s,
                        struct vg_error *err)
{
  struct entry *e;
  size_t n = 0;

  for (size_t f = 0; f < s->n; f++) n += s->state[f] == 0;
  e = vg_alloc(n, sizeof *e);
  t->item = vg_alloc(n, sizeof *t->item);
  t->box = vg_alloc(n, sizeof *t->box);
  t->node = vg_alloc(n, sizeof *t->node);
  if (!e || !t->item || !t->box || !t->node) {
    free(e);
    vg_tree_release(t);
    return vg_fail_memory(err, "the search tree of the surface");
  }
  t->n_item = n;
  t->n_node = 0;
  n = 0;
  for (size_t f = 0; f < s->n; f++) {
    double box[6];

    if (s->state[f]) continue;
    face_box(s, f, box);
    for (int k = 0; k < 3; k++) e[n].mid[k] = .5 * box[k] + .5 * box[k + 3];
    e[n++].face = (uint32_t)f;
  }
  if (n) build(t, s, e, 0, n);
  free(e);
  return VG_OK;
}

void vg_tree_release(struct vg_tree *t)
{
  free(t->item);
  free(t->box);
  free(t->node);
  memset(t, 0, sizeof *t);
}

struct pairs {
  const struct vg_tree *t;
  vg_status (*visit)(void *, uint32_t, uint32_t);
  void *context;
};

static int boxes_touch(const double *alo, const double *ahi,
                       const double *blo, const double *bhi)
{
  return alo[0] <= bhi[0] && blo[0] <= ahi[0] && alo[1] <= bhi[1]
         && blo[1] <= ahi[1] && alo[2] <= bhi[2] && blo[2] <= ahi[2];
}

static vg_status leaf_pairs(const struct pairs *p,
                            const struct vg_tree_node *a,
                            const struct vg_tree_node *b)
{
  const struct vg_tree *t = p->t;

  for (uint32_t i = a->first; i < a->first + a->n; i++) {
    const double *x = t->box[i];

    for (uint32_t j = a == b ? i + 1 : b->first; j < b->first + b->n; j++) {
      const double *y = t->box[j];

      if (boxes_touch(x, x + 3, y, y + 3)) {
        vg_status st = p->visit(p->context, t->item[i], t->item[j]);

        if (st < 0) return st;
      }
    }
  }
  return VG_OK;
}

static double extent(const struct vg_tree_node *n)
{
  double m = n->hi[0] - n->lo[0];

  for (int k = 1; k < 3; k++)
    if (n->hi[k] - n->lo[k] > m) m = n->hi[k] - n->lo[k];
  return m;
}

/* Pairs with one item below a and one below b; a == b: within a. */
static vg_status pairs_below(const struct pairs *p,
                             const struct vg_tree_node *a,
                             const struct vg_tree_node *b)
{
  const struct vg_tree_node *node = p->t->node;
  vg_status st = VG_OK;

  if (a == b) {
    if (a->n) return leaf_pairs(p, a, a);
    VG_TRY(pairs_below(p, a + 1, a + 1));
    VG_TRY(pairs_below(p, &node[a->right], &node[a->right]));
    return pairs_below(p, a + 1, &node[a->right]);
  }
  if (!boxes_touch(a->lo, a->hi, b->lo, b->hi)) return VG_OK;
  if (a->n && b->n) return leaf_pairs(p, a, b);
  if (a->n || (!b->n && extent(b) > extent(a))) {
    VG_TRY(pairs_below(p, a, b + 1));
    return pairs_below(p, a, &node[b->right]);
  }
  VG_TRY(pairs_below(p, a + 1, b));
  return pairs_below(p, &node[a->right], b);
done:
  return st;
}

vg_status vg_tree_pairs(const struct vg_tree *t,
                        vg_status (*visit)(void *, uint32_t, uint32_t),
                        void *context)
{
  struct pairs p = { t, visit, context };

  return t->n_node ? pairs_below(&p, t->node, t->node) : VG_OK;
}

static int ray_meets(const double *lo, const double *hi, const double p[3])
{
  return lo[0] <= p[0] && lo[1] <= p[1] && p[1] <= hi[1] && lo[2] <= p[2]
         && p[2] <= hi[2];
}

static vg_status ray_below(const struct vg_tree *t, const double p[3],
                           const struct vg_tree_node *a,
                           vg_status (*visit)(void *, uint32_t),
                           void *context)
{
  vg_status st = VG_OK;

  if (!ray_meets(a->lo, a->hi, p)) return VG_OK;
  if (!a->n) {
    VG_TRY(ray_below(t, p, a + 1, visit, context));
    return ray_below(t, p, &t->node[a->right], visit, context);
  }
  for (uint32_t i = a->first; i < a->first + a->n; i++)
    if (ray_meets(t->box[i], t->box[i] + 3, p))
      VG_TRY(visit(context, t->item[i]));
done:
  return st;
}

vg_status vg_tree_ray(const struct vg_tree *t, const double p[3],
                      vg_status (*visit)(void *, uint32_t), void *context)
{
  return t->n_node ? ray_below(t, p, t->node, visit, context) : VG_OK;
}
