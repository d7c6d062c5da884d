/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Figures of the mesh check in the metric: known lengths and shapes, an
 * independent computation, affine images, and meshes in slices. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/memory.h"
#include "judge_support.h"
#include "metric_support.h"
#include "tensor_support.h"

#define assert_near(a, b, tolerance)                                           \
  do {                                                                         \
    if (!(fabs((a) - (b)) <= (tolerance)))                                     \
      fail_msg("%.17g is not within %g of %.17g", (double)(a),                 \
               (double)(tolerance), (double)(b));                              \
  } while (0)

static struct vg_mesh_report judge(const struct vg_mesh *m,
                                   const struct vg_sizing *sizing)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_mesh_judge_in_metric(m, 0, sizing, &r, &err) < 0)
    fail_msg("%s", err.text);
  assert_int_equal(r.has_metric, 1);
  return r;
}

/* --- constant metrics ---------------------------------------------------- */

static struct vg_sizing *constant_field(const struct vg_mesh *m, double form[6])
{
  const struct vg_size_map map = { .at = constant_size,
                                   .metric = constant_metric,
                                   .user = form };

  return metric_field(&map, m);
}

static struct vg_sizing *uniform_field(const struct vg_mesh *m, double h)
{
  const struct vg_source everywhere = { .kind = VG_SOURCE_SPHERE,
                                        .h0 = h,
                                        .r0 = 1e3 };
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_sizing *sizing = NULL;

  options.from_surface = 0;
  assert_int_equal(vg_sizing_new(&options, 1, &everywhere, m, &sizing, NULL),
                   VG_OK);
  return sizing;
}

/* The octree of a field stores sizes in single precision. */
#define FIELD_EPS 1e-6

/* A regular tetrahedron with edges of length 1: one cell of ideal shape. */
static struct vg_mesh regular(void)
{
  struct vg_mesh m = VG_MESH_INIT;
  double root = 1 / sqrt(8);

  shape_point(&m, root, root, root);
  shape_point(&m, -root, -root, root);
  shape_point(&m, -root, root, -root);
  shape_point(&m, root, -root, -root);
  m.n_tet = 1;
  m.tet = vg_alloc(1, sizeof *m.tet);
  shape_need(m.tet);
  memcpy(m.tet[0], (uint32_t[4]){ 0, 1, 2, 3 }, sizeof *m.tet);
  if (!vg_cell_positive((const double(*)[3])m.point, VG_CELL_TET, m.tet[0]))
    judge_swap(&m.tet[0][0], &m.tet[0][1]);
  judge_close(&m);
  return m;
}

static void a_regular_tetrahedron_is_ideal(void **state)
{
  static const double h[] = { 1, 0.5, 1. / 3, 2.5 };
  struct vg_mesh m = regular();

  (void)state;
  for (size_t i = 0; i < sizeof h / sizeof *h; i++) {
    struct vg_sizing *sizing = uniform_field(&m, h[i]);
    struct vg_mesh_report r = judge(&m, sizing);
    double length = 1 / h[i], cube = length * length * length;

    assert_int_equal(r.metric.n_edge, 6);
    assert_int_equal(r.metric.n_cell, 1);
    assert_near(r.metric.length_min, length, FIELD_EPS * length);
    assert_near(r.metric.length_max, length, FIELD_EPS * length);
    assert_near(r.metric.mean_ratio_mean, 1, 1e-12);
    assert_near(r.metric.mean_ratio_min, 1, 1e-12);
    assert_near(r.metric.ideal, cube, FIELD_EPS * cube);
    assert_near(r.metric.complexity, cube / sqrt(72), FIELD_EPS * cube);
    assert_near(r.metric.within[0], h[i] == 1 ? 100 : 0, 0);
    assert_int_equal(r.metric.hist_mean_ratio[VG_HIST_UNIT - 1], 1);
    /* the figures of edges leave out the boundary */
    assert_near(r.edge_mean, 0, 0);
    vg_sizing_free(sizing);
  }
  vg_mesh_release(&m);
}

/* An inverted and a flat cell have no shape, and are counted as such. */
static void cells_without_volume_have_mean_ratio_0(void **state)
{
  struct vg_mesh m = regular();
  struct vg_sizing *sizing = uniform_field(&m, 1);
  struct vg_mesh_report r;

  (void)state;
  judge_swap(&m.tet[0][0], &m.tet[0][1]);
  r = judge(&m, sizing);
  assert_near(r.metric.mean_ratio_min, 0, 0);
  assert_near(r.metric.below[0], 100, 0);
  assert_near(r.metric.below[1], 100, 0);
  memcpy(m.point[3], m.point[0], sizeof *m.point);
  r = judge(&m, sizing);
  assert_near(r.metric.mean_ratio_mean, 0, 0);
  assert_near(r.metric.length_min, 0, 0);
  assert_near(r.metric.complexity, 0, 0);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

/* Bins begin at powers of 2^(1/12), to which no length of the test is closer
 * than rounding. */
static void lengths_are_counted_in_twelfths_of_an_octave(void **state)
{
  struct vg_mesh m = regular();

  (void)state;
  for (int k = -4; k < VG_HIST_LENGTH + 4; k++) {
    double length = exp2((k + 0.5) / VG_PER_OCTAVE - 5);
    struct vg_sizing *sizing = uniform_field(&m, 1 / length);
    struct vg_mesh_report r = judge(&m, sizing);
    int bin = k < 0 ? 0 : k < VG_HIST_LENGTH ? k : VG_HIST_LENGTH - 1;

    assert_int_equal(r.metric.hist_length[bin], 6);
    assert_near(r.metric.within[0], length > 0.7 && length < 1.4 ? 100 : 0, 0);
    assert_near(r.metric.within[1],
                length * length > 0.5 && length * length < 2 ? 100 : 0, 0);
    assert_near(r.metric.within[2], length > 0.5 && length < 2 ? 100 : 0, 0);
    vg_sizing_free(sizing);
  }
  vg_mesh_release(&m);
}

/* --- affine images ------------------------------------------------------- */

static double random_unit(uint64_t *seed)
{
  return (double)(model_random(seed) % 1000003) / 1000003;
}

/* Map m by a random matrix a of determinant > 1; form becomes the metric
 * (a a')^-1 / h^2, in which the image has the lengths that m has for size h. */
static void transform(struct vg_mesh *m, double h, uint64_t seed,
                      double form[6])
{
  double a[3][3], det = 0, s[6];

  while (!(det > 1)) {
    for (int i = 0; i < 9; i++) a[i / 3][i % 3] = 4 * random_unit(&seed) - 2;
    det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
          a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
          a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
  }
  for (size_t p = 0; p < m->n_point; p++) {
    double *x = m->point[p], y[3];

    for (int i = 0; i < 3; i++)
      y[i] = a[i][0] * x[0] + a[i][1] * x[1] + a[i][2] * x[2];
    memcpy(x, y, sizeof y);
  }
  for (int i = 0, n = 0; i < 3; i++)
    for (int j = i; j < 3; j++, n++)
      s[n] = h * h *
             (a[i][0] * a[j][0] + a[i][1] * a[j][1] + a[i][2] * a[j][2]);
  vg_tensor_invert(s, form);
}

/* Sizes in single precision, times the condition number of the matrix. Up to
 * one per cent of the edges and cells are that close to the limit of a bin. */
static void assert_similar(const struct vg_metric_report *a,
                           const struct vg_metric_report *b)
{
  const double eps = 1e-4;
  size_t moved = 0;

  assert_int_equal(a->n_edge, b->n_edge);
  assert_int_equal(a->n_cell, b->n_cell);
  assert_near(a->length_min, b->length_min, eps);
  assert_near(a->length_max, b->length_max, eps);
  assert_near(a->mean_ratio_mean, b->mean_ratio_mean, eps);
  assert_near(a->mean_ratio_min, b->mean_ratio_min, eps);
  assert_near(a->complexity, b->complexity, eps * b->complexity);
  assert_near(a->ideal, b->ideal, eps * b->ideal);
  for (int k = 0; k < 3; k++) assert_near(a->within[k], b->within[k], 1);
  for (int k = 0; k < 2; k++) assert_near(a->below[k], b->below[k], 1);
  for (int k = 0; k < VG_HIST_LENGTH; k++)
    moved += (size_t)labs((long)a->hist_length[k] - (long)b->hist_length[k]);
  for (int k = 0; k < VG_HIST_UNIT; k++)
    moved += (size_t)labs((long)a->hist_mean_ratio[k] -
                          (long)b->hist_mean_ratio[k]);
  assert_true(100 * moved <= a->n_edge + a->n_cell);
}

static void affine_images_have_the_figures_of_the_original(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  /* no edge of the box has a length at the limit of a bin */
  const double h = 0.137;
  struct vg_sizing *sizing = uniform_field(&m, h);
  struct vg_mesh_report want = judge(&m, sizing);

  (void)state;
  assert_true(want.metric.n_edge > 1000 && want.metric.mean_ratio_mean > 0.1);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
  for (uint64_t seed = 1; seed < 9; seed++) {
    struct vg_mesh_report r, whole;
    struct cut c;
    double form[6];

    m = judge_mesh(VG_LAYER_TETS);
    transform(&m, h, seed, form);
    sizing = constant_field(&m, form);
    r = judge(&m, sizing);
    assert_similar(&r.metric, &want.metric);
    cut_make(&c, &m, 9, 0, NULL, seed);
    assert_int_equal(vg_slices_judge(NULL, &c.s, 0, sizing, 2, &whole, NULL,
                                     NULL),
                     VG_OK);
    assert_same_report(&whole, &r);
    cut_release(&c);
    vg_sizing_free(sizing);
    vg_mesh_release(&m);
  }
}

/* --- metrics that vary --------------------------------------------------- */

struct pair {
  uint32_t a, b;
};

static int by_ends(const void *p, const void *q)
{
  return memcmp(p, q, sizeof(struct pair));
}

/* All edges of tetrahedra, each once. */
static size_t list_edges(const struct vg_mesh *m, struct pair *list)
{
  static const int end[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 },
                                 { 1, 2 }, { 1, 3 }, { 2, 3 } };
  size_t n = 0, kept = 0;

  for (size_t i = 0; i < m->n_tet; i++)
    for (int k = 0; k < 6; k++) {
      uint32_t a = m->tet[i][end[k][0]], b = m->tet[i][end[k][1]];

      list[n++] = a < b ? (struct pair){ a, b } : (struct pair){ b, a };
    }
  qsort(list, n, sizeof *list, by_ends);
  for (size_t i = 0; i < n; i++)
    if (!i || by_ends(&list[i], &list[i - 1])) list[kept++] = list[i];
  return kept;
}

static void metric_at(const struct vg_sizing *sizing, const double x[3],
                      double form[6])
{
  double t[6];

  vg_sizing_stretch_at(sizing, x, t);
  vg_tensor_square(t, form);
}

static double length_by_logarithm(const struct vg_mesh *m, struct pair e,
                                  const struct vg_sizing *sizing)
{
  double v[3], form[6], l[2];

  for (int k = 0; k < 3; k++) v[k] = m->point[e.b][k] - m->point[e.a][k];
  for (int k = 0; k < 2; k++) {
    metric_at(sizing, m->point[k ? e.b : e.a], form);
    l[k] = sqrt(vg_tensor_form(form, v));
  }
  return fabs(l[0] - l[1]) < 1e-6 * l[0] ? (l[0] + l[1]) / 2
                                         : (l[0] - l[1]) / log(l[0] / l[1]);
}

/* By the definition, in the corner metric of the largest determinant. */
static double mean_ratio_of(const struct vg_mesh *m, const uint32_t node[4],
                            const struct vg_sizing *sizing)
{
  double best[6] = { 0 }, most = 0, sum = 0, volume;

  for (int k = 0; k < 4; k++) {
    double form[6];

    metric_at(sizing, m->point[node[k]], form);
    if (vg_tensor_det(form) <= most) continue;
    most = vg_tensor_det(form);
    memcpy(best, form, sizeof best);
  }
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < a; b++) {
      double v[3];

      for (int k = 0; k < 3; k++)
        v[k] = m->point[node[a]][k] - m->point[node[b]][k];
      sum += vg_tensor_form(best, v);
    }
  volume = vg_cell_volume((const double(*)[3])m->point, VG_CELL_TET, node) *
           sqrt(most);
  return pow(volume * sqrt(72), 2. / 3) / (sum / 6);
}

/* sqrt(det M) over a cell, by the mean over many points. */
static double density_of(const struct vg_mesh *m, const uint32_t node[4],
                         const struct vg_sizing *sizing)
{
  enum { PARTS = 12 };
  double sum = 0, form[6], x[3];
  int n = 0;

  for (int i = 0; i < PARTS; i++)
    for (int j = 0; i + j < PARTS; j++)
      for (int k = 0; i + j + k < PARTS; k++, n++) {
        double w[4] = { i + 0.25, j + 0.25, k + 0.25, 0 };

        w[3] = PARTS - 1 - i - j - k + 0.25;
        for (int c = 0; c < 3; c++)
          x[c] = (w[0] * m->point[node[0]][c] + w[1] * m->point[node[1]][c] +
                  w[2] * m->point[node[2]][c] + w[3] * m->point[node[3]][c]) /
                 PARTS;
        metric_at(sizing, x, form);
        sum += sqrt(vg_tensor_det(form));
      }
  return sum / n *
         vg_cell_volume((const double(*)[3])m->point, VG_CELL_TET, node);
}

/* Figures of struct vg_metric_report, by the definitions. */
static void check_figures(const struct vg_mesh *m,
                          const struct vg_sizing *sizing,
                          const struct vg_metric_report *r)
{
  struct pair *edge = vg_alloc(6 * m->n_tet, sizeof *edge);
  double shortest = INFINITY, longest = 0, ratio = 0, worst = 1, complexity = 0;
  size_t n, within = 0;

  shape_need(edge);
  n = list_edges(m, edge);
  for (size_t i = 0; i < n; i++) {
    double l = length_by_logarithm(m, edge[i], sizing);

    shortest = fmin(shortest, l);
    longest = fmax(longest, l);
    within += l >= 0.7 && l <= 1.4;
  }
  for (size_t i = 0; i < m->n_tet; i++) {
    double q = mean_ratio_of(m, m->tet[i], sizing);

    ratio += q;
    worst = fmin(worst, q);
    complexity += density_of(m, m->tet[i], sizing);
  }
  assert_int_equal(r->n_edge, n);
  assert_int_equal(r->n_cell, m->n_tet);
  /* the error of the logarithmic mean (core/geometry/tensor.h) */
  assert_near(r->length_min, shortest, 1e-3 * shortest);
  assert_near(r->length_max, longest, 1e-3 * longest);
  assert_near(r->within[0], 100 * (double)within / (double)n, 0.2);
  assert_near(r->mean_ratio_mean, ratio / (double)m->n_tet, 1e-9);
  assert_near(r->mean_ratio_min, worst, 1e-9);
  /* large cells: the rule over a cell is of second order */
  assert_near(r->complexity, complexity, 0.03 * complexity);
  free(edge);
}

static void figures_are_those_of_the_definitions(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  double scale = 0.1;
  struct vg_sizing *sizing = metric_oblique_field(&m, &scale);
  struct vg_mesh_report r = judge(&m, sizing), s;

  (void)state;
  check_figures(&m, sizing, &r.metric);
  /* for a stretched field without asking */
  assert_int_equal(vg_mesh_judge(&m, sizing, &s, NULL), VG_OK);
  assert_same_report(&r, &s);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

/* Only tetrahedra count: the edges and cells of layers of prisms do not. */
static void layers_of_prisms_are_left_out(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_MIXED);
  double scale = 0.1;
  struct vg_sizing *sizing = metric_oblique_field(&m, &scale);
  struct vg_mesh_report r = judge(&m, sizing);

  (void)state;
  assert_true(m.n_pri > 100);
  check_figures(&m, sizing, &r.metric);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

/* Nor do tetrahedra of layers, the first ones of the mesh: the figures are
 * those of the others alone. */
static void layers_of_tetrahedra_are_left_out(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  double scale = 0.1;
  struct vg_sizing *sizing = metric_oblique_field(&m, &scale);
  struct vg_mesh_report r, whole;
  size_t n = m.n_tet, n_layer = n / 3;

  (void)state;
  assert_int_equal(vg_mesh_judge_in_metric(&m, n_layer, sizing, &r, NULL),
                   VG_OK);
  assert_int_equal(vg_mesh_judge(&m, NULL, &whole, NULL), VG_OK);
  assert_near(r.volume, whole.volume, 0);
  assert_int_equal(r.metric.n_cell, n - n_layer);
  memmove(m.tet, m.tet + n_layer, (n - n_layer) * sizeof *m.tet);
  m.n_tet = n - n_layer;
  check_figures(&m, sizing, &r.metric);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

/* The size of an isotropic field stands for its metric; without a request
 * there are no figures in it. */
static void isotropic_fields_on_request(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_sizing *sizing = uniform_field(&m, 0.2);
  struct vg_mesh_report r = judge(&m, sizing), s;
  struct vg_metric_report none = { 0 };

  (void)state;
  assert_near(r.metric.complexity, r.volume / 0.008,
              FIELD_EPS * r.volume / 0.008);
  assert_near(r.metric.mean_ratio_mean, r.mean_ratio_mean, 1e-12);
  assert_int_equal(vg_mesh_judge(&m, sizing, &s, NULL), VG_OK);
  assert_int_equal(s.has_metric, 0);
  assert_memory_equal(&s.metric, &none, sizeof none);
  assert_near(s.edge_mean, r.edge_mean, FIELD_EPS);
  assert_near(s.edge_within, r.edge_within, 1e-9);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

/* --- slices -------------------------------------------------------------- */

static void check_cuts(const struct vg_mesh *m, const struct vg_sizing *sizing)
{
  static const size_t n_slice[] = { 1, 2, 7, 40 };
  struct vg_mesh_report whole, r;

  assert_int_equal(vg_mesh_judge(m, sizing, &whole, NULL), VG_OK);
  for (size_t i = 0; i < sizeof n_slice / sizeof *n_slice; i++) {
    struct cut c;

    cut_make(&c, m, n_slice[i], 0, NULL, 17 + i);
    for (int threads = 1; threads < 4; threads += 2) {
      assert_int_equal(vg_slices_judge(NULL, &c.s, 0, sizing, threads, &r, NULL,
                                       NULL),
                       VG_OK);
      assert_same_report(&r, &whole);
    }
    cut_release(&c);
  }
}

static void slices_give_the_figures_of_the_whole(void **state)
{
  (void)state;
  for (int cells = 0; cells < 2; cells++) {
    struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS);
    double scale = 0.1;
    struct vg_sizing *sizing = metric_oblique_field(&m, &scale);

    check_cuts(&m, sizing);
    vg_sizing_free(sizing);
    vg_mesh_release(&m);
  }
}

static void also_of_invalid_meshes(void **state)
{
  (void)state;
  for (int damage = 0; damage < JUDGE_DAMAGES; damage++)
    for (int cells = 0; cells < 2; cells++) {
      struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS);
      double scale = 0.1;
      struct vg_sizing *sizing = metric_oblique_field(&m, &scale);

      judge_damage(&m, damage, 0);
      check_cuts(&m, sizing);
      vg_sizing_free(sizing);
      vg_mesh_release(&m);
    }
}

/* The figures of the isotropic region are those of a mesh of its cells. */
static void the_isotropic_region_alone(void **state)
{
  (void)state;
  for (int cells = 0; cells < 2; cells++) {
    struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS), part;
    double scale = 0.1;
    struct vg_sizing *sizing = metric_oblique_field(&m, &scale);
    struct vg_mesh_report whole, field, want;
    struct cut c;

    cut_make(&c, &m, 11, 0, NULL, 3);
    part = judge_field(&c);
    assert_int_equal(vg_mesh_judge(&part, sizing, &want, NULL), VG_OK);
    if (vg_slices_judge(NULL, &c.s, part.n_tri + part.n_quad, sizing, 2, &whole,
                        &field, NULL) < 0)
      abort();
    assert_int_equal(whole.has_metric, 0);
    judge_map_worst(&c, &want);
    want.enclosed = want.volume;
    want.volume_error = 0;
    assert_same_report(&field, &want);
    assert_true(field.metric.n_cell < m.n_tet);
    cut_release(&c);
    vg_mesh_release(&part);
    vg_sizing_free(sizing);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_regular_tetrahedron_is_ideal),
    cmocka_unit_test(cells_without_volume_have_mean_ratio_0),
    cmocka_unit_test(lengths_are_counted_in_twelfths_of_an_octave),
    cmocka_unit_test(affine_images_have_the_figures_of_the_original),
    cmocka_unit_test(figures_are_those_of_the_definitions),
    cmocka_unit_test(layers_of_prisms_are_left_out),
    cmocka_unit_test(layers_of_tetrahedra_are_left_out),
    cmocka_unit_test(isotropic_fields_on_request),
    cmocka_unit_test(slices_give_the_figures_of_the_whole),
    cmocka_unit_test(also_of_invalid_meshes),
    cmocka_unit_test(the_isotropic_region_alone),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
