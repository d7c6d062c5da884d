/* Tree of boxes about triangles: halved at the median of the longest side of
 * the centres, so that neither very different sizes nor many equal centres
 * unbalance it. Leaves have two to four items, hence fewer nodes than items. */
#include "core/surface/surface_parts.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/parallel.h"

#define LEAF 4
#define BRANCHES 256   /* parts of a tree that are built at the same time */
#define ALONE 2048     /* items at least in one */
#define TASKS 1024     /* pairs of nodes that are searched at the same time */

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

/* What is being built. */
struct plan {
  struct vg_aabb_tree *t;
  const struct vg_faces *s;
  struct entry *e;
  struct branch *branch;
};

/* Items first .. first + n - 1 below node `at`. */
struct branch {
  size_t at, first, n;
};

static void build_leaf(const struct plan *p, const struct branch *b)
{
  struct vg_aabb_tree_node *node = &p->t->node[b->at];

  node->first = (uint32_t)b->first;
  node->n = (uint32_t)b->n;
  for (size_t i = b->first; i < b->first + b->n; i++) {
    double *box = p->t->box[i];

    p->t->item[i] = p->e[i].face;
    face_box(p->s, p->e[i].face, box);
    for (int k = 0; k < 3; k++) {
      if (i == b->first || box[k] < node->lo[k]) node->lo[k] = box[k];
      if (i == b->first || box[k + 3] > node->hi[k])
        node->hi[k] = box[k + 3];
    }
  }
}

/* The box of an inner node, once those below have theirs. */
static void join_boxes(struct vg_aabb_tree_node *all, size_t at)
{
  struct vg_aabb_tree_node *node = &all[at];
  const struct vg_aabb_tree_node *l = node + 1, *r = &all[node->right];

  for (int k = 0; k < 3; k++) {
    node->lo[k] = l->lo[k] < r->lo[k] ? l->lo[k] : r->lo[k];
    node->hi[k] = l->hi[k] > r->hi[k] ? l->hi[k] : r->hi[k];
  }
}

/* Returns the first node behind those of the branch. */
static size_t build(const struct plan *p, struct branch b)
{
  struct vg_aabb_tree_node *node = &p->t->node[b.at];
  size_t half = b.n / 2, end;

  if (b.n <= LEAF) {
    build_leaf(p, &b);
    return b.at + 1;
  }
  halve(p->e + b.first, b.n, longest_side(p->e + b.first, b.n));
  node->n = 0;
  end = build(p, (struct branch){ b.at + 1, b.first, half });
  node->right = (uint32_t)end;
  end = build(p, (struct branch){ end, b.first + half, b.n - half });
  join_boxes(p->t->node, b.at);
  return end;
}

static size_t count_nodes(size_t n)
{
  return n <= LEAF ? 1 : 1 + count_nodes(n / 2) + count_nodes(n - n / 2);
}

/* Branch i becomes 2 i and 2 i + 1. */
static void halve_body(void *context, size_t first, size_t end, int worker)
{
  const struct plan *p = context;

  (void)worker;
  for (size_t i = first; i < end; i++) {
    struct branch *l = &p->branch[2 * i], *r = l + 1;
    struct entry *e = p->e + l->first;

    halve(e, l->n, longest_side(e, l->n));
    r->n = l->n - l->n / 2;
    l->n /= 2;
    r->first = l->first + l->n;
    r->at = l->at + 1 + count_nodes(l->n);
    p->t->node[l->at].n = 0;
    p->t->node[l->at++].right = (uint32_t)r->at;
  }
}

static void build_body(void *context, size_t first, size_t end, int worker)
{
  const struct plan *p = context;

  (void)worker;
  for (size_t i = first; i < end; i++) build(p, p->branch[i]);
}

/* Inner nodes above the branches, whose boxes are known: `levels` of them. */
static void join_top(struct vg_aabb_tree_node *all, size_t at, int levels)
{
  if (!levels) return;
  join_top(all, at + 1, levels - 1);
  join_top(all, all[at].right, levels - 1);
  join_boxes(all, at);
}

/* The upper levels round by round, then the branches one by one. */
static void build_all(struct plan *p, int threads)
{
  size_t n_branch = 1;
  int levels = 0;

  p->branch[0] = (struct branch){ 0, 0, p->t->n_item };
  for (; n_branch < BRANCHES && p->t->n_item / n_branch > ALONE; levels++) {
    for (size_t i = n_branch; i-- > 0;) p->branch[2 * i] = p->branch[i];
    vg_parallel_for(threads, n_branch, 1, halve_body, p);
    n_branch *= 2;
  }
  vg_parallel_for(threads, n_branch, 1, build_body, p);
  join_top(p->t->node, 0, levels);
  p->t->n_node = count_nodes(p->t->n_item);
}

vg_status vg_aabb_tree_build(struct vg_aabb_tree *t, const struct vg_faces *s,
                             int threads, struct vg_error *err)
{
  struct branch branch[BRANCHES];
  struct plan plan = { t, s, NULL, branch };
  struct entry *e;
  size_t n = 0;

  assert(!t->item && !t->node && threads >= 0);
  for (size_t f = 0; f < s->n; f++) n += s->state[f] == 0;
  e = vg_alloc(n, sizeof *e);
  t->item = vg_alloc(n, sizeof *t->item);
  t->box = vg_alloc(n, sizeof *t->box);
  t->node = vg_alloc(n, sizeof *t->node);
  if (!e || !t->item || !t->box || !t->node) {
    free(e);
    vg_aabb_tree_release(t);
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
  plan.e = e;
  if (n) build_all(&plan, threads);
  free(e);
  return VG_OK;
}

void vg_aabb_tree_release(struct vg_aabb_tree *t)
{
  free(t->item);
  free(t->box);
  free(t->node);
  memset(t, 0, sizeof *t);
}

/* Items below one node with those below another; the same: within it. */
struct task {
  const struct vg_aabb_tree_node *a, *b;
};

struct pairs {
  const struct vg_aabb_tree *t;
  vg_aabb_tree_visit visit;
  void *context;
  size_t n_task, cap_task;
  struct task *task;
  int status;                /* of a visit that failed */
};

static int boxes_touch(const double *alo, const double *ahi,
                       const double *blo, const double *bhi)
{
  return alo[0] <= bhi[0] && blo[0] <= ahi[0] && alo[1] <= bhi[1]
         && blo[1] <= ahi[1] && alo[2] <= bhi[2] && blo[2] <= ahi[2];
}

static vg_status leaf_pairs(const struct pairs *p, int worker,
                            const struct vg_aabb_tree_node *a,
                            const struct vg_aabb_tree_node *b)
{
  const struct vg_aabb_tree *t = p->t;

  for (uint32_t i = a->first; i < a->first + a->n; i++) {
    const double *x = t->box[i];

    for (uint32_t j = a == b ? i + 1 : b->first; j < b->first + b->n; j++) {
      const double *y = t->box[j];

      if (boxes_touch(x, x + 3, y, y + 3)) {
        vg_status st = p->visit(p->context, worker, t->item[i],
                                t->item[j]);

        if (st < 0) return st;
      }
    }
  }
  return VG_OK;
}

static double extent(const struct vg_aabb_tree_node *n)
{
  double m = n->hi[0] - n->lo[0];

  for (int k = 1; k < 3; k++)
    if (n->hi[k] - n->lo[k] > m) m = n->hi[k] - n->lo[k];
  return m;
}

/* What a pair of nodes is made of: 0 to 3 tasks, in order; -1 where both are
 * leaves. */
static int parts_of(const struct pairs *p, struct task of, struct task out[3])
{
  const struct vg_aabb_tree_node *node = p->t->node, *a = of.a, *b = of.b;

  if (a == b && a->n) return -1;
  if (a == b) {
    out[0] = (struct task){ a + 1, a + 1 };
    out[1] = (struct task){ &node[a->right], &node[a->right] };
    out[2] = (struct task){ a + 1, &node[a->right] };
    return 3;
  }
  if (!boxes_touch(a->lo, a->hi, b->lo, b->hi)) return 0;
  if (a->n && b->n) return -1;
  if (a->n || (!b->n && extent(b) > extent(a))) {
    out[0] = (struct task){ a, b + 1 };
    out[1] = (struct task){ a, &node[b->right] };
  } else {
    out[0] = (struct task){ a + 1, b };
    out[1] = (struct task){ &node[a->right], b };
  }
  return 2;
}

static vg_status pairs_below(const struct pairs *p, int worker,
                             struct task of)
{
  struct task part[3];
  int n = parts_of(p, of, part);
  vg_status st = VG_OK;

  if (n < 0) return leaf_pairs(p, worker, of.a, of.b);
  for (int i = 0; i < n && st >= 0; i++)
    st = pairs_below(p, worker, part[i]);
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

/* Take the tasks apart, all of them at a time, until they are enough. */
static vg_status list_tasks(struct pairs *p)
{
  struct task *old = NULL;
  size_t n_old, cap_old = 0;
  int changed = 1;

  if (vg_reserve(&p->task, &p->cap_task, 1, sizeof *p->task))
    return VG_ERR_MEMORY;
  p->task[p->n_task++] = (struct task){ p->t->node, p->t->node };
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

int vg_aabb_tree_workers(int threads)
{
  int n = threads > 0 ? threads : vg_cores();

  return n < TASKS ? n : TASKS;
}

vg_status vg_aabb_tree_pairs(const struct vg_aabb_tree *t, int threads,
                             vg_aabb_tree_visit visit, void *context)
{
  struct pairs p = { .t = t, .visit = visit, .context = context };
  vg_status st = VG_OK;

  assert(visit && threads >= 0);
  if (!t->n_node) return VG_OK;
  if (threads == 1)
    return pairs_below(&p, 0, (struct task){ t->node, t->node });
  st = list_tasks(&p);
  if (st >= 0) {
    vg_parallel_for(vg_aabb_tree_workers(threads), p.n_task, 1, pairs_body, &p);
    st = (vg_status)p.status;
  }
  free(p.task);
  return st;
}

static int ray_meets(const double *lo, const double *hi, const double p[3])
{
  return lo[0] <= p[0] && lo[1] <= p[1] && p[1] <= hi[1] && lo[2] <= p[2]
         && p[2] <= hi[2];
}

static vg_status ray_below(const struct vg_aabb_tree *t, const double p[3],
                           const struct vg_aabb_tree_node *a,
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

vg_status vg_aabb_tree_ray(const struct vg_aabb_tree *t, const double p[3],
                           vg_status (*visit)(void *, uint32_t), void *context)
{
  assert(visit);
  return t->n_node ? ray_below(t, p, t->node, visit, context) : VG_OK;
}
