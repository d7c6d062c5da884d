/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Optimisation: the worst cell improves, and the input is preserved: boundary,
 * volume, orientation. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "core/geometry/shape.h"
#include "core/optimise/optimise.h"
#include "core/optimise/optimise_parts.h"
#include "core/recover/boundary.h"
#include "fill_shapes.h"
#include "tets_support.h"

/* sin^2 of the smallest dihedral angle, or of the largest. */
static const double ten_degrees = 0.03015;
static const double aim =
  0.1786; /* 25: above it cells may lose quality in favour of others */

/* --- meshes ------------------------------------------------------------- */

struct subject {
  struct vg_mesh m;
  struct vg_tets t;
  struct vg_sizing *sizing;
  struct vg_inserter s;
  double volume;
};

/* The Delaunay cells of a cubic surface of side 1 and n x n quads. */
static void box_subject(struct subject *s, int n)
{
  struct vg_boundary_report r;

  memset(s, 0, sizeof *s);
  shape_box(&s->m, n, 0.5);
  s->sizing = shape_sizing(&s->m, 1.2, 0);
  assert_int_equal(vg_boundary_tets(s->m.n_point,
                                    (const double(*)[3])s->m.point, s->m.n_tri,
                                    (const uint32_t(*)[3])s->m.tri, NULL, &s->t,
                                    &r, NULL),
                   VG_OK);
  assert_int_equal(vg_inserter_init(&s->s, &s->t, NULL), VG_OK);
}

static void put(struct subject *s, double x, double y, double z)
{
  const double at[3] = { x, y, z };

  assert_int_equal(tets_insert(&s->s, at, 0, 0), VG_OK);
}

static void ready(struct subject *s)
{
  vg_inserter_release(&s->s);
  assert_int_equal(vg_tets_compact(&s->t, s->m.n_point, NULL), VG_OK);
  s->volume = tets_volume(&s->t);
  assert_true(fabs(s->volume - 1) < 1e-11);
}

static void subject_end(struct subject *s)
{
  vg_sizing_free(s->sizing);
  vg_tets_release(&s->t);
  vg_mesh_release(&s->m);
}

/* Random points: cells of every shape, including slivers. */
static void random_subject(struct subject *s, int n, int n_point, uint64_t seed)
{
  box_subject(s, n);
  for (int i = 0; i < n_point; i++) {
    double x[3];

    for (int k = 0; k < 3; k++) x[k] = 0.96 * (tets_random(&seed) - 0.5);
    put(s, x[0], x[1], x[2]);
  }
  ready(s);
}

static double worst(const struct vg_tets *t)
{
  double least = 2;

  for (size_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;
    double q;

    if (t->flag[c] & (VG_DEAD | VG_OUTSIDE)) continue;
    q = vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]);
    least = q < least ? q : least;
  }
  return least;
}

static size_t count_below(const struct vg_tets *t, double shape)
{
  size_t n = 0;

  for (size_t c = 0; c < t->n_cell; c++) {
    const uint32_t *v = t->cell[c].v;

    n += !(t->flag[c] & (VG_DEAD | VG_OUTSIDE)) &&
         vg_shape(t->x[v[0]], t->x[v[1]], t->x[v[2]], t->x[v[3]]) < shape;
  }
  return n;
}

/* --- invariants --------------------------------------------------------- */

static int by_corners(const void *a, const void *b)
{
  return memcmp(a, b, 3 * sizeof(uint32_t));
}

/* The fixed faces of t, each rotated to begin with its lowest corner, sorted.
 * The caller frees. */
static uint32_t (*fixed_faces(const struct vg_tets *t, size_t *n))[3]
{
  uint32_t(*face)[3] = vg_alloc(4 * t->n_cell, sizeof *face);

  assert_non_null(face);
  *n = 0;
  for (size_t c = 0; c < t->n_cell; c++)
    for (int i = 0; i < 4; i++) {
      uint32_t v[3];
      int low = 0;

      if (t->flag[c] & VG_DEAD || !(t->flag[c] >> i & 1)) continue;
      for (int k = 0; k < 3; k++) v[k] = t->cell[c].v[vg_face[i][k]];
      for (int k = 1; k < 3; k++) low = v[k] < v[low] ? k : low;
      for (int k = 0; k < 3; k++) face[*n][k] = v[(low + k) % 3];
      ++*n;
    }
  qsort(face, *n, sizeof *face, by_corners);
  return face;
}

/* Optimise t and compare it with its previous state. */
static struct vg_optimise_report optimise(struct vg_tets *t, size_t n_fixed,
                                          int sweeps)
{
  struct vg_optimise_report r;
  size_t n_face, n_after, n_point = t->n_point;
  uint32_t(*face)[3] = fixed_faces(t, &n_face), (*after)[3];
  double(*x)[3] = vg_alloc(n_fixed, sizeof *x);
  double before = worst(t), volume = tets_volume(t), limit;

  assert_non_null(x);
  memcpy(x, t->x, n_fixed * sizeof *x);
  assert_int_equal(vg_optimise(t, n_fixed, sweeps, NULL, NULL, &r, NULL),
                   VG_OK);
  assert_int_equal(vg_tets_defects(t), 0);
  assert_memory_equal(t->x, x, n_fixed * sizeof *x);
  after = fixed_faces(t, &n_after);
  assert_int_equal(n_after, n_face);
  assert_memory_equal(after, face, n_face * sizeof *face);
  /* shapes are kept in single precision */
  limit = before < aim ? before : aim;
  assert_true(worst(t) >= limit * (1 - 1e-6));
  assert_true(fabs(tets_volume(t) - volume) < 1e-11 * volume);
  assert_int_equal(t->n_point, n_point + r.n_split);
  for (size_t c = 0; c < t->n_cell; c++)
    assert_int_equal(t->flag[c] & (VG_MARK | VG_TRIED), 0);
  free(face);
  free(after);
  free(x);
  return r;
}

/* --- random cells -------------------------------------------------------- */

static void random_cells_get_better(void **state)
{
  (void)state;
  for (uint64_t seed = 1; seed < 5; seed++) {
    struct subject s;
    struct vg_optimise_report r;
    size_t bad;

    random_subject(&s, 5, 400, seed);
    bad = count_below(&s.t, ten_degrees);
    assert_true(bad > 100);
    r = optimise(&s.t, s.m.n_point, 2);
    assert_true(r.n_smoothed > 0 && r.n_flip > 0);
    assert_true(count_below(&s.t, ten_degrees) < bad / 10);
    assert_true(worst(&s.t) > 1e-4);
    subject_end(&s);
  }
}

static void repeated_optimisation_does_not_worsen_cells(void **state)
{
  struct subject s;
  double once;

  (void)state;
  random_subject(&s, 5, 300, 8);
  optimise(&s.t, s.m.n_point, 2);
  once = worst(&s.t);
  for (int k = 0; k < 3; k++) optimise(&s.t, s.m.n_point, k);
  assert_true(worst(&s.t) >= (once < aim ? once : aim) * (1 - 1e-6));
  subject_end(&s);
}

static void the_same_bytes_again(void **state)
{
  struct subject s[2];
  struct vg_optimise_report r[2];

  (void)state;
  for (int k = 0; k < 2; k++) {
    random_subject(&s[k], 5, 400, 12);
    r[k] = optimise(&s[k].t, s[k].m.n_point, 2);
  }
  assert_memory_equal(&r[0], &r[1], sizeof r[0]);
  assert_int_equal(s[0].t.n_cell, s[1].t.n_cell);
  assert_int_equal(s[0].t.n_point, s[1].t.n_point);
  assert_memory_equal(s[0].t.x, s[1].t.x, s[0].t.n_point * sizeof *s[0].t.x);
  assert_memory_equal(s[0].t.flag, s[1].t.flag, s[0].t.n_cell);
  assert_memory_equal(s[0].t.cell, s[1].t.cell,
                      s[0].t.n_cell * sizeof *s[0].t.cell);
  subject_end(&s[0]);
  subject_end(&s[1]);
}

/* --- flat cells ----------------------------------------------------------- */

/* A shape that is not 0 has the sign of the volume, also if points are
 * collinear except for rounding; and none of those cells counts as a good
 * one. */
static void points_in_a_line_are_flat(void **state)
{
  static const int turn[4][4] = {
    { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 3, 0, 1 }, { 3, 2, 1, 0 }
  };
  uint64_t seed = 5;

  (void)state;
  for (int k = 0; k < 20000; k++) {
    double x[4][3], q, from[3], side = k & 1 ? tets_random(&seed) : 0;

    for (int i = 0; i < 3; i++) from[i] = 47 * tets_random(&seed);
    for (int j = 0; j < 4; j++) {
      double t = 0.2 * tets_random(&seed);

      for (int i = 0; i < 3; i++) x[j][i] = from[i] + (i & 1 ? -t : t);
    }
    x[3][0] += side;
    for (int j = 0; j < 4; j++) {
      const double *a = x[turn[j][0]], *b = x[turn[j][1]];
      const double *c = x[turn[j][2]], *d = x[turn[j][3]];

      q = vg_shape(a, b, c, d);
      assert_true(q == 0 || (q > 0) == (vg_orient3d(a, b, c, d) > 0));
      assert_true(q < VG_SHAPE_FLAT);
    }
  }
}

/* Two points almost on an edge of four cells, with five flat cells between them
 * and that edge, one of which has four collinear points. No single step
 * improves all of its cells, but a sequence of steps removes them. */
static void flat_cells_side_by_side_go(void **state)
{
  static const double at[8][3] = { { 0, 0, -1 },
                                   { 0, 0, 1 },
                                   { 1, 1, 0 },
                                   { -1, 1, 0 },
                                   { -1, -1, 0 },
                                   { 1, -1, 0 },
                                   { 1e-17, -1e-18, -0.3 },
                                   { 1e-17, 1e-18, 0.3 } };
  enum { A, B, R, C = 6, D };
  static const uint32_t v[11][4] = {
    { A, B, R, R + 1 }, { A, B, R + 1, R + 2 }, { A, B, R + 2, R + 3 },
    { A, C, R, R + 3 }, { C, D, R, R + 3 },     { D, B, R, R + 3 },
    { A, C, D, R },     { A, D, B, R },         { A, C, B, R + 3 },
    { C, D, B, R + 3 }, { A, C, D, B }
  };
  struct vg_tets t = VG_TETS_INIT;
  double(*x)[3] = vg_alloc(8, sizeof *x);

  (void)state;
  assert_non_null(x);
  memcpy(x, at, sizeof at);
  assert_int_equal(vg_tets_from_cells(&t, 8, x, 11, v, NULL), VG_OK);
  for (uint32_t c = 0; c < t.n_cell; c++)
    for (int i = 0; i < 4; i++)
      if (t.cell[c].link[i] == VG_NONE) t.flag[c] |= (uint8_t)(1 << i);
  assert_int_equal(vg_tets_defects(&t), 0);
  assert_int_equal(count_below(&t, VG_SHAPE_FLAT), 5);
  optimise(&t, 6, 2);
  assert_int_equal(count_below(&t, VG_SHAPE_FLAT), 0);
  vg_tets_release(&t);
}

/* --- artificial slivers -------------------------------------------------- */

/* Four points around the equator of a small sphere, two of them lifted
 * slightly: the Delaunay cell between them is flat. */
static void a_sliver_is_removed(void **state)
{
  static const double lift[4] = { 1e-2, 1e-4, 1e-6, 1e-9 };

  (void)state;
  for (int k = 0; k < 4; k++) {
    struct subject s;
    double r = 0.17, up = lift[k] * r;

    box_subject(&s, 4);
    put(&s, r, 0, up);
    put(&s, -r, 0, up);
    put(&s, 0, r, 0);
    put(&s, 0, -r, 0);
    ready(&s);
    assert_true(worst(&s.t) < 10 * lift[k] * lift[k]);
    optimise(&s.t, s.m.n_point, 2);
    assert_true(worst(&s.t) > ten_degrees);
    subject_end(&s);
  }
}

/* A grid perturbed by less than a millionth: the cells of each cube depend on
 * the rounding of eight points on one sphere. */
static void a_shaken_grid(void **state)
{
  struct subject s;
  uint64_t seed = 19;

  (void)state;
  box_subject(&s, 6);
  for (int i = 0; i < 125; i++) {
    double x[3] = { i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2 };

    for (int k = 0; k < 3; k++)
      x[k] = x[k] / 6 + 1e-7 * (tets_random(&seed) - 0.5);
    put(&s, x[0], x[1], x[2]);
  }
  ready(&s);
  assert_true(worst(&s.t) < 1e-9);
  optimise(&s.t, s.m.n_point, 2);
  assert_true(worst(&s.t) > ten_degrees);
  subject_end(&s);
}

/* --- smoothing ----------------------------------------------------------- */

/* Squared deviation of the squared edges of cells from the sizing field. */
static double size_error(const struct subject *s)
{
  double sum = 0;

  for (size_t c = 0; c < s->t.n_cell; c++) {
    const uint32_t *v = s->t.cell[c].v;
    double middle[3], e = 0, h;

    for (int a = 0; a < 3; a++) {
      middle[a] = 0;
      for (int i = 0; i < 4; i++) {
        middle[a] += s->t.x[v[i]][a] / 4;
        for (int j = 0; j < i; j++)
          e += pow(s->t.x[v[i]][a] - s->t.x[v[j]][a], 2);
      }
    }
    h = vg_sizing_at(s->sizing, middle);
    sum += pow(e / (6 * h * h) - 1, 2);
  }
  return sum / (double)s->t.n_cell;
}

/* Smooth all points except those of the surface, from the same start, by shapes
 * alone or by sizes too; returns the remaining size error. */
static double smooth_points(int by_size, double *mean)
{
  struct subject s;
  struct vg_optimise_report r;
  uint32_t point[125];
  uint64_t seed = 5;
  double before, off;
  float *q;
  size_t n = 0;

  box_subject(&s, 6);
  for (int i = 0; i < 125; i++) {
    double x[3] = { i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2 };

    for (int k = 0; k < 3; k++)
      x[k] = x[k] / 6 + 0.06 * (tets_random(&seed) - 0.5);
    put(&s, x[0], x[1], x[2]);
  }
  ready(&s);
  optimise(&s.t, s.m.n_point, 0);
  before = worst(&s.t);
  q = calloc(s.t.n_cell, sizeof *q);
  for (size_t c = 0; c < s.t.n_cell; c++) {
    const uint32_t *v = s.t.cell[c].v;

    q[c] = (float)vg_shape(s.t.x[v[0]], s.t.x[v[1]], s.t.x[v[2]], s.t.x[v[3]]);
  }
  for (size_t p = s.m.n_point; p < s.t.n_point; p++) point[n++] = (uint32_t)p;
  for (int k = 0; k < 3; k++)
    assert_int_equal(vg_optimise_points(&s.t, n, point, 0.7f,
                                        by_size ? s.sizing : NULL, NULL, q, &r,
                                        NULL),
                     VG_OK);
  assert_true(worst(&s.t) >= fmin(before, aim) * (1 - 1e-6));
  *mean = 0;
  for (size_t c = 0; c < s.t.n_cell; c++) *mean += q[c] / (double)s.t.n_cell;
  off = size_error(&s);
  free(q);
  subject_end(&s);
  return off;
}

static void sizes_count_in_addition_to_shapes(void **state)
{
  double shape[2], off[2];

  (void)state;
  for (int k = 0; k < 2; k++) off[k] = smooth_points(k, &shape[k]);
  assert_true(off[1] < 0.99 * off[0]);
  assert_true(shape[1] > 0.97 * shape[0]);
}

/* --- more cases ---------------------------------------------------------- */

/* A crowd of points at one position can only be thinned out. */
static void surplus_points_are_removed(void **state)
{
  struct subject s;
  struct vg_optimise_report r;
  uint64_t seed = 23;

  (void)state;
  box_subject(&s, 4);
  for (int i = 0; i < 12; i++) {
    double x[3];

    for (int k = 0; k < 3; k++) x[k] = 0.02 * (tets_random(&seed) - 0.5);
    put(&s, x[0], x[1], x[2]);
  }
  ready(&s);
  r = optimise(&s.t, s.m.n_point, 2);
  assert_true(r.n_collapse > 0 || r.n_smoothed > 0);
  assert_true(worst(&s.t) > ten_degrees);
  subject_end(&s);
}

/* --- constraints --------------------------------------------------------- */

/* The cells around a body are not removed, but flagged as outside. */
static void cells_outside_stay(void **state)
{
  struct subject s;
  uint64_t seed = 29;
  size_t n_out = 0;
  struct vg_cell *before;

  (void)state;
  box_subject(&s, 4);
  for (int i = 0; i < 150; i++) {
    double x[3];

    for (int k = 0; k < 3; k++) x[k] = 0.96 * (tets_random(&seed) - 0.5);
    put(&s, x[0], x[1], x[2]);
  }
  vg_inserter_release(&s.s);
  before = vg_alloc(s.t.n_cell, sizeof *before);
  assert_non_null(before);
  memcpy(before, s.t.cell, s.t.n_cell * sizeof *before);
  for (size_t c = 0; c < s.t.n_cell; c++) n_out += !!(s.t.flag[c] & VG_OUTSIDE);
  assert_true(n_out > 100);
  optimise(&s.t, s.m.n_point + 8, 2);
  for (size_t c = 0; c < s.t.n_cell; c++)
    if (s.t.flag[c] & VG_OUTSIDE) {
      assert_memory_equal(s.t.cell[c].v, before[c].v, sizeof before[c].v);
      n_out--;
    }
  assert_int_equal(n_out, 0);
  free(before);
  subject_end(&s);
}

static int by_link(const void *a, const void *b)
{
  uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;

  return x < y ? -1 : x > y;
}

/* The list of all balls has those that a search around each point finds, and
 * is open where the search stops. */
static void all_balls_are_those_of_the_points(void **state)
{
  struct subject s;
  struct vg_optimiser *o = vg_calloc(1, sizeof *o);
  struct vg_balls b;
  size_t n_whole = 0;

  (void)state;
  random_subject(&s, 4, 150, 31);
  assert_non_null(o);
  o->t = &s.t;
  o->star = vg_alloc(s.t.n_point, sizeof *o->star);
  assert_non_null(o->star);
  memset(o->star, 0xff, s.t.n_point * sizeof *o->star);
  for (uint32_t c = 0; c < s.t.n_cell; c++)
    for (int i = 0; i < 4; i++) o->star[s.t.cell[c].v[i]] = c;
  assert_int_equal(vg_balls_init(&s.t, &b), 0);
  for (uint32_t p = 0; p < s.t.n_point; p++) {
    size_t n = b.first[p + 1] - b.first[p];

    assert_int_equal(vg_ball(o, p), !b.is_open[p]);
    if (b.is_open[p]) continue;
    n_whole++;
    assert_int_equal(o->n_ball, n);
    qsort(o->ball, n, sizeof *o->ball, by_link);
    assert_memory_equal(o->ball, b.link + b.first[p], n * sizeof *o->ball);
  }
  assert_int_equal(n_whole, 150);
  vg_balls_release(&b);
  free(o->star);
  free(o);
  subject_end(&s);
}

/* A plane of fixed faces through the fluid is not crossed. */
static void a_fixed_plane_stays(void **state)
{
  const int n[3] = { 4, 4, 4 };
  struct vg_tets t = VG_TETS_INIT;
  struct vg_inserter s;
  uint64_t seed = 31;

  (void)state;
  tets_grid(&t, n);
  for (size_t c = 0; c < t.n_cell; c++)
    for (int i = 0; i < 4; i++) {
      int in = t.cell[c].link[i] == VG_NONE, plane = 0;

      for (int k = 0; k < 3; k++)
        plane += t.x[t.cell[c].v[vg_face[i][k]]][2] == 2;
      if (in || plane == 3) t.flag[c] |= (uint8_t)(1 << i);
    }
  assert_int_equal(vg_inserter_init(&s, &t, NULL), VG_OK);
  for (int i = 0; i < 150; i++) {
    const double x[3] = { 4 * tets_random(&seed), 4 * tets_random(&seed),
                          4 * tets_random(&seed) };

    assert_true(tets_insert(&s, x, 0.1, 0.2) >= 0);
  }
  vg_inserter_release(&s);
  optimise(&t, 125, 2);
  for (size_t c = 0; c < t.n_cell; c++) {
    int above = 0, below = 0;

    for (int i = 0; i < 4 && !(t.flag[c] & VG_DEAD); i++) {
      above |= t.x[t.cell[c].v[i]][2] > 2;
      below |= t.x[t.cell[c].v[i]][2] < 2;
    }
    assert_false(above && below);
  }
  vg_tets_release(&t);
}

/* With every point fixed only swaps and new points remain. */
static void all_points_fixed(void **state)
{
  (void)state;
  for (uint64_t seed = 1; seed < 9; seed++) {
    struct subject s;
    struct vg_optimise_report r;

    random_subject(&s, 4, 150, seed);
    r = optimise(&s.t, s.t.n_point, 2);
    assert_true(r.n_flip > 0);
    subject_end(&s);
  }
}

/* One cell that cannot be improved. */
static void a_single_cell(void **state)
{
  const uint32_t v[1][4] = { { 0, 1, 2, 3 } };
  struct vg_tets t = VG_TETS_INIT;
  double(*x)[3] = vg_calloc(4, sizeof *x);

  (void)state;
  assert_non_null(x);
  x[1][0] = x[2][1] = 1;
  x[3][0] = x[3][1] = 0.3;
  x[3][2] = 1e-3;
  assert_int_equal(vg_tets_from_cells(&t, 4, x, 1, v, NULL), VG_OK);
  t.flag[0] = VG_FIXED_FACES;
  optimise(&t, 4, 2);
  assert_int_equal(tets_live(&t), 1);
  vg_tets_release(&t);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(random_cells_get_better),
    cmocka_unit_test(repeated_optimisation_does_not_worsen_cells),
    cmocka_unit_test(the_same_bytes_again),
    cmocka_unit_test(points_in_a_line_are_flat),
    cmocka_unit_test(flat_cells_side_by_side_go),
    cmocka_unit_test(a_sliver_is_removed),
    cmocka_unit_test(a_shaken_grid),
    cmocka_unit_test(sizes_count_in_addition_to_shapes),
    cmocka_unit_test(surplus_points_are_removed),
    cmocka_unit_test(cells_outside_stay),
    cmocka_unit_test(all_balls_are_those_of_the_points),
    cmocka_unit_test(a_fixed_plane_stays),
    cmocka_unit_test(all_points_fixed),
    cmocka_unit_test(a_single_cell),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
