/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Graphs partitioned by METIS: balanced, few edges cut, each part connected,
 * reproducible; graphs that cannot be partitioned are refused. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "partition/graph/bisect.h"
#include "partition/graph/graph.h"
#include "parts_support.h"

enum { SIDE = 40, N = SIDE * SIDE };

/* A square of vertices, each with its neighbours to the sides. */
static struct vg_graph square(void)
{
  static uint64_t begin[N + 1];
  static uint32_t to[4 * N];
  size_t n = 0;

  for (int i = 0; i < SIDE; i++) {
    for (int j = 0; j < SIDE; j++) {
      begin[i * SIDE + j] = n;
      if (i) to[n++] = (uint32_t)((i - 1) * SIDE + j);
      if (j) to[n++] = (uint32_t)(i * SIDE + j - 1);
      if (i + 1 < SIDE) to[n++] = (uint32_t)((i + 1) * SIDE + j);
      if (j + 1 < SIDE) to[n++] = (uint32_t)(i * SIDE + j + 1);
    }
  }
  begin[N] = n;
  return (struct vg_graph){ .n = N, .begin = begin, .to = to };
}

static double imbalance(const struct vg_graph *g, const uint32_t *part, int n)
{
  double sum = 0, most = 0, *w = calloc((size_t)n, sizeof *w);

  for (size_t k = 0; k < g->n; k++) {
    w[part[k]] += g->weight ? g->weight[k] : 1;
    sum += g->weight ? g->weight[k] : 1;
  }
  for (int k = 0; k < n; k++) most = w[k] > most ? w[k] : most;
  free(w);
  return most * n / sum;
}

static size_t n_cut(const struct vg_graph *g, const uint32_t *part)
{
  size_t n = 0;

  for (size_t k = 0; k < g->n; k++)
    for (uint64_t j = g->begin[k]; j < g->begin[k + 1]; j++)
      n += part[g->to[j]] != part[k];
  return n / 2;
}

/* Vertices that are reached from the first vertex of their part. */
static size_t n_reached(const struct vg_graph *g, const uint32_t *part, int n)
{
  uint8_t seen[N] = { 0 };
  uint32_t stack[N];
  size_t n_stack = 0, all = 0;

  for (int p = 0; p < n; p++) {
    size_t first = 0;

    while (first < g->n && part[first] != (uint32_t)p) first++;
    assert_true(first < g->n);
    stack[n_stack++] = (uint32_t)first;
    seen[first] = 1;
    while (n_stack) {
      uint32_t v = stack[--n_stack];

      all++;
      for (uint64_t j = g->begin[v]; j < g->begin[v + 1]; j++) {
        uint32_t u = g->to[j];

        if (seen[u] || part[u] != part[v]) continue;
        seen[u] = 1;
        stack[n_stack++] = u;
      }
    }
  }
  return all;
}

static void subdomains_are_balanced_and_connected(void **state)
{
  static const int n[] = { 1, 2, 7, 16, 40 };
  struct vg_graph g = square();
  uint32_t part[N], again[N];

  (void)state;
  needs_metis();
  for (size_t k = 0; k < sizeof n / sizeof *n; k++) {
    struct vg_graph_options o = { n[k], 1.03, 1, NULL };

    assert_int_equal(vg_graph_part(&g, &o, part, NULL), VG_OK);
    /* parts of 40 vertices cannot be balanced better than to a vertex or two */
    assert_true(imbalance(&g, part, n[k]) < 1.03 + 2.0 * n[k] / N);
    /* squares of the same area cut 2 sqrt(n) sides; METIS is near that */
    assert_true((double)n_cut(&g, part) <= 1.5 * SIDE * n[k] / 2);
    assert_int_equal(n_reached(&g, part, n[k]), N);
    assert_int_equal(vg_graph_part(&g, &o, again, NULL), VG_OK);
    assert_memory_equal(part, again, sizeof part);
  }
}

static void weights_count(void **state)
{
  struct vg_graph_options o = { 4, 1.03, 0, NULL };
  struct vg_graph g = square();
  double weight[N];
  uint32_t part[N];

  (void)state;
  needs_metis();
  for (int k = 0; k < N; k++) weight[k] = 1e-7 * (1 + k * k);
  g.weight = weight;
  assert_int_equal(vg_graph_part(&g, &o, part, NULL), VG_OK);
  assert_true(imbalance(&g, part, 4) < 1.05);
}

/* An edge of large weight is not cut. */
static void edge_weights_count(void **state)
{
  struct vg_graph_options o = { 2, 1.1, 0, NULL };
  struct vg_graph g = square();
  int32_t *price = malloc(g.begin[N] * sizeof *price);
  uint32_t part[N];

  (void)state;
  needs_metis();
  for (size_t k = 0; k < N; k++) /* rows are connected by heavy edges */
    for (uint64_t j = g.begin[k]; j < g.begin[k + 1]; j++)
      price[j] = g.to[j] / SIDE == k / SIDE ? 1000 : 1;
  g.edge = price;
  assert_int_equal(vg_graph_part(&g, &o, part, NULL), VG_OK);
  for (size_t k = 0; k < N; k++)
    assert_int_equal(part[k], part[k / SIDE * SIDE]);
  free(price);
}

static void invalid_requests_are_refused(void **state)
{
  struct vg_graph_options o = { N + 1, 1.03, 0, NULL };
  struct vg_graph g = square();
  struct vg_error err = VG_ERROR_INIT;
  uint32_t part[N] = { 7 };

  (void)state;
  needs_metis();
  assert_int_equal(vg_graph_part(&g, &o, part, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "1601 subdomains of 1600 vertices"));
  o.n_part = 0;
  assert_int_equal(vg_graph_part(&g, &o, part, &err), VG_ERR_INPUT);
  assert_int_equal(part[0], 7);
}

/* Points on a line, with increasing weights: parts are contiguous runs of
 * nearly equal weight, and none is empty even with one part per point. */
static void bisection_is_even(void **state)
{
  enum { POINTS = 1000 };
  static double x[POINTS][3], weight[POINTS];
  static uint32_t part[POINTS];
  double sum[7] = { 0 }, all = 0;

  (void)state;
  for (int i = 0; i < POINTS; i++) {
    x[i][1] = (i * 37) % POINTS;
    weight[i] = 1 + 0.001 * x[i][1];
    all += weight[i];
  }
  assert_int_equal(vg_bisect(POINTS, (const double(*)[3])x, weight, 7, part,
                             NULL),
                   VG_OK);
  for (int i = 0; i < POINTS; i++) {
    assert_true(part[i] < 7);
    sum[part[i]] += weight[i];
    for (int j = 0; j < POINTS; j++)
      assert_false(x[i][1] < x[j][1] && part[i] > part[j]);
  }
  for (int k = 0; k < 7; k++) assert_true(fabs(sum[k] * 7 / all - 1) < 0.02);
  assert_int_equal(vg_bisect(5, (const double(*)[3])x, weight, 5, part, NULL),
                   VG_OK);
  for (int i = 0; i < 5; i++)
    for (int j = 0; j < i; j++) assert_int_not_equal(part[i], part[j]);
  assert_int_equal(vg_bisect(5, (const double(*)[3])x, weight, 6, part, NULL),
                   VG_ERR_INPUT);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(subdomains_are_balanced_and_connected),
    cmocka_unit_test(weights_count),
    cmocka_unit_test(edge_weights_count),
    cmocka_unit_test(invalid_requests_are_refused),
    cmocka_unit_test(bisection_is_even),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
