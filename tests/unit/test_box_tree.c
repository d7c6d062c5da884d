/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Trees of boxes: every answer equals that of a loop over all boxes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "core/search/box_pairs.h"
#include "core/search/box_tree.h"

/* A grid of 1/8 gives equal distances and boxes that touch in a plane. */
enum { GRID = 8, MOST = 700, WORKERS = 3 };

static double draw(uint64_t *seed)
{
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1p-53;
}

static double draw_on_grid(uint64_t *seed)
{
  return (double)(int)(draw(seed) * 6 * GRID) / GRID;
}

static void draw_boxes(size_t n, struct vg_box *box, uint64_t *seed)
{
  for (size_t i = 0; i < n; i++) {
    const int coarse = i % 3 == 0;
    double x[3];

    box[i] = (struct vg_box)VG_BOX_EMPTY;
    for (int end = 0; end < 2; end++) {
      for (int k = 0; k < 3; k++)
        x[k] = coarse ? draw_on_grid(seed)
             : end    ? box[i].lo[k] + draw(seed) * .3
                      : draw(seed) * 6;
      vg_box_add(&box[i], x);
    }
  }
}

static struct vg_box_tree build(size_t n, const struct vg_box *box,
                                const uint32_t *order)
{
  struct vg_box_tree t = VG_BOX_TREE_INIT;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_box_tree_build_items(&t, n, box, order, &err) < 0)
    fail_msg("%s", err.text);
  return t;
}

/* Every item is in one leaf, and every node's box is the smallest that encloses
 * its items. */
static void expect_sound(const struct vg_box_tree *t, const struct vg_box *box)
{
  uint8_t *seen = vg_calloc(t->n, 1);

  for (size_t i = 0; i < t->n; i++) {
    assert_false(seen[t->item[i]]);
    seen[t->item[i]] = 1;
    assert_memory_equal(&t->box[i], &box[t->item[i]], sizeof *box);
  }
  for (size_t i = 0; i <= 2 * t->first_leaf; i++) {
    struct vg_box b = VG_BOX_EMPTY;

    if (i < t->first_leaf) {
      vg_box_join(&b, vg_box_tree_node(t, 2 * i + 1));
      vg_box_join(&b, vg_box_tree_node(t, 2 * i + 2));
    } else {
      for (size_t k = vg_box_tree_first(t, i); k < vg_box_tree_end(t, i); k++)
        vg_box_join(&b, &t->box[k]);
    }
    assert_memory_equal(&b, vg_box_tree_node(t, i), sizeof b);
  }
  free(seen);
}

struct list {
  size_t n, most;
  uint32_t item[MOST];
};

static int append(void *context, uint32_t item)
{
  struct list *l = context;

  l->item[l->n++] = item;
  return l->n == l->most;
}

/* All items that touch the box, in the order of the leaves. */
static void expect_touched(const struct vg_box_tree *t,
                           const struct vg_box *box, const struct vg_box *q)
{
  struct list found = { 0 }, want = { 0 };

  assert_int_equal(vg_box_tree_touched(t, q, append, &found), 0);
  for (size_t i = 0; i < t->n; i++)
    if (vg_box_touch(&box[t->item[i]], q)) append(&want, t->item[i]);
  assert_int_equal(found.n, want.n);
  assert_memory_equal(found.item, want.item, want.n * sizeof *want.item);
  if (!want.n) return;
  /* a visit that returns 1 is the last */
  found.n = 0;
  found.most = (want.n + 1) / 2;
  assert_int_equal(vg_box_tree_touched(t, q, append, &found), 1);
  assert_int_equal(found.n, found.most);
}

/* The nearest box; if several are equally near, the one with the lowest
 * number. */
struct nearest {
  const struct vg_box_tree *t;
  const double *x;
  double d2;
  uint32_t item;
};

static int enter(void *context, size_t node, double d2)
{
  const struct nearest *f = context;

  assert_true(d2 == vg_box_distance2(vg_box_tree_node(f->t, node), f->x));
  return d2 <= f->d2;
}

static void leaf(void *context, size_t node)
{
  struct nearest *f = context;

  for (size_t i = vg_box_tree_first(f->t, node);
       i < vg_box_tree_end(f->t, node); i++) {
    double d2 = vg_box_distance2(&f->t->box[i], f->x);

    if (d2 > f->d2 || (d2 == f->d2 && f->t->item[i] > f->item)) continue;
    f->d2 = d2;
    f->item = f->t->item[i];
  }
}

static void expect_nearest(const struct vg_box_tree *t,
                           const struct vg_box *box, const double x[3])
{
  struct nearest f = { t, x, INFINITY, UINT32_MAX };
  double best = INFINITY;
  uint32_t want = UINT32_MAX;

  vg_box_tree_approach(t, x, enter, leaf, &f);
  for (uint32_t i = 0; i < t->n; i++) {
    double d2 = 0;

    for (int k = 0; k < 3; k++) {
      double d = fmax(fmax(box[i].lo[k] - x[k], x[k] - box[i].hi[k]), 0);

      d2 += d * d;
    }
    if (d2 < best) best = d2, want = i;
  }
  assert_true(f.d2 == best);
  assert_int_equal(f.item, want);
}

/* Number of visits of each pair, by all threads. */
struct table {
  size_t n;
  uint8_t *seen; /* [n n] */
};

static vg_status count_pair(void *context, int worker, uint32_t a, uint32_t b)
{
  struct table *p = context;

  if (worker < 0 || worker >= vg_box_tree_workers(WORKERS)) abort();
  __atomic_fetch_add(&p->seen[p->n * (a < b ? a : b) + (a < b ? b : a)], 1,
                     __ATOMIC_RELAXED);
  return VG_OK;
}

static void expect_pairs(const struct vg_box_tree *t, const struct vg_box *box,
                         int threads)
{
  struct table p = { t->n, vg_calloc(t->n * t->n, 1) };

  assert_int_equal(vg_box_tree_pairs(t, threads, count_pair, &p), VG_OK);
  for (size_t i = 0; i < t->n; i++)
    for (size_t k = 0; k < t->n; k++)
      assert_int_equal(p.seen[t->n * i + k],
                       i < k && vg_box_touch(&box[i], &box[k]));
  free(p.seen);
}

static void results_equal_those_of_a_linear_search(void **state)
{
  static const size_t size[] = { 0, 1, 2, 4, 5, 8, 9, 31, 64, 65, 300, MOST };
  struct vg_box box[MOST], q[8];
  uint64_t seed = 1;

  (void)state;
  for (size_t s = 0; s < sizeof size / sizeof *size; s++) {
    struct vg_box_tree t;

    draw_boxes(size[s], box, &seed);
    t = build(size[s], box, NULL);
    expect_sound(&t, box);
    for (int round = 0; round < 40; round++) {
      double x[3];

      draw_boxes(8, q, &seed);
      for (int k = 0; k < 8; k++) expect_touched(&t, box, &q[k]);
      for (int k = 0; k < 3; k++)
        x[k] = round % 2 ? draw_on_grid(&seed) : 8 * draw(&seed) - 1;
      expect_nearest(&t, box, x);
    }
    expect_pairs(&t, box, 1);
    expect_pairs(&t, box, WORKERS);
    vg_box_tree_release(&t);
  }
}

/* A tree that was never built finds nothing, and can be released. */
static void an_empty_tree_has_no_items(void **state)
{
  const double x[3] = { 0, 0, 0 };
  const struct vg_box all = { { -1, -1, -1 }, { 1, 1, 1 } };
  struct vg_box_tree t = VG_BOX_TREE_INIT;

  (void)state;
  expect_touched(&t, NULL, &all);
  expect_nearest(&t, NULL, x);
  expect_pairs(&t, NULL, 1);
  vg_box_tree_release(&t);
}

static void the_order_of_the_caller_is_kept(void **state)
{
  struct vg_box box[MOST];
  uint32_t order[MOST];
  struct vg_box_tree t;
  uint64_t seed = 7;

  (void)state;
  draw_boxes(MOST, box, &seed);
  for (uint32_t i = 0; i < MOST; i++) order[i] = (i * 3 + 5) % MOST;
  t = build(MOST, box, order);
  assert_memory_equal(t.item, order, sizeof order);
  expect_sound(&t, box);
  expect_touched(&t, box, vg_box_tree_node(&t, 0));
  vg_box_tree_release(&t);
}

static vg_status stop_at_ten(void *context, int worker, uint32_t a, uint32_t b)
{
  int *n = context;

  (void)worker;
  (void)a;
  (void)b;
  return __atomic_add_fetch(n, 1, __ATOMIC_RELAXED) >= 10 ? VG_ERR_STOPPED
                                                          : VG_OK;
}

static void a_failed_visit_ends_the_search_for_pairs(void **state)
{
  struct vg_box box[MOST];
  uint64_t seed = 3;

  (void)state;
  draw_boxes(MOST, box, &seed);
  for (int threads = 1; threads <= WORKERS; threads += WORKERS - 1) {
    struct vg_box_tree t = build(MOST, box, NULL);
    int n = 0;

    assert_int_equal(vg_box_tree_pairs(&t, threads, stop_at_ten, &n),
                     VG_ERR_STOPPED);
    /* each thread may have one more */
    assert_true(n >= 10 && n < 10 + threads);
    vg_box_tree_release(&t);
  }
}

/* Sum of the longest sides of the leaves. */
static double leaf_sides(const struct vg_box_tree *t)
{
  double sum = 0;

  for (size_t i = t->first_leaf; i <= 2 * t->first_leaf; i++) {
    const struct vg_box *b = vg_box_tree_node(t, i);

    if (b->lo[0] > b->hi[0] || b->hi[0] > 1e6) continue;
    sum += fmax(b->hi[0] - b->lo[0],
                fmax(b->hi[1] - b->lo[1], b->hi[2] - b->lo[2]));
  }
  return sum;
}

/* One box at 1e12 moves all others into a single cell of the Hilbert curve. If
 * they were not ordered by a second curve, their leaves would be as large as
 * the space. */
static void one_box_far_away_does_not_spoil_the_order(void **state)
{
  struct vg_box box[MOST];
  uint32_t order[2][MOST];
  double sides[3];
  uint64_t seed = 11;

  (void)state;
  draw_boxes(MOST, box, &seed);
  for (int i = 0; i < MOST; i++) /* points: sides are those of leaves alone */
    memcpy(box[i].hi, box[i].lo, sizeof box[i].hi);
  for (int far = 0; far < 3; far++) {
    struct vg_error err = VG_ERROR_INIT;
    struct vg_box_tree t;

    for (int k = 0; k < 3 && far; k++) box[9].lo[k] = box[9].hi[k] = 1e12;
    if (far < 2)
      assert_int_equal(vg_box_order(MOST, box, order[far], &err), VG_OK);
    t = build(MOST, box, far < 2 ? order[far] : NULL);
    expect_sound(&t, box);
    sides[far] = leaf_sides(&t);
    vg_box_tree_release(&t);
  }
  /* except for the leaf with the far box: at most 2 % of 175 leaves */
  assert_true(fabs(sides[1] - sides[0]) < .02 * sides[0]);
  assert_true(sides[2] > 2 * sides[0]);
}

/* Nodes with data in addition to the box. */
struct counted {
  struct vg_box box;
  size_t n;
};

static void nodes_may_have_more_than_boxes(void **state)
{
  struct vg_box box[MOST];
  struct vg_error err = VG_ERROR_INIT;
  struct vg_box_tree t;
  struct counted *node;
  uint64_t seed = 5;

  (void)state;
  draw_boxes(MOST, box, &seed);
  assert_int_equal(vg_box_tree_build(&t, MOST, box, NULL, sizeof *node, &err),
                   VG_OK);
  assert_null(t.box);
  node = t.node;
  for (size_t i = 2 * t.first_leaf + 1; i-- > 0;)
    if (i < t.first_leaf) node[i].n = node[2 * i + 1].n + node[2 * i + 2].n;
    else
      node[i].n = vg_box_tree_end(&t, i) > vg_box_tree_first(&t, i)
                  ? vg_box_tree_end(&t, i) - vg_box_tree_first(&t, i)
                  : 0;
  assert_int_equal(node[0].n, MOST);
  for (int k = 0; k < MOST; k++) vg_box_join(&box[0], &box[k]);
  assert_memory_equal(&node[0].box, &box[0], sizeof box[0]);
  vg_box_tree_release(&t);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(results_equal_those_of_a_linear_search),
    cmocka_unit_test(an_empty_tree_has_no_items),
    cmocka_unit_test(the_order_of_the_caller_is_kept),
    cmocka_unit_test(a_failed_visit_ends_the_search_for_pairs),
    cmocka_unit_test(one_box_far_away_does_not_spoil_the_order),
    cmocka_unit_test(nodes_may_have_more_than_boxes),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
