/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Discretisation errors: exact derivatives, exactness for linear functions, and
 * orders of accuracy on uniformly refined meshes of each kind of cell. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/accuracy/accuracy.h"
#include "core/accuracy/analytic.h"
#include "core/accuracy/walls.h"
#include "judge_support.h"

enum { TETS, PYRAMIDS, PRISMS, HEXES, KINDS };

/* Points of the block [0, 1]^3; above: heights of the levels. */
struct block {
  uint32_t n[3];
  const double *height; /* NULL: equal */
  double shake;         /* displacement of inner points, in spacings */
};

static double noise(uint32_t i)
{
  i = (i ^ 61) ^ (i >> 16);
  i *= 9;
  i ^= i >> 4;
  i *= 0x27d4eb2d;
  i ^= i >> 15;
  return i / 4294967296. - 0.5;
}

static void put_block_points(struct vg_mesh *m, const struct block *b)
{
  for (uint32_t k = 0; k <= b->n[2]; k++)
    for (uint32_t j = 0; j <= b->n[1]; j++)
      for (uint32_t i = 0; i <= b->n[0]; i++) {
        const uint32_t at[3] = { i, j, k };
        double x[3];
        int is_inner = 1;

        for (int c = 0; c < 3; c++) {
          x[c] = (double)at[c] / b->n[c];
          is_inner = is_inner && at[c] > 0 && at[c] < b->n[c];
        }
        if (b->height) x[2] = b->height[k];
        for (int c = 0; c < 3 && is_inner; c++)
          x[c] += b->shake / b->n[c] *
                  noise(3 * (uint32_t)m->n_point + (uint32_t)c);
        shape_point(m, x[0], x[1], x[2]);
      }
}

static void add_tets(struct vg_mesh *m, const uint32_t h[8])
{
  /* around the diagonal from 0 to 6 */
  static const int ring[6] = { 1, 2, 3, 7, 4, 5 };

  for (int t = 0; t < 6; t++) {
    uint32_t *v = m->tet[m->n_tet++];

    v[0] = h[0];
    v[1] = h[ring[t]];
    v[2] = h[ring[(t + 1) % 6]];
    v[3] = h[6];
    if (vg_cell_volume((const double(*)[3])m->point, VG_CELL_TET, v) < 0) {
      v[1] = h[ring[(t + 1) % 6]];
      v[2] = h[ring[t]];
    }
  }
}

static void add_pyramids(struct vg_mesh *m, const uint32_t h[8])
{
  static const int base[6][4] = { { 0, 3, 7, 4 }, { 1, 5, 6, 2 },
                                  { 0, 4, 5, 1 }, { 2, 6, 7, 3 },
                                  { 0, 1, 2, 3 }, { 4, 7, 6, 5 } };
  double x[3] = { 0, 0, 0 };
  uint32_t apex;

  for (int i = 0; i < 8; i++)
    for (int c = 0; c < 3; c++) x[c] += m->point[h[i]][c] / 8;
  apex = shape_point(m, x[0], x[1], x[2]);
  for (int f = 0; f < 6; f++) {
    uint32_t *v = m->pyr[m->n_pyr++];

    /* base 0 3 4 1, apex 2 */
    v[0] = h[base[f][0]];
    v[1] = h[base[f][1]];
    v[4] = h[base[f][2]];
    v[3] = h[base[f][3]];
    v[2] = apex;
    if (vg_cell_volume((const double(*)[3])m->point, VG_CELL_PYR, v) < 0) {
      v[1] = h[base[f][3]];
      v[3] = h[base[f][1]];
    }
  }
}

static void add_prisms(struct vg_mesh *m, const uint32_t h[8])
{
  static const int node[2][6] = { { 0, 1, 2, 4, 5, 6 }, { 0, 2, 3, 4, 6, 7 } };

  for (int p = 0; p < 2; p++, m->n_pri++)
    for (int c = 0; c < 6; c++) m->pri[m->n_pri][c] = h[node[p][c]];
}

/* Patch 0: the wall at z = 0. */
static void put_patches(struct vg_mesh *m)
{
  m->patch = vg_calloc(2, sizeof *m->patch);
  m->tri_patch = vg_alloc(m->n_tri, sizeof *m->tri_patch);
  m->quad_patch = vg_alloc(m->n_quad, sizeof *m->quad_patch);
  shape_need(m->patch);
  shape_need(m->tri_patch);
  shape_need(m->quad_patch);
  m->n_patch = 2;
  m->patch[1].id = 1;
  for (size_t t = 0; t < m->n_tri; t++) {
    const uint32_t *v = m->tri[t];

    m->tri_patch[t] = m->point[v[0]][2] > 0 || m->point[v[1]][2] > 0 ||
                      m->point[v[2]][2] > 0;
  }
  for (size_t q = 0; q < m->n_quad; q++) {
    const uint32_t *v = m->quad[q];

    m->quad_patch[q] = m->point[v[0]][2] > 0 || m->point[v[1]][2] > 0 ||
                       m->point[v[2]][2] > 0 || m->point[v[3]][2] > 0;
  }
}

static struct vg_mesh block_of(int kind, const struct block *b)
{
  const uint32_t *n = b->n, row = n[0] + 1, level = row * (n[1] + 1);
  const size_t n_box = n[0] * n[1] * n[2];
  struct vg_mesh m = VG_MESH_INIT;

  m.tet = vg_alloc(6 * n_box, sizeof *m.tet);
  m.pyr = vg_alloc(6 * n_box, sizeof *m.pyr);
  m.pri = vg_alloc(2 * n_box, sizeof *m.pri);
  m.hex = vg_alloc(n_box, sizeof *m.hex);
  shape_need(m.tet);
  shape_need(m.pyr);
  shape_need(m.pri);
  shape_need(m.hex);
  put_block_points(&m, b);
  for (uint32_t c = 0; c < n_box; c++) {
    uint32_t a = c % n[0] + row * (c / n[0] % n[1]) + level * (c / n[0] / n[1]);
    const uint32_t h[8] = {
      a,         a + 1,         a + 1 + row,         a + row,
      a + level, a + level + 1, a + level + 1 + row, a + level + row
    };

    if (kind == TETS) add_tets(&m, h);
    else if (kind == PYRAMIDS) add_pyramids(&m, h);
    else if (kind == PRISMS) add_prisms(&m, h);
    else memcpy(m.hex[m.n_hex++], h, sizeof h);
  }
  judge_close(&m);
  put_patches(&m);
  return m;
}

static struct vg_mesh cube_of(int kind, uint32_t n, double shake)
{
  const struct block b = { { n, n, n }, NULL, shake };

  return block_of(kind, &b);
}

static struct vg_accuracy_report accuracy_of(const struct vg_mesh *m,
                                             int has_wall, int threads)
{
  const uint8_t is_wall[2] = { (uint8_t)has_wall, 0 };
  const struct vg_accuracy_options o = { .is_wall = is_wall,
                                         .threads = threads,
                                         .with_reference = has_wall };
  struct vg_accuracy_report r;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh_report judged;

  if (vg_mesh_judge(m, NULL, &judged, &err) < 0) fail_msg("%s", err.text);
  assert_true(judged.is_valid);
  if (vg_accuracy_measure(m, &o, &r, &err) < 0) fail_msg("%s", err.text);
  for (int in = 0; in < VG_UNKNOWNS; in++) {
    double volume = r.error[in][VG_FIELD_LINEAR][VG_SCHEME_LSQ][VG_ZONE_ALL]
                      .volume;

    /* rounding of sums of a few thousand positive terms */
    assert_true(fabs(volume - judged.volume) < 1e-11 * judged.volume);
    assert_int_equal(r.n_deficient[in], 0);
  }
  assert_int_equal(r.n[VG_IN_NODES], m->n_point);
  assert_int_equal(r.n[VG_IN_CELLS], judged.n_cell);
  return r;
}

/* --- functions ------------------------------------------------------------ */

static void value_at(const struct vg_field *f, const double x[3],
                     struct vg_field_value *out)
{
  const struct vg_field_scale s = { 2, { 0.1, -0.2, 0.05 }, 0.01 };
  struct vg_place p = { .distance = 0.6 * x[0] + 0.8 * x[2],
                        .normal = { 0.6, 0, 0.8 } };

  memcpy(p.x, x, sizeof p.x);
  f->at(&s, &p, out);
}

/* Central differences; with a step of 1e-4 of the scales below, truncation and
 * rounding stay below 1e-6 of the derivatives. */
static void derivatives_are_exact(void **state)
{
  static const double places[3][3] = { { 0.31, 0.22, 0.4 },
                                       { 0.004, -0.205, 0.051 },
                                       { 0.9, 0.1, 0.02 } };

  (void)state;
  for (int f = 0; f < VG_FIELDS; f++)
    for (int at = 0; at < 3; at++) {
      struct vg_field_value v, a, b;
      double laplacian = 0, step = f == VG_FIELD_WALL ? 1e-6 : 1e-5;
      double most = 0;

      if (f == VG_FIELD_SPHERE && at == 1) continue; /* within the sphere */
      value_at(&vg_fields[f], places[at], &v);
      for (int k = 0; k < 3; k++) most = fmax(most, fabs(v.gradient[k]));
      for (int k = 0; k < 3; k++) {
        double x[3];

        memcpy(x, places[at], sizeof x);
        x[k] += step;
        value_at(&vg_fields[f], x, &a);
        x[k] -= 2 * step;
        value_at(&vg_fields[f], x, &b);
        if (fabs((a.value - b.value) / (2 * step) - v.gradient[k]) >
            1e-5 * most)
          fail_msg("%s: derivative %d is %g, not %g", vg_fields[f].name, k,
                   v.gradient[k], (a.value - b.value) / (2 * step));
        laplacian += (a.gradient[k] - b.gradient[k]) / (2 * step);
      }
      if (fabs(laplacian - v.laplacian) >
          1e-4 * fabs(v.laplacian) + 1e-5 * most)
        fail_msg("%s: Laplacian %g, not %g", vg_fields[f].name, v.laplacian,
                 laplacian);
    }
}

/* u+ at walls, in the middle and in the logarithmic layer, where it is
 * ln(y+) / 0.4 + 5.5 (Schlichting) to 2 %. */
static void profile_has_known_values(void **state)
{
  const struct vg_field_scale s = { 1, { 0, 0, 0 }, 1 };
  struct vg_place p = { .normal = { 0, 0, 1 } };
  struct vg_field_value v;

  (void)state;
  vg_fields[VG_FIELD_WALL].at(&s, &p, &v);
  assert_true(v.value == 0 && fabs(v.gradient[2] - 1) < 1e-15);
  p.distance = 1;
  vg_fields[VG_FIELD_WALL].at(&s, &p, &v);
  assert_true(fabs(v.value - 1) < 0.02);
  p.distance = 300;
  vg_fields[VG_FIELD_WALL].at(&s, &p, &v);
  assert_true(fabs(v.value / (log(300) / 0.4 + 5.5) - 1) < 0.02);
}

/* --- exactness ------------------------------------------------------------ */

static void linear_is_exact(void **state)
{
  (void)state;
  for (int kind = 0; kind < KINDS; kind++) {
    struct vg_mesh m = cube_of(kind, 5, 0.3);
    struct vg_accuracy_report r = accuracy_of(&m, 0, 1);

    for (int in = 0; in < VG_UNKNOWNS; in++)
      for (int s = 0; s <= VG_SCHEME_WLSQ; s++)
        if (!(r.error[in][VG_FIELD_LINEAR][s][VG_ZONE_ALL].max < 1e-12))
          fail_msg("kind %d, in %d, scheme %d: %g", kind, in, s,
                   r.error[in][VG_FIELD_LINEAR][s][VG_ZONE_ALL].max);
    vg_accuracy_release(&r);
    vg_mesh_release(&m);
  }
}

/* Green-Gauss is exact for nodes of any tetrahedra, and on boxes. */
static void gauss_is_exact_on_tets_and_boxes(void **state)
{
  const double height[6] = { 0, 0.01, 0.05, 0.2, 0.6, 1.4 };
  const struct block stretched = { { 4, 3, 5 }, height, 0 };

  (void)state;
  for (int which = 0; which < 2; which++) {
    struct vg_mesh m = which ? block_of(HEXES, &stretched)
                             : cube_of(TETS, 5, 0.3);
    struct vg_accuracy_report r = accuracy_of(&m, 0, 1);

    for (int in = 0; in <= which; in++)
      if (!(r.error[in][VG_FIELD_LINEAR][VG_SCHEME_GAUSS][VG_ZONE_ALL].max <
            1e-12))
        fail_msg(
          "%d, in %d: %g", which, in,
          r.error[in][VG_FIELD_LINEAR][VG_SCHEME_GAUSS][VG_ZONE_ALL].max);
    vg_accuracy_release(&r);
    vg_mesh_release(&m);
  }
}

/* --- order of accuracy ---------------------------------------------------- */

/* Expected orders on uniform meshes, in the 1-norm, in which the lower order at
 * the boundary does not hide that of the interior. The stencils of the points
 * are symmetric, so that all schemes are of second order. In the cells,
 * gradients are of first order if the stencil is not symmetric; Green-Gauss
 * without correction and the Laplacian are not consistent on skewed faces
 * (order 0). */
static const double order[KINDS][VG_UNKNOWNS][VG_SCHEMES] = {
  [TETS] = { { 2, 2, 2, 2 }, { 1, 1, 0, 0 } },
  [PYRAMIDS] = { { 2, 2, 2, 2 }, { 1, 1, 0, 0 } },
  [PRISMS] = { { 2, 2, 2, 2 }, { 1.5, 1.5, 1.5, 0.5 } },
  [HEXES] = { { 2, 2, 2, 2 }, { 2, 2, 2, 1.75 } }
};

/* From 12 to 24 intervals the observed orders differ from those of infinitely
 * fine meshes by up to 0.12. */
#define ORDER_TOLERANCE 0.15

static void orders_are_as_expected(void **state)
{
  (void)state;
  for (int kind = 0; kind < KINDS; kind++) {
    double error[3][VG_UNKNOWNS][VG_SCHEMES];

    for (uint32_t level = 0; level < 3; level++) {
      struct vg_mesh m = cube_of(kind, 6U << level, 0);
      struct vg_accuracy_report r = accuracy_of(&m, 0, 2);

      for (int in = 0; in < VG_UNKNOWNS; in++)
        for (int s = 0; s < VG_SCHEMES; s++)
          error[level][in][s] = r.error[in][VG_FIELD_VORTEX][s][VG_ZONE_ALL].l1;
      vg_accuracy_release(&r);
      vg_mesh_release(&m);
    }
    for (int in = 0; in < VG_UNKNOWNS; in++)
      for (int s = 0; s < VG_SCHEMES; s++) {
        double want = order[kind][in][s];
        double got = log2(error[1][in][s] / error[2][in][s]);

        if (!(fabs(got - want) < ORDER_TOLERANCE))
          fail_msg("kind %d, in %d, scheme %d: order %.3f, not %.2f", kind, in,
                   s, got, want);
        if (want > 0) assert_true(error[0][in][s] > error[1][in][s]);
      }
  }
}

/* --- walls ---------------------------------------------------------------- */

enum { ALONG = 20, LEVELS = 30 };

/* Layers on a plate as those of vanguard: first height 1e-5, growth 1.2, y+ 1
 * at the first height. */
static struct vg_mesh plate_of(int kind)
{
  double height[LEVELS + 1] = { 0 }, step = 1e-5;
  const struct block b = { { ALONG, ALONG, LEVELS }, height, 0 };

  for (int k = 0; k < LEVELS; k++, step *= 1.2)
    height[k + 1] = height[k] + step;
  return block_of(kind, &b);
}

/* The judge's own plate has the same heights up to y+ 1000, so that hexahedra
 * have its errors but for the growth, which it chooses so that a level is at
 * y+ 1000: within 10 %. The wall profile does not vary along the plate, so that
 * prisms have the same gradients at the points. */
static void hexes_on_plate_match_reference(void **state)
{
  struct vg_mesh m = plate_of(HEXES), p = plate_of(PRISMS);
  struct vg_accuracy_report r = accuracy_of(&m, 1, 1),
                            q = accuracy_of(&p, 1, 1);
  const struct vg_accuracy_reference *ref = &r.reference[VG_REFERENCE_PLATE];

  (void)state;
  assert_true(fabs(r.first_height / 1e-5 - 1) < 1e-12);
  assert_true(fabs(r.wall_area - 1) < 1e-12);
  assert_int_equal(r.n_wall, (ALONG + 1) * (ALONG + 1));
  assert_true(r.has_reference && fabs(ref->growth - 1.2) < 0.01);
  for (int in = 0; in < VG_UNKNOWNS; in++)
    for (int s = 0; s < VG_SCHEMES; s++) {
      double got = r.error[in][VG_FIELD_WALL][s][VG_ZONE_LAYERS].l2;

      assert_true(got > 0 && fabs(got / ref->layers[in][s].l2 - 1) < 0.1);
    }
  for (int s = 0; s < VG_SCHEME_VISCOUS; s++) {
    double a = r.error[VG_IN_NODES][VG_FIELD_WALL][s][VG_ZONE_LAYERS].l2;
    double b = q.error[VG_IN_NODES][VG_FIELD_WALL][s][VG_ZONE_LAYERS].l2;

    assert_true(fabs(a / b - 1) < 0.3);
  }
  vg_accuracy_release(&r);
  vg_accuracy_release(&q);
  vg_mesh_release(&m);
  vg_mesh_release(&p);
}

/* u+ at the first point (y+ 1) and at the centre of the first cell (y+ 1/2),
 * over y+, by the formula of Reichardt: the wall shear from the first cells. */
static double mean_slope(double y)
{
  return (log1p(0.4 * y) / 0.4 +
          7.8 * (1 - exp(-y / 11) - y / 11 * exp(-0.33 * y))) /
         y;
}

static void shear_is_slope_of_first_cell(void **state)
{
  struct vg_mesh m = plate_of(HEXES);
  struct vg_accuracy_report r = accuracy_of(&m, 1, 1);

  (void)state;
  assert_int_equal(r.n_patch, 1);
  assert_int_equal(r.patch[0].n[VG_IN_CELLS], ALONG * ALONG);
  for (int in = 0; in < VG_UNKNOWNS; in++) {
    double want = mean_slope(in == VG_IN_NODES ? 1 : 0.5);

    assert_true(fabs(r.patch[0].shear_mean[in] - want) < 1e-9);
    assert_true(fabs(r.patch[0].shear_l2[in] - fabs(want - 1)) < 1e-9);
    assert_true(fabs(r.patch[0].shear_max[in] - fabs(want - 1)) < 1e-9);
  }
  vg_accuracy_release(&r);
  vg_mesh_release(&m);
}

/* Bit by bit, padding apart. */
static void threads_do_not_matter(void **state)
{
  struct vg_mesh m = plate_of(TETS);
  struct vg_accuracy_report a = accuracy_of(&m, 1, 1),
                            b = accuracy_of(&m, 1, 3);

  (void)state;
  assert_memory_equal(&a.error, &b.error, sizeof a.error);
  assert_memory_equal(&a.reference, &b.reference, sizeof a.reference);
  assert_memory_equal(a.patch, b.patch, sizeof *a.patch);
  vg_accuracy_release(&a);
  vg_accuracy_release(&b);
  vg_mesh_release(&m);
}

/* Distance and normal above a plate, on it, and beyond its rim. */
static void walls_end_at_their_rim(void **state)
{
  static const struct {
    double x[3], distance, normal;
  } want[3] = { { { 0.33, 0.41, 0.2 }, 0.2, 1 },
                { { 0.5, 0.25, 0 }, 0, 1 },
                { { -0.3, 0.5, 0.4 }, 0.5, 0 } };
  static const uint8_t is_wall[2] = { 1, 0 };

  (void)state;
  for (int kind = TETS; kind < KINDS; kind++) {
    struct vg_mesh m = cube_of(kind, 4, 0);
    struct vg_wall_search s = VG_WALL_SEARCH_INIT;
    struct vg_error err = VG_ERROR_INIT;

    if (vg_wall_search_open(&s, &m, is_wall, &err) < 0)
      fail_msg("%s", err.text);
    for (int i = 0; i < 3; i++) {
      struct vg_place p;

      memcpy(p.x, want[i].x, sizeof p.x);
      vg_wall_search_ask(&s, &p);
      assert_true(fabs(p.distance - want[i].distance) < 1e-15);
      assert_true(p.normal[0] == 0 && p.normal[1] == 0);
      assert_true(fabs(p.normal[2] - want[i].normal) < 1e-15);
    }
    vg_wall_search_release(&s);
    vg_mesh_release(&m);
  }
}

/* A mesh without a point above a wall has no wall profile. */
static void walls_may_be_everywhere(void **state)
{
  const uint8_t is_wall[2] = { 1, 1 };
  const struct vg_accuracy_options o = { .is_wall = is_wall,
                                         .threads = 1,
                                         .with_reference = 1 };
  struct vg_mesh m = cube_of(HEXES, 1, 0);
  struct vg_accuracy_report r;
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  if (vg_accuracy_measure(&m, &o, &r, &err) < 0) fail_msg("%s", err.text);
  assert_true(r.first_height == 0 && !r.has_reference);
  assert_int_equal(
    r.error[VG_IN_NODES][VG_FIELD_WALL][VG_SCHEME_LSQ][VG_ZONE_LAYERS].n, 0);
  assert_int_equal(
    r.error[VG_IN_NODES][VG_FIELD_LINEAR][VG_SCHEME_LSQ][VG_ZONE_ALL].n, 8);
  vg_accuracy_release(&r);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(derivatives_are_exact),
    cmocka_unit_test(profile_has_known_values),
    cmocka_unit_test(linear_is_exact),
    cmocka_unit_test(gauss_is_exact_on_tets_and_boxes),
    cmocka_unit_test(orders_are_as_expected),
    cmocka_unit_test(hexes_on_plate_match_reference),
    cmocka_unit_test(shear_is_slope_of_first_cell),
    cmocka_unit_test(threads_do_not_matter),
    cmocka_unit_test(walls_end_at_their_rim),
    cmocka_unit_test(walls_may_be_everywhere),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
