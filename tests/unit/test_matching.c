/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Matchings: compared with brute force on small graphs, and searched for paths
 * that would add a pair on the triangles of surfaces. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "join_support.h"
#include "layers/expand/matching.h"

#define NONE UINT32_MAX

static void links_open(struct vg_links *l, size_t n)
{
  l->n = n;
  l->to = vg_alloc(n, sizeof *l->to);
  l->weight = vg_calloc(n, sizeof *l->weight);
  shape_need(l->to);
  shape_need(l->weight);
  memset(l->to, 0xff, n * sizeof *l->to);
}

static void links_close(struct vg_links *l)
{
  free(l->to);
  free(l->weight);
}

/* Links two nodes if both have room for a link and have none yet. */
static void join(struct vg_links *l, uint32_t a, uint32_t b, uint16_t weight)
{
  const uint32_t node[2] = { a, b };
  int at[2] = { 0, 0 };

  for (int i = 0; i < 2; i++)
    for (; at[i] < 3 && l->to[node[i]][at[i]] != NONE; at[i]++)
      if (l->to[node[i]][at[i]] == node[1 - i]) return;
  if (a == b || at[0] == 3 || at[1] == 3) return;
  for (int i = 0; i < 2; i++) {
    l->to[node[i]][at[i]] = node[1 - i];
    l->weight[node[i]][at[i]] = weight;
  }
}

static void random_links(struct vg_links *l, size_t n, uint64_t *state)
{
  links_open(l, n);
  for (size_t i = 0; i < 3 * n; i++) {
    const uint32_t a = model_random(state) % (uint32_t)n;
    const uint32_t b = model_random(state) % (uint32_t)n;

    join(l, a, b, (uint16_t)(1 + model_random(state) % 100));
  }
}

static uint32_t weight_of(const struct vg_links *l, size_t a, uint32_t b)
{
  for (int k = 0; k < 3; k++)
    if (l->to[a][k] == b) return l->weight[a][k];
  fail_msg("nodes %zu and %u have no link", a, b);
  return 0;
}

/* Number of pairs; adds their weights. Fails if they are no matching. */
static size_t check_pairs(const struct vg_links *l, const uint32_t *partner,
                          uint32_t *sum)
{
  size_t n = 0;

  *sum = 0;
  for (size_t i = 0; i < l->n; i++) {
    if (partner[i] == NONE) continue;
    assert_true(partner[i] < l->n && partner[partner[i]] == i);
    if (partner[i] < i) continue;
    *sum += weight_of(l, i, partner[i]);
    n++;
  }
  return n;
}

struct most {
  size_t n_pair;
  uint32_t weight; /* Of the matchings with most pairs. */
};

/* All matchings of the nodes from `from` on; used: bits of nodes. */
static struct most best_of(const struct vg_links *l, size_t from, uint32_t used)
{
  struct most best = { 0, 0 };

  while (from < l->n && used >> from & 1) from++;
  if (from == l->n) return best;
  best = best_of(l, from + 1, used);
  for (int k = 0; k < 3; k++) {
    const uint32_t to = l->to[from][k];
    struct most m;

    if (to == NONE || used >> to & 1) continue;
    m = best_of(l, from + 1, used | 1u << from | 1u << to);
    m.n_pair++;
    m.weight += l->weight[from][k];
    if (m.n_pair > best.n_pair ||
        (m.n_pair == best.n_pair && m.weight > best.weight))
      best = m;
  }
  return best;
}

/* Graphs in which no path has more links than are searched: no matching has
 * more pairs. */
static void most_pairs_possible(void **state)
{
  uint64_t seed = 7;
  double share = 0, n_graph = 0;

  (void)state;
  for (int i = 0; i < 3000; i++) {
    uint32_t partner[VG_MATCHING_PATH + 1], sum;
    struct vg_links l;
    struct most most;

    random_links(&l, 2 + (size_t)i % VG_MATCHING_PATH, &seed);
    most = best_of(&l, 0, 0);
    assert_int_equal(vg_links_match(&l, partner, NULL), VG_OK);
    assert_int_equal(check_pairs(&l, partner, &sum), most.n_pair);
    if (most.weight) {
      share += (double)sum / most.weight;
      n_graph++;
    }
    links_close(&l);
  }
  /* Exchanges of cycles and even paths leave little to gain. */
  assert_true(share / n_graph > 0.99);
}

/* Whether a path with n more links leads from a node to another one without
 * partner; path: nodes already on it. Written without the module's search. */
static int leads_on(const struct vg_links *l, const uint32_t *partner,
                    uint32_t *path, int n, int most)
{
  const uint32_t end = path[n - 1];

  for (int k = 0; k < 3; k++) {
    const uint32_t to = l->to[end][k];
    int seen = 0;

    for (int i = 0; i < n && to != NONE; i++) seen |= path[i] == to;
    if (to == NONE || seen || to == partner[end]) continue;
    if (partner[to] == NONE) return 1;
    path[n] = to;
    path[n + 1] = partner[to];
    if (n + 2 <= most && leads_on(l, partner, path, n + 2, most)) return 1;
  }
  return 0;
}

static void check_no_path_is_left(const struct vg_links *l)
{
  uint32_t *partner = vg_alloc(l->n, sizeof *partner), *again, sum;

  again = vg_alloc(l->n, sizeof *again);
  shape_need(partner);
  shape_need(again);
  assert_int_equal(vg_links_match(l, partner, NULL), VG_OK);
  assert_int_equal(vg_links_match(l, again, NULL), VG_OK);
  assert_memory_equal(partner, again, l->n * sizeof *again);
  check_pairs(l, partner, &sum);
  for (size_t i = 0; i < l->n; i++) {
    uint32_t path[VG_MATCHING_PATH + 3];

    path[0] = (uint32_t)i;
    if (partner[i] == NONE)
      assert_false(leads_on(l, partner, path, 1, VG_MATCHING_PATH));
  }
  free(partner);
  free(again);
}

static void no_path_is_left(void **state)
{
  uint64_t seed = 3;

  (void)state;
  for (int i = 0; i < 40; i++) {
    struct vg_links l;

    random_links(&l, 50 + (size_t)i * 20, &seed);
    check_no_path_is_left(&l);
    links_close(&l);
  }
}

/* The triangles of a sphere, with random weights and without some links. */
static void triangles_of_a_surface(void **state)
{
  static const double centre[3] = { 0, 0, 0 };
  struct vg_mesh m = VG_MESH_INIT;
  uint64_t seed = 9;

  (void)state;
  vg_mesh_add_patch(&m, 1, "wall");
  shape_sphere(&m, 12, centre, 1, 1);
  for (uint32_t drop = 0; drop < 40; drop += 5) {
    struct vg_links l;

    links_open(&l, m.n_tri);
    for (uint32_t i = 0; i < m.n_tri; i++)
      for (uint32_t j = 0; j < i; j++) {
        int n = 0;

        for (int k = 0; k < 9; k++) n += m.tri[i][k / 3] == m.tri[j][k % 3];
        if (n == 2 && model_random(&seed) % 100 >= drop)
          join(&l, i, j, (uint16_t)(1 + model_random(&seed) % 1000));
      }
    check_no_path_is_left(&l);
    links_close(&l);
  }
  vg_mesh_release(&m);
}

static void nothing_to_match(void **state)
{
  struct vg_links l;
  uint32_t partner[3];

  (void)state;
  links_open(&l, 3);
  assert_int_equal(vg_links_match(&l, partner, NULL), VG_OK);
  for (int i = 0; i < 3; i++) assert_int_equal(partner[i], NONE);
  l.n = 0;
  assert_int_equal(vg_links_match(&l, partner, NULL), VG_OK);
  links_close(&l);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(most_pairs_possible),
    cmocka_unit_test(no_path_is_left),
    cmocka_unit_test(triangles_of_a_surface),
    cmocka_unit_test(nothing_to_match),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
