/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/domain/planar.h"
#include "core/geometry/predicates.h"

enum { MAX_POINT = 20000 };

/* A region under construction and its result. */
struct plane {
  size_t n, n_edge, n_new, n_tri;
  double (*p)[2], (*add)[2];
  uint32_t (*edge)[2], (*tri)[3];
  struct vg_error err;
  int splits;
};

struct law {
  double at[2], h0, growth, h_max;
};

static double size_of(void *user, const double x[2])
{
  const struct law *l = user;
  const double dx = x[0] - l->at[0], dy = x[1] - l->at[1];
  const double h = l->h0 + l->growth * sqrt(dx * dx + dy * dy);

  return h < l->h_max ? h : l->h_max;
}

static void begin(struct plane *s)
{
  memset(s, 0, sizeof *s);
  s->p = malloc(MAX_POINT * sizeof *s->p);
  s->edge = malloc(MAX_POINT * sizeof *s->edge);
}

static void end(struct plane *s)
{
  free(s->p);
  free(s->edge);
  free(s->add);
  free(s->tri);
}

static void put(struct plane *s, double x, double y)
{
  assert_true(s->n < MAX_POINT);
  s->p[s->n][0] = x;
  s->p[s->n++][1] = y;
}

static void join(struct plane *s, size_t a, size_t b)
{
  s->edge[s->n_edge][0] = (uint32_t)a;
  s->edge[s->n_edge++][1] = (uint32_t)b;
}

static void close_from(struct plane *s, size_t first)
{
  for (size_t i = first; i < s->n; i++)
    join(s, i, i + 1 < s->n ? i + 1 : first);
}

/* Points from a up to, not including, b, spaced by the law. */
static void side(struct plane *s, const struct law *l, double ax, double ay,
                 double bx, double by)
{
  const double len = hypot(bx - ax, by - ay);
  const size_t first = s->n;
  double at = 0;

  while (at < len) {
    const double x[2] = { ax + (bx - ax) * at / len,
                          ay + (by - ay) * at / len };

    put(s, x[0], x[1]);
    at += size_of((void *)l, x);
  }
  for (size_t i = first; i < s->n; i++) {
    s->p[i][0] = ax + (s->p[i][0] - ax) * len / at;
    s->p[i][1] = ay + (s->p[i][1] - ay) * len / at;
  }
}

static void square(struct plane *s, const struct law *l, double w)
{
  const size_t first = s->n;

  side(s, l, 0, 0, w, 0);
  side(s, l, w, 0, w, w);
  side(s, l, w, w, 0, w);
  side(s, l, 0, w, 0, 0);
  close_from(s, first);
}

static void circle(struct plane *s, double x, double y, double r, int n,
                   int clockwise)
{
  const size_t first = s->n;

  for (int i = 0; i < n; i++) {
    const double a = 2 * 3.14159265358979 * i / n * (clockwise ? -1 : 1);

    put(s, x + r * cos(a), y + r * sin(a));
  }
  close_from(s, first);
}

static vg_status run(struct plane *s, const struct law *l)
{
  const struct vg_planar_law law = { .at = size_of,
                                     .user = (void *)l,
                                     .splits = s->splits };

  return vg_planar_mesh(s->n, (const double(*)[2])s->p, s->n_edge,
                        (const uint32_t(*)[2])s->edge, &law, &s->n_new, &s->add,
                        &s->n_tri, &s->tri, &s->err);
}

static const double *at(const struct plane *s, uint32_t i)
{
  return i < s->n ? s->p[i] : s->add[i - s->n];
}

struct half {
  uint32_t a, b, apex;
};

static int half_compare(const void *pa, const void *pb)
{
  const struct half *x = pa, *y = pb;

  if (x->a != y->a) return x->a < y->a ? -1 : 1;
  return x->b < y->b ? -1 : x->b > y->b;
}

static const struct half *find(const struct half *list, size_t n, uint32_t a,
                               uint32_t b)
{
  const struct half key = { a, b, 0 };

  return bsearch(&key, list, n, sizeof *list, half_compare);
}

/* Positive triangles; every half-edge once; those without a twin are exactly
 * the given segments; every other edge Delaunay. */
static void check_topology(const struct plane *s)
{
  const size_t n = 3 * s->n_tri;
  struct half *list = malloc(n * sizeof *list);
  size_t n_border = 0;

  for (size_t i = 0; i < n; i++) {
    const uint32_t *t = s->tri[i / 3];

    list[i] = (struct half){ t[i % 3], t[(i + 1) % 3], t[(i + 2) % 3] };
    assert_true(vg_orient2d(at(s, t[0]), at(s, t[1]), at(s, t[2])) > 0);
  }
  qsort(list, n, sizeof *list, half_compare);
  for (size_t i = 1; i < n; i++)
    assert_true(half_compare(&list[i - 1], &list[i]) < 0);
  for (size_t i = 0; i < n; i++) {
    const struct half *o = find(list, n, list[i].b, list[i].a);

    if (!o) n_border++;
    else
      assert_false(vg_incircle(at(s, list[i].a), at(s, list[i].b),
                               at(s, list[i].apex), at(s, o->apex)) > 0);
  }
  assert_int_equal(n_border, s->n_edge);
  for (size_t i = 0; i < s->n_edge; i++) {
    assert_non_null(find(list, n, s->edge[i][0], s->edge[i][1]));
    assert_null(find(list, n, s->edge[i][1], s->edge[i][0]));
  }
  free(list);
}

struct figures {
  double area, angle_min_deg, length_mean, length_good;
};

static struct figures measure(const struct plane *s, const struct law *l)
{
  struct figures f = { 0, 180, 0, 0 };

  for (size_t i = 0; i < s->n_tri; i++) {
    double len[3];

    for (int k = 0; k < 3; k++) {
      const double *a = at(s, s->tri[i][k]), *b = at(s, s->tri[i][(k + 1) % 3]);
      const double mid[2] = { (a[0] + b[0]) / 2, (a[1] + b[1]) / 2 };
      double ratio;

      len[k] = hypot(b[0] - a[0], b[1] - a[1]);
      ratio = len[k] / size_of((void *)l, mid);
      f.length_mean += ratio / (3 * s->n_tri);
      f.length_good += (ratio > 0.7 && ratio < 1.5) / (3.0 * s->n_tri);
      f.area += (a[0] * b[1] - a[1] * b[0]) / 2;
    }
    for (int k = 0; k < 3; k++) {
      const double x = len[k], y = len[(k + 1) % 3], z = len[(k + 2) % 3];
      const double angle = acos((y * y + z * z - x * x) / (2 * y * z));

      f.angle_min_deg = fmin(f.angle_min_deg, angle * 180 / 3.14159265358979);
    }
  }
  return f;
}

static void fills_a_square_evenly(void **state)
{
  const struct law l = { { 0, 0 }, 0.02, 0, 1 };
  struct plane s;
  struct figures f;

  (void)state;
  begin(&s);
  square(&s, &l, 1);
  assert_int_equal(run(&s, &l), VG_OK);
  check_topology(&s);
  f = measure(&s, &l);
  assert_true(fabs(f.area - 1) < 1e-12);
  assert_true(f.angle_min_deg > 30);
  assert_true(f.length_mean > 0.95 && f.length_mean < 1.05);
  assert_true(f.length_good > 0.99);
  /* equilateral triangles of edge 0.02: 5,774 */
  assert_true(s.n_tri > 5400 && s.n_tri < 6200);
  end(&s);
}

static void follows_sizes_over_five_decades(void **state)
{
  const struct law l = { { 5, 5 }, 1e-5, 0.2, 1 };
  struct plane s;
  struct figures f;

  (void)state;
  begin(&s);
  square(&s, &l, 10);
  circle(&s, 5, 5, 1e-4, 30, 1);
  assert_int_equal(run(&s, &l), VG_OK);
  check_topology(&s);
  f = measure(&s, &l);
  assert_true(f.angle_min_deg > 30);
  assert_true(f.length_mean > 0.9 && f.length_mean < 1.1);
  assert_true(f.length_good > 0.9);
  end(&s);
}

static void keeps_loops_that_touch(void **state)
{
  const struct law l = { { 0, 0 }, 0.1, 0, 1 };
  struct plane s;

  (void)state;
  begin(&s);
  /* a square, a triangular hole attached to its corner 0, and a second triangle
   * outside attached to the same corner */
  square(&s, &l, 1);
  put(&s, 0.2, 0.5);
  put(&s, 0.5, 0.2);
  join(&s, 0, s.n - 2);
  join(&s, s.n - 2, s.n - 1);
  join(&s, s.n - 1, 0);
  put(&s, -0.5, 0);
  put(&s, 0, -0.5);
  join(&s, 0, s.n - 2);
  join(&s, s.n - 2, s.n - 1);
  join(&s, s.n - 1, 0);
  assert_int_equal(run(&s, &l), VG_OK);
  check_topology(&s);
  assert_true(fabs(measure(&s, &l).area - (1 - 0.105 + 0.125)) < 1e-12);
  end(&s);
}

static void closes_a_region_finer_than_its_size(void **state)
{
  const struct law coarse = { { 0, 0 }, 1e9, 0, 1e9 };
  const struct law nan_law = { { NAN, 0 }, 1, 1, NAN };
  const struct law zero_law = { { 0, 0 }, 0, 0, 1 };
  struct plane s;

  (void)state;
  begin(&s);
  circle(&s, 0, 0, 1, 200, 0);
  circle(&s, 0.3, 0.1, 0.2, 64, 1);
  assert_int_equal(run(&s, &coarse), VG_OK);
  check_topology(&s);
  free(s.add);
  free(s.tri);
  /* sizes are NaN: the boundary alone decides */
  assert_int_equal(run(&s, &nan_law), VG_OK);
  check_topology(&s);
  free(s.add);
  free(s.tri);
  assert_int_equal(run(&s, &zero_law), VG_OK);
  check_topology(&s);
  end(&s);
}

static void closes_a_thin_wedge(void **state)
{
  const struct law l = { { 0, 0 }, 0.1, 0, 1 };
  struct plane s;

  (void)state;
  begin(&s);
  put(&s, 0, 0);
  put(&s, 1, 0);
  put(&s, 2, 1e-9);
  put(&s, 1, 1e-9);
  close_from(&s, 0);
  assert_int_equal(run(&s, &l), VG_OK);
  check_topology(&s);
  end(&s);
}

/* The tops of layers that converge in a concave corner:
 *
 *     o-----------------o-----------------o
 *     |                                   |
 *     o-----------------o-----------------o
 *
 * Triangles between the long sides alone would have angles of 16 degrees. */
static void adds_points_in_narrow_strips(void **state)
{
  static const double strip[6][2] = { { 0, 0 },   { 2, 0 },   { 4, -0.2 },
                                      { 4, 1.2 }, { 2, 0.8 }, { 0, 0.6 } };
  double least[2];

  (void)state;
  for (int splits = 0; splits < 2; splits++) {
    const struct law l = { { 0, 0 }, 2, 0, 2 };
    struct plane s;

    begin(&s);
    s.splits = splits;
    for (int i = 0; i < 6; i++) put(&s, strip[i][0], strip[i][1]);
    close_from(&s, 0);
    assert_int_equal(run(&s, &l), VG_OK);
    check_topology(&s);
    assert_true(splits == (s.n_new > 0));
    least[splits] = measure(&s, &l).angle_min_deg;
    end(&s);
  }
  assert_true(least[0] < 17);
  assert_true(least[1] > least[0] + 2);
}

static void follows_a_ragged_boundary(void **state)
{
  const struct law l = { { 0, 0 }, 0.02, 0, 1 };
  struct plane s;
  uint32_t dice = 1;

  (void)state;
  begin(&s);
  for (int i = 0; i < 3000; i++) {
    const double a = 2 * 3.14159265358979 * i / 3000;
    double r;

    dice = dice * 1664525u + 1013904223u;
    r = 0.5 + 0.5 * (dice >> 8) / 16777216.0;
    put(&s, r * cos(a), r * sin(a));
  }
  close_from(&s, 0);
  assert_int_equal(run(&s, &l), VG_OK);
  check_topology(&s);
  end(&s);
}

static void gives_the_same_bytes_twice(void **state)
{
  const struct law l = { { 0.4, 0.3 }, 0.005, 0.2, 1 };
  struct plane a, b;

  (void)state;
  begin(&a);
  begin(&b);
  square(&a, &l, 1);
  square(&b, &l, 1);
  assert_int_equal(run(&a, &l), VG_OK);
  assert_int_equal(run(&b, &l), VG_OK);
  assert_int_equal(a.n_new, b.n_new);
  assert_int_equal(a.n_tri, b.n_tri);
  assert_memory_equal(a.add, b.add, a.n_new * sizeof *a.add);
  assert_memory_equal(a.tri, b.tri, a.n_tri * sizeof *a.tri);
  end(&a);
  end(&b);
}

static void names_crossing_segments(void **state)
{
  const struct law l = { { 0, 0 }, 1, 0, 1 };
  struct plane s;

  (void)state;
  begin(&s);
  put(&s, 0, 0);
  put(&s, 1, 1);
  put(&s, 1, 0);
  put(&s, 0, 1);
  close_from(&s, 0);
  assert_int_equal(run(&s, &l), VG_ERR_GEOMETRY);
  assert_non_null(strstr(s.err.text, "segments 1 and 3 cross"));
  assert_null(s.tri);
  end(&s);
}

static void refuses_bad_loops(void **state)
{
  const struct law l = { { 0, 0 }, 1, 0, 1 };
  const double corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
  struct plane s;

  (void)state;
  for (int flaw = 0; flaw < 8; flaw++) {
    const vg_status want = flaw == 3 || flaw == 4 ? VG_ERR_GEOMETRY
                                                  : VG_ERR_INPUT;

    begin(&s);
    for (int i = 0; i < 4; i++) put(&s, corner[i][0], corner[i][1]);
    close_from(&s, 0);
    switch (flaw) {
    case 0: s.n_edge = 3; break; /* open */
    case 1: s.p[2][0] = NAN; break;
    case 2: s.edge[1][1] = 9; break; /* out of range */
    case 3:
      s.p[2][0] = s.p[1][0];
      s.p[2][1] = 0;
      break; /* coincident */
    case 4:
      put(&s, 0.5, 0.25);
      join(&s, 4, 1); /* on a segment */
      join(&s, 0, 4);
      s.p[4][1] = 0;
      break;
    case 5: s.edge[1][1] = s.edge[1][0]; break;
    case 6: s.n_edge = 0; break;
    case 7: /* clockwise */
      for (size_t i = 0; i < 4; i++) {
        const uint32_t a = s.edge[i][0];

        s.edge[i][0] = s.edge[i][1];
        s.edge[i][1] = a;
      }
    }
    assert_int_equal(run(&s, &l), want);
    assert_int_equal(s.err.code, want);
    assert_null(s.tri);
    end(&s);
  }
}

/* A stop request after this number of polls. */
struct patience {
  struct law l;
  size_t n_size, n_asked, most;
};

static double size_counted(void *user, const double x[2])
{
  struct patience *p = user;

  p->n_size++;
  return size_of(&p->l, x);
}

static int is_over(void *user)
{
  struct patience *p = user;

  return ++p->n_asked > p->most;
}

/* The stop request is polled throughout the placement and the smoothing of
 * points, and obeyed at once. Polls without a request change nothing. */
static void stops_when_asked(void **state)
{
  struct patience p = { .l = { { 0 }, 0.005, 0, 1 }, .most = SIZE_MAX };
  const struct vg_planar_law law = { .at = size_counted,
                                     .user = &p,
                                     .stop = { is_over, &p } };
  const struct law border = { { 0 }, 0.05, 0, 1 };
  size_t n_size = 0, n_asked = 0;

  (void)state;
  for (int pass = 0; pass < 4; pass++) {
    struct plane s;
    vg_status st;

    begin(&s);
    square(&s, &border, 1);
    if (pass) p.most = pass == 1 ? 0 : pass == 2 ? n_asked / 2 : n_asked - 1;
    p.n_size = p.n_asked = 0;
    st = vg_planar_mesh(s.n, (const double(*)[2])s.p, s.n_edge,
                        (const uint32_t(*)[2])s.edge, &law, &s.n_new, &s.add,
                        &s.n_tri, &s.tri, &s.err);
    assert_int_equal(st, pass ? VG_ERR_STOPPED : VG_OK);
    if (!pass) {
      n_size = p.n_size;
      n_asked = p.n_asked;
      assert_true(n_asked > s.n_tri / 2000);
    } else {
      assert_null(s.tri);
      assert_int_equal(p.n_asked, p.most + 1);
      assert_true(pass == 3 ? p.n_size == n_size : pass == 2 || !p.n_size);
    }
    end(&s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(stops_when_asked),
    cmocka_unit_test(fills_a_square_evenly),
    cmocka_unit_test(follows_sizes_over_five_decades),
    cmocka_unit_test(keeps_loops_that_touch),
    cmocka_unit_test(closes_a_region_finer_than_its_size),
    cmocka_unit_test(closes_a_thin_wedge),
    cmocka_unit_test(adds_points_in_narrow_strips),
    cmocka_unit_test(follows_a_ragged_boundary),
    cmocka_unit_test(gives_the_same_bytes_twice),
    cmocka_unit_test(names_crossing_segments),
    cmocka_unit_test(refuses_bad_loops),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
