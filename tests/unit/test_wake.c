/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Trailing edges of random wings with known chords, sheets behind them, and
 * the cells across lines. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/geometry/vector.h"
#include "core/wake/wake.h"
#include "slices_support.h"

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

enum { SPAN = 12, SIDE = 10, RING = 2 * SIDE + 2 };

static const double along_x[3] = { 1, 0, 0 };

/* A wing with straight edges. Its sections are two arcs that meet in a sharp
 * leading edge; the base is `blunt` chords thick. */
struct wing {
  double span, chord, taper, sweep, dihedral, blunt;
  int is_half; /* 1: open at the root */
  struct vg_mesh m;
};

static double chance(void)
{
  return (double)rand() / RAND_MAX;
}

static double chord_at(const struct wing *w, double share)
{
  return w->chord * (1 + (w->taper - 1) * share);
}

/* Point i of the ring: from the trailing edge over the upper side to the
 * leading edge, and back over the lower side. */
static void ring_point(const struct wing *w, double share, int i, double x[3])
{
  const int k = i <= SIDE ? SIDE - i : i - SIDE - 1;
  const double s = (double)k / SIDE, c = chord_at(w, share);
  const double half = 0.2 * s * (1 - s) + 0.5 * w->blunt * s;

  x[0] = w->sweep * w->span * share + c * s;
  x[1] = w->span * share;
  x[2] = w->dihedral * x[1] + (i <= SIDE ? half : -half) * c;
}

static void add_triangle(struct vg_mesh *m, uint32_t a, uint32_t b, uint32_t c,
                         uint32_t patch)
{
  const uint32_t v[2][3] = { { a, b, c }, { a, c, b } };

  if (a == b || b == c || c == a) return;
  memcpy(m->tri[m->n_tri], v[rand() % 2], sizeof v[0]);
  m->tri_patch[m->n_tri++] = patch;
}

/* The ends of both arcs are one point at the leading edge, and at a sharp
 * trailing edge. */
static uint32_t node(const struct wing *w, int j, int i)
{
  if (i == SIDE + 1) i = SIDE;
  if (i == RING - 1 && w->blunt == 0) i = 0;
  return (uint32_t)(j * RING + i);
}

/* Patches: 0 sides, 1 base, 2 ends. Triangles have a random orientation. */
static void make_wing(struct wing *w)
{
  struct vg_mesh *m = &w->m;

  memset(m, 0, sizeof *m);
  m->n_point = (SPAN + 1) * RING;
  m->n_patch = 3;
  m->point = calloc(m->n_point, sizeof *m->point);
  m->tri = calloc(4 * m->n_point, sizeof *m->tri);
  m->tri_patch = calloc(4 * m->n_point, sizeof *m->tri_patch);
  m->patch = calloc(m->n_patch, sizeof *m->patch);
  assert_true(m->point && m->tri && m->tri_patch && m->patch);
  for (int j = 0; j <= SPAN; j++)
    for (int i = 0; i < RING; i++)
      ring_point(w, (double)j / SPAN, i, m->point[j * RING + i]);
  for (int j = 0; j < SPAN; j++)
    for (int i = 0; i < RING; i++) {
      const int next = (i + 1) % RING;
      const uint32_t patch = i == RING - 1;

      add_triangle(m, node(w, j, i), node(w, j + 1, i), node(w, j + 1, next),
                   patch);
      add_triangle(m, node(w, j, i), node(w, j + 1, next), node(w, j, next),
                   patch);
    }
  for (int end = w->is_half; end < 2; end++)
    for (int i = 0; i < SIDE; i++) {
      const int j = end * SPAN;

      add_triangle(m, node(w, j, i), node(w, j, i + 1),
                   node(w, j, RING - 1 - i), 2);
      add_triangle(m, node(w, j, i + 1), node(w, j, RING - 2 - i),
                   node(w, j, RING - 1 - i), 2);
    }
}

static struct wing random_wing(int is_blunt, int is_half)
{
  struct wing w = { .span = 1 + 4 * chance(),
                    .chord = 0.5 + chance(),
                    .taper = 0.2 + 0.8 * chance(),
                    .sweep = 1.2 * chance() - 0.3,
                    .dihedral = 0.3 * chance() - 0.1,
                    .blunt = is_blunt ? 0.002 + 0.03 * chance() : 0,
                    .is_half = is_half };

  make_wing(&w);
  return w;
}

static struct vg_trailing find(const struct vg_mesh *m)
{
  const uint8_t is_body[3] = { 1, 1, 1 };
  struct vg_trailing t = VG_TRAILING_INIT;

  assert_int_equal(vg_trailing_find(m, is_body, 0, along_x, &t, NULL), VG_OK);
  return t;
}

static double middle_share(const struct wing *w,
                           const struct vg_trailing_edge *e)
{
  return 0.5 * (w->m.point[e->point[0]][1] + w->m.point[e->point[1]][1]) /
         w->span;
}

/* The end of the base of a swept wing, between base and tip, is as sharp and
 * extends upstream as much as a trailing edge. */
static int is_at_tip(const struct wing *w, const struct vg_trailing_edge *e)
{
  return w->blunt > 0 &&
         w->m.point[e->point[0]][1] == w->m.point[e->point[1]][1];
}

static void chords_of_wings(void **state)
{
  (void)state;
  srand(1);
  for (int trial = 0; trial < 200; trial++) {
    struct wing w = random_wing(trial % 2, trial / 2 % 2);
    struct vg_trailing t = find(&w.m);
    size_t n = 0;

    for (size_t i = 0; i < t.n; i++) {
      const double c = chord_at(&w, middle_share(&w, &t.edge[i]));

      if (is_at_tip(&w, &t.edge[i])) continue;
      n++;
      assert_near(t.edge[i].chord, c, (w.blunt > 0 ? 0.02 : 1e-9) * c);
      assert_near(t.edge[i].thickness, w.blunt * c, 0.1 * w.blunt * c);
    }
    assert_int_equal(n, w.blunt > 0 ? 2 * SPAN : SPAN);
    vg_trailing_release(&t);
    vg_mesh_release(&w.m);
  }
}

/* The stream from behind turns leading edges into trailing edges. */
static void backwards(void **state)
{
  const uint8_t is_body[3] = { 1, 1, 1 };
  const double back[3] = { -1, 0, 0 };
  struct vg_trailing t = VG_TRAILING_INIT;
  struct wing w;

  (void)state;
  srand(2);
  w = random_wing(1, 0);
  assert_int_equal(vg_trailing_find(&w.m, is_body, 0, back, &t, NULL), VG_OK);
  assert_int_equal(t.n, SPAN);
  for (size_t i = 0; i < t.n; i++) assert_near(t.edge[i].thickness, 0, 0);
  vg_trailing_release(&t);
  vg_mesh_release(&w.m);
}

/* A groove of the shape of the wing in a solid has no trailing edge. */
static void concave(void **state)
{
  const uint8_t is_body[3] = { 1, 1, 1 };
  struct vg_trailing t = VG_TRAILING_INIT;
  struct wing w;

  (void)state;
  srand(3);
  w = random_wing(0, 0);
  assert_int_equal(vg_trailing_find(&w.m, is_body, 1, along_x, &t, NULL),
                   VG_OK);
  assert_int_equal(t.n, 0);
  vg_mesh_release(&w.m);
}

static void thick_base(void **state)
{
  struct vg_trailing t;
  struct wing w;

  (void)state;
  srand(4);
  w = random_wing(1, 0);
  vg_mesh_release(&w.m);
  w.blunt = 0.08;
  make_wing(&w);
  t = find(&w.m);
  assert_int_equal(t.n, 0);
  vg_mesh_release(&w.m);
}

/* --- panels and sources -------------------------------------------------- */

static void panels_of_wings(void **state)
{
  const struct vg_wake wake = { 2, 0.02, 0.05, 1.02, 0, 1 };
  const uint8_t all[3] = { 1, 1, 1 }, base[3] = { 0, 1, 0 };

  (void)state;
  srand(5);
  for (int trial = 0; trial < 50; trial++) {
    struct wing w = random_wing(trial % 2, 1);
    struct vg_trailing t = find(&w.m);
    struct vg_wake_panels p = VG_WAKE_PANELS_INIT;
    double sum = 0, edges = 0;

    assert_int_equal(vg_wake_panels_make(&w.m, &t, all, &wake, &p, NULL),
                     VG_OK);
    for (size_t i = 0; i < t.n; i++)
      edges += vg_distance(w.m.point[t.edge[i].point[0]],
                           w.m.point[t.edge[i].point[1]]);
    for (size_t i = 0; i < p.n; i++) {
      const double length = vg_distance(p.item[i].x[0], p.item[i].x[1]);
      const double ratio = p.item[i].chord[0] / p.item[i].chord[1];

      sum += length;
      assert_true(ratio < 1.4 && ratio > 1 / 1.4);
    }
    assert_true(p.n > 0 && p.n <= t.n);
    assert_near(sum, edges, 1e-9 * edges);
    vg_wake_panels_release(&p);
    assert_int_equal(vg_wake_panels_make(&w.m, &t, base, &wake, &p, NULL),
                     VG_OK);
    assert_true((p.n > 0) == (w.blunt > 0));
    vg_wake_panels_release(&p);
    vg_trailing_release(&t);
    vg_mesh_release(&w.m);
  }
}

/* The chord of an edge whose section continues over another body is reduced to
 * that of its neighbours. */
static void chord_that_jumps(void **state)
{
  const struct vg_wake wake = { 2, 0.02, 0.05, 1, 0, 1 };
  const uint8_t all[3] = { 1, 1, 1 };
  struct vg_wake_panels p = VG_WAKE_PANELS_INIT;
  struct vg_trailing t;
  struct wing w;

  (void)state;
  srand(6);
  w = random_wing(0, 0);
  t = find(&w.m);
  t.edge[SPAN / 2].chord *= 50;
  assert_int_equal(vg_wake_panels_make(&w.m, &t, all, &wake, &p, NULL), VG_OK);
  for (size_t i = 0; i < p.n; i++)
    for (int k = 0; k < 2; k++)
      assert_true(p.item[i].chord[k] <=
                  1.01 * w.chord + 4 * 1.7 * w.span / SPAN);
  vg_wake_panels_release(&p);
  vg_trailing_release(&t);
  vg_mesh_release(&w.m);
}

static void sheet_of_a_panel(void **state)
{
  const struct vg_wake wake = { 2, 0.02, 0.05, 1.02, 0, 1 };
  const struct vg_wake_panel panel = { { { 1, 0, 0 }, { 1, 1, 0 } },
                                       { 1, 0.5 },
                                       0.01 };
  const size_t n = vg_wake_sources_count(&wake);
  struct vg_source *s = calloc(n, sizeof *s);
  struct vg_wake stretched = wake;
  double flow[3], far = 0, area = 0;

  (void)state;
  assert_non_null(s);
  vg_wake_direction(30, 0, along_x, (double[]){ 0, 0, 1 }, flow);
  vg_wake_sources(&wake, &panel, flow, s);
  for (size_t i = 0; i < n; i++) {
    const double *const x[3] = { s[i].p0, s[i].p1, s[i].p2 };

    area += vg_triangle_area(x[0], x[1], x[2]);
    for (int k = 0; k < 3; k++) {
      far = fmax(far, vg_distance(x[k], panel.x[0]));
      assert_near(x[k][2], tan(M_PI / 6) * (x[k][0] - 1), 1e-12);
    }
    /* Sizes grow by 2 % of the distance, heights in proportion. */
    assert_true(s[i].h0 >= 0.75 * 0.02 && s[i].h0 <= 0.75 * 0.06);
    assert_near(s[i].r0 - 0.005, 2.5 * s[i].h0, 1e-12);
    assert_int_equal(s[i].kind, VG_SOURCE_TRIANGLE);
  }
  assert_near(area, 2 * 0.75, 1e-9);
  for (size_t i = 0; i < n; i++) assert_true(s[i].stretch == 0);
  stretched.stretch = 5;
  vg_wake_sources(&stretched, &panel, flow, s);
  for (size_t i = 0; i < n; i++) {
    assert_true(s[i].stretch == 5);
    assert_memory_equal(s[i].u, flow, sizeof flow);
  }
  assert_true(far <= sqrt(5) + 1e-9);
  assert_true(s[n - 1].h0 > 2 * s[0].h0);
  free(s);
}

static void directions(void **state)
{
  const double up[3] = { 0, 0, 1 };
  double f[3];

  (void)state;
  for (double a = -60; a <= 60; a += 7.5)
    for (double b = -60; b <= 60; b += 7.5) {
      const double r = M_PI / 180;

      vg_wake_direction(a, b, along_x, up, f);
      assert_near(f[0], cos(a * r) * cos(b * r), 1e-14);
      assert_near(f[1], -sin(b * r), 1e-14);
      assert_near(f[2], sin(a * r) * cos(b * r), 1e-14);
    }
}

/* --- cells along lines --------------------------------------------------- */

/* A box of n cubes along each axis, each cut into six tetrahedra around its
 * diagonal. Along an axis, the metric of each has the length of the cube's
 * edge. */
static struct vg_mesh make_box(int n)
{
  static const int order[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
                                   { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
  const uint32_t stride[3] = { 1, (uint32_t)n + 1,
                               (uint32_t)((n + 1) * (n + 1)) };
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = stride[2] * (uint32_t)(n + 1);
  m.point = calloc(m.n_point, sizeof *m.point);
  m.tet = calloc((size_t)(6 * n * n * n), sizeof *m.tet);
  assert_true(m.point && m.tet);
  for (size_t i = 0; i < m.n_point; i++)
    for (int k = 0; k < 3; k++)
      m.point[i][k] = (double)(i / stride[k] % (size_t)(n + 1)) / n;
  for (int c = 0; c < n * n * n; c++) {
    const uint32_t at = (uint32_t)(c % n) + stride[1] * (uint32_t)(c / n % n) +
                        stride[2] * (uint32_t)(c / n / n);

    for (int p = 0; p < 6; p++) {
      uint32_t *v = m.tet[m.n_tet++], t;

      v[0] = at;
      for (int k = 0; k < 3; k++) v[k + 1] = v[k] + stride[order[p][k]];
      if (p < 3) continue;
      t = v[1], v[1] = v[2], v[2] = t;
    }
  }
  return m;
}

static void cells_along_lines(void **state)
{
  struct vg_mesh m = make_box(8);
  struct vg_wake_probe p[4] = {
    { .x = { { 0.31, 0.27, 0.01 }, { 0.31, 0.27, 0.99 } },
      .flow = { 1, 0, 0 } },
    { .x = { { 0.1, 0.57, 0.33 }, { 0.9, 0.57, 0.33 } } },
    { .x = { { 0.5, -0.9, 0.41 }, { 0.5, 0.4, 0.41 } } }, /* mostly outside */
    { .x = { { 0.52, -0.4, 0.41 }, { 0.52, 1, 0.41 } } }
  };

  (void)state;
  for (size_t i = 0; i < m.n_point; i++) m.point[i][2] /= 4;
  for (int i = 0; i < 4; i++)
    for (int end = 0; end < 2; end++) p[i].x[end][2] /= 4;
  for (size_t parts = 1; parts <= 5; parts += 2) {
    struct cut c;

    cut_make(&c, &m, parts, 0, NULL, parts);
    for (int i = 0; i < 4; i++) p[i].got = 7;
    assert_int_equal(vg_wake_measure(NULL, &c.s, 2, 4, p, NULL), VG_OK);
    assert_near(p[0].got, 0.98 * 8, 1e-5);
    assert_near(p[0].stretch, 4, 1e-5);
    assert_true(isnan(p[2].stretch));
    assert_near(p[1].got, 0.8 * 8, 1e-5);
    assert_true(isnan(p[2].got));
    assert_near(p[3].got, 1.4 * 8, 1e-5); /* extrapolated */
    cut_release(&c);
  }
  vg_mesh_release(&m);
}

/* The box with each cube cut into two prisms, in slabs along z. */
static struct vg_mesh make_prisms(int n)
{
  const uint32_t stride[3] = { 1, (uint32_t)n + 1,
                               (uint32_t)((n + 1) * (n + 1)) };
  struct vg_mesh m = make_box(n);

  m.pri = calloc((size_t)(2 * n * n * n), sizeof *m.pri);
  assert_non_null(m.pri);
  for (int c = 0; c < n * n * n; c++) {
    const uint32_t at = m.tet[6 * c][0];

    for (int half = 0; half < 2; half++) {
      uint32_t *v = m.pri[m.n_pri++];

      v[0] = at;
      v[1] = at + (half ? stride[0] + stride[1] : stride[0]);
      v[2] = at + (half ? stride[1] : stride[0] + stride[1]);
      for (int k = 0; k < 3; k++) v[k + 3] = v[k] + stride[2];
    }
  }
  free(m.tet);
  m.tet = NULL;
  m.n_tet = 0;
  return m;
}

/* Prisms count outside of layers, which are the first half of them here. */
static void prisms_along_lines(void **state)
{
  struct vg_mesh m = make_prisms(8);
  struct vg_wake_probe p[4] = {
    { .x = { { 0.1, 0.57, 0.83 }, { 0.9, 0.57, 0.83 } } },
    { .x = { { 0.31, 0.2, 0.6 }, { 0.31, 0.9, 0.6 } } },
    { .x = { { 0.31, 0.27, 0.2 }, { 0.31, 0.27, 0.98 } } },
    { .x = { { 0.31, 0.27, 0.1 }, { 0.31, 0.92, 0.3 } } } /* in layers */
  };

  (void)state;
  for (size_t parts = 1; parts <= 5; parts += 2) {
    struct cut c;

    cut_make(&c, &m, parts, 0, NULL, parts);
    c.s.n_layer_cell[VG_SLICE_PRI] = m.n_pri / 2;
    assert_int_equal(vg_wake_measure(NULL, &c.s, 2, 4, p, NULL), VG_OK);
    assert_near(p[0].got, 0.8 * 8, 1e-5);
    assert_near(p[1].got, 0.7 * 8, 1e-5);
    assert_near(p[2].got, 0.78 * 8, 1e-5); /* extrapolated */
    assert_true(isnan(p[3].got));
    cut_release(&c);
  }
  vg_mesh_release(&m);
}

static void a_line_of_a_panel(void **state)
{
  const struct vg_wake wake = { 1.5, 0.02, 0.05, 1.02, 0, 1 };
  const struct vg_wake_panel panel = { { { 1, 0, 0 }, { 1, 1, 0 } },
                                       { 1, 1 },
                                       0 };
  struct vg_wake_probe p;

  (void)state;
  assert_int_equal(vg_wake_probe(&wake, &panel, along_x, 2, 1, &p), 0);
  assert_int_equal(vg_wake_probe(&wake, &panel, along_x, 1, 2, &p), 1);
  assert_near(p.asked, 2.5, 1e-12);
  assert_near(vg_distance(p.x[0], p.x[1]), 0.2, 1e-12);
  assert_near(p.x[0][0], 2, 1e-12);
  assert_near(p.x[0][1], 0.5, 1e-12);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(chords_of_wings),
    cmocka_unit_test(backwards),
    cmocka_unit_test(concave),
    cmocka_unit_test(thick_base),
    cmocka_unit_test(panels_of_wings),
    cmocka_unit_test(chord_that_jumps),
    cmocka_unit_test(sheet_of_a_panel),
    cmocka_unit_test(directions),
    cmocka_unit_test(cells_along_lines),
    cmocka_unit_test(a_line_of_a_panel),
    cmocka_unit_test(prisms_along_lines),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
