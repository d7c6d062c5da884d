/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Groups of stretched sources: searches against visits of all sources. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/sizing/sizing_source.h"

enum { SOURCES = 300, PLACES = 400 };

static double random_in(uint64_t *state, double lo, double hi)
{
  *state = *state * 6364136223846793005ull + 1442695040888963407ull;
  return lo + (hi - lo) * ((double)(*state >> 11) * 0x1p-53);
}

static void random_point(uint64_t *seed, double lo, double hi, double x[3])
{
  for (int k = 0; k < 3; k++) x[k] = random_in(seed, lo, hi);
}

/* A source of any shape along one of four axes, near `at`. */
static struct vg_source random_source(uint64_t *seed, double at, double scale)
{
  static const enum vg_source_kind kinds[] = {
    VG_SOURCE_POINT, VG_SOURCE_LINE,     VG_SOURCE_SPHERE,
    VG_SOURCE_BOX,   VG_SOURCE_CYLINDER, VG_SOURCE_TRIANGLE
  };
  static const double axes[4][3] = {
    { 1, 0, 0 }, { 0.6, 0, 0.8 }, { 1, -2, 0.3 }, { 0, 1, 1 }
  };
  struct vg_source s = { .kind = kinds[(int)random_in(seed, 0, 6)], .an = 1 };

  random_point(seed, at, at + scale, s.p0);
  random_point(seed, at, at + scale, s.p1);
  random_point(seed, at, at + scale, s.p2);
  s.h0 = scale * random_in(seed, 0.001, 0.05);
  s.h1 = scale * random_in(seed, 0.001, 0.05);
  s.r0 = scale * random_in(seed, 0, 0.1);
  s.r1 = scale * random_in(seed, 0, 0.1);
  s.growth = random_in(seed, 0, 1) < 0.5 ? 0 : random_in(seed, 1.05, 1.8);
  s.stretch = random_in(seed, 0, 1) < 0.5 ? random_in(seed, 1.1, 30)
                                          : random_in(seed, 0.05, 0.9);
  memcpy(s.u, axes[(int)random_in(seed, 0, 4)], sizeof s.u);
  return s;
}

static void prepare(uint64_t *seed, size_t n, double at, double scale,
                    struct vg_source_set *set)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_source source[SOURCES];

  for (size_t i = 0; i < n; i++) source[i] = random_source(seed, at, scale);
  assert_int_equal(vg_source_check(n, source, &err), VG_OK);
  assert_int_equal(vg_source_prepare(&o, n, source, 1, set, &err), VG_OK);
  assert_int_equal(set->n_stretched, n);
}

/* The smallest sizes along and across of all sources of a group. */
static int smallest(const struct vg_stretched_group *g, const double x[3],
                    double most, double size[2])
{
  size[0] = size[1] = most;
  for (size_t i = 0; i < g->n; i++) {
    struct vg_size_axes a;

    vg_stretched_at(&g->source[i], x, &a);
    for (int k = 0; k < 2; k++) size[k] = fmin(size[k], a.size[k]);
  }
  return size[0] < most || size[1] < most;
}

static void check_group(const struct vg_stretched_group *g, uint64_t *seed,
                        double at, double scale)
{
  for (int i = 0; i < PLACES; i++) {
    const double most = i % 2 ? INFINITY : scale * random_in(seed, 0, 0.1);
    double x[3], size[2];
    struct vg_size_axes a;
    int is_finer;

    random_point(seed, at - scale, at + 2 * scale, x);
    is_finer = smallest(g, x, most, size);
    assert_int_equal(vg_stretched_group_at(g, x, most, &a), is_finer);
    if (!is_finer) continue;
    if (a.size[0] != size[0] || a.size[1] != size[1] || a.size[2] != size[1])
      fail_msg("(%g, %g, %g): %.17g %.17g, not %.17g %.17g", x[0], x[1], x[2],
               a.size[0], a.size[1], size[0], size[1]);
    assert_memory_equal(a.axis, g->source->axis, sizeof a.axis);
  }
}

/* Also far away from the origin, and with few sources. */
static void sizes_are_those_of_all_sources(void **state)
{
  static const size_t counts[] = { 1, 2, 5, 40, SOURCES };
  uint64_t seed = 7;

  (void)state;
  for (int i = 0; i < 30; i++) {
    const double at = i % 3 ? 0 : 1e6, scale = i % 2 ? 1 : 1e-3;
    struct vg_source_set set = VG_SOURCE_SET_INIT;

    prepare(&seed, counts[i % 5], at, scale, &set);
    assert_true(set.groups.n <= 4);
    for (size_t k = 0; k < set.groups.n; k++)
      if (set.groups.item[k].n > 1)
        check_group(&set.groups.item[k], &seed, at, scale);
    vg_source_release(&set);
  }
}

struct visited {
  const struct vg_stretched_group *g;
  size_t next;
  uint8_t is_seen[SOURCES];
};

static int see(void *context, const struct vg_stretched *s)
{
  struct visited *v = context;
  const size_t i = (size_t)(s - v->g->source);

  assert_true(i >= v->next && i < v->g->n);
  v->next = i + 1;
  v->is_seen[i] = 1;
  return 0;
}

/* Tensors that some sources undercut and others do not. */
static void tensors_of(const struct vg_stretched_group *g, const double x[3],
                       uint64_t *seed, double h[8][6], double *most)
{
  *most = 0;
  for (int i = 0; i < 8; i++) {
    struct vg_size_axes a;

    if (!vg_stretched_group_at(g, x, INFINITY, &a)) fail();
    for (int k = 0; k < 3; k++) a.size[k] *= random_in(seed, 0.7, 2);
    vg_size_axes_tensor(&a, h[i]);
    *most = fmax(*most, vg_size_axes_most(&a));
  }
}

static void check_finer(const struct vg_stretched_group *g, uint64_t *seed,
                        size_t *n_left_out)
{
  struct visited v = { .g = g };
  double lo[3], hi[3], h[8][6], most;

  random_point(seed, -1, 2, lo);
  for (int k = 0; k < 3; k++) hi[k] = lo[k] + 0.05;
  tensors_of(g, lo, seed, h, &most);
  vg_stretched_group_finer(g, lo, hi, most, 8, (const double(*)[6])h, 0.1, see,
                           &v);
  for (size_t i = 0; i < g->n; i++) {
    if (v.is_seen[i]) continue;
    ++*n_left_out;
    for (int j = 0; j < 20; j++) {
      struct vg_size_axes a;
      double x[3], source[6];

      for (int k = 0; k < 3; k++) x[k] = random_in(seed, lo[k], hi[k]);
      vg_stretched_at(&g->source[i], x, &a);
      vg_size_axes_tensor(&a, source);
      for (int k = 0; k < 8; k++)
        assert_true(vg_size_is_within(h[k], source, 0.1));
    }
  }
}

static void no_finer_source_is_left_out(void **state)
{
  struct vg_source_set set = VG_SOURCE_SET_INIT;
  uint64_t seed = 11;
  size_t n_left_out = 0;

  (void)state;
  prepare(&seed, SOURCES, 0, 1, &set);
  for (int i = 0; i < PLACES; i++)
    for (size_t k = 0; k < set.groups.n; k++)
      check_finer(&set.groups.item[k], &seed, &n_left_out);
  assert_true(n_left_out > (size_t)PLACES * SOURCES / 2);
  vg_source_release(&set);
}

/* Axes in one table: groups are in the order of their first sources, and keep
 * the order of their own. */
static void groups_keep_their_order(void **state)
{
  struct vg_source_set set = VG_SOURCE_SET_INIT;
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  struct vg_source s[5];

  (void)state;
  for (int i = 0; i < 5; i++)
    s[i] = (struct vg_source){ .kind = VG_SOURCE_POINT,
                               .h0 = 1 + i,
                               .stretch = 2,
                               .u = { i % 2, 1 - i % 2, 0 },
                               .an = 1 };
  s[4].kind = VG_SOURCE_MACHCONE;
  s[4].p1[0] = s[4].mach = s[4].r0 = 2;
  s[4].h1 = 1;
  assert_int_equal(vg_source_prepare(&o, 5, s, 1, &set, NULL), VG_OK);
  assert_int_equal(set.groups.n, 3);
  for (int i = 0; i < 5; i++) {
    static const double order[] = { 1, 3, 2, 4, 5 };

    assert_true(set.stretched[i].law.h0 == order[i]);
  }
  assert_int_equal(set.groups.item[2].n, 1);
  vg_source_release(&set);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(sizes_are_those_of_all_sources),
    cmocka_unit_test(no_finer_source_is_left_out),
    cmocka_unit_test(groups_keep_their_order),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
