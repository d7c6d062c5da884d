/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Quality in the terms of solvers: meshes of which the figures are known in
 * closed form, and tetrahedra compared with the definitions. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "judge_support.h"

#define DEGREE 57.295779513082320877

static struct vg_mesh_report judged(const struct vg_mesh *m)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_mesh_judge(m, NULL, &r, &err) < 0) fail_msg("%s", err.text);
  assert_true(r.is_valid);
  assert_true(r.has_solver);
  return r;
}

static void near_to(double got, double want)
{
  if (!(fabs(got - want) < 1e-9)) fail_msg("%.15g, not %.15g", got, want);
}

/* --- hexahedra ------------------------------------------------------------ */

enum { SIDE = 3, ROW = SIDE + 1, LEVEL = ROW * ROW };

/* A block of SIDE^3 cubes with levels at these heights, sheared in x. */
static struct vg_mesh hexes(const double z[ROW], double shear)
{
  struct vg_mesh m = VG_MESH_INIT;

  m.hex = vg_alloc(SIDE * SIDE * SIDE, sizeof *m.hex);
  shape_need(m.hex);
  for (uint32_t i = 0; i < LEVEL * ROW; i++)
    shape_point(&m, i % ROW + shear * z[i / LEVEL], i / ROW % ROW,
                z[i / LEVEL]);
  for (uint32_t c = 0; c < SIDE * SIDE * SIDE; c++) {
    uint32_t a = c % SIDE + ROW * (c / SIDE % SIDE) + LEVEL * (c / SIDE / SIDE);
    const uint32_t node[8] = {
      a,         a + 1,         a + 1 + ROW,         a + ROW,
      a + LEVEL, a + LEVEL + 1, a + LEVEL + 1 + ROW, a + LEVEL + ROW
    };

    memcpy(m.hex[m.n_hex++], node, sizeof node);
  }
  judge_close(&m);
  return m;
}

/* Two thirds of the inner faces have the angle of the shear; the same angle is
 * between A and f. A cell in a corner keeps one face of each direction. */
static void sheared_hexahedra(void **state)
{
  static const double z[ROW] = { 0, 1, 2, 3 };
  const double angle = 35 / DEGREE, mean = (2 + 1 / cos(angle)) / 3;
  struct vg_mesh m = hexes(z, tan(angle));
  struct vg_mesh_report r = judged(&m);
  const struct vg_solver_quality *q = &r.solver;

  (void)state;
  assert_int_equal(q->n_face, 3 * 18);
  assert_int_equal(q->n_boundary_face, 6 * 9);
  near_to(q->angle_max, 35);
  near_to(cos(q->angle_mean / DEGREE), (1 + 2 * cos(angle)) / 3);
  assert_int_equal(q->n_angle, 0);
  assert_int_equal(q->hist_angle[0], 18);
  assert_int_equal(q->hist_angle[6] + q->hist_angle[7], 36);
  near_to(q->skewness_max, tan(angle)); /* of the lowest and highest faces */
  near_to(q->weight_min, 0.5);
  near_to(q->volume_ratio_min, 1);
  near_to(q->determinant_min, 1 / (8 * pow(mean, 6)));
  /* Floats hold the squares. */
  assert_true(fabs(q->quality_min - cos(angle)) < 1e-7);
  assert_true(fabs(q->quality_mean - cos(angle)) < 1e-7);
  assert_int_equal(q->n_worst[VG_WORST_ANGLE], VG_WORST);
  near_to(q->worst[VG_WORST_ANGLE][0].value, 35);
  vg_mesh_release(&m);
}

/* More than 70 degrees, and skewness above 4 on the boundary: it is the tangent
 * of the angle. */
static void limits_are_counted(void **state)
{
  static const double z[ROW] = { 0, 1, 2, 3 };
  struct vg_mesh m = hexes(z, tan(78 / DEGREE));
  struct vg_mesh_report r = judged(&m);
  const struct vg_solver_quality *q = &r.solver;

  (void)state;
  assert_int_equal(q->n_angle, 36);
  near_to(q->skewness_max, tan(78 / DEGREE));
  assert_int_equal(q->n_skewness, 18);
  vg_mesh_release(&m);
}

static void levels_of_unequal_height(void **state)
{
  static const double z[ROW] = { 0, 1, 1.004, 2 };
  struct vg_mesh m = hexes(z, 0);
  struct vg_mesh_report r = judged(&m);
  const struct vg_solver_quality *q = &r.solver;
  const double h = 1.004 - 1;

  (void)state;
  near_to(q->angle_max, 0);
  near_to(q->angle_mean, 0);
  near_to(q->skewness_max, 0);
  near_to(q->weight_min, h / (1 + h));
  assert_int_equal(q->n_weight, 18);
  assert_true(fabs(q->volume_ratio_min - h) < 1e-6);
  assert_int_equal(q->n_volume_ratio, 18);
  near_to(q->quality_min, 1);
  assert_int_equal(q->hist_quality[VG_HIST_UNIT - 1], 27);
  vg_mesh_release(&m);
}

/* --- prisms --------------------------------------------------------------- */

/* A prism with a sheared one on top: the line between the centres passes
 * through the common face at a quarter of the shift from its centre. */
static void skewed_pair_of_prisms(void **state)
{
  static const double corner[3][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 } };
  const double shift = 3, off = shift / 2;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_mesh_report r;
  const struct vg_solver_quality *q = &r.solver;
  double face;

  (void)state;
  m.pri = vg_alloc(2, sizeof *m.pri);
  shape_need(m.pri);
  for (int level = 0; level < 3; level++)
    for (int k = 0; k < 3; k++)
      shape_point(&m, corner[k][0] + (level == 2 ? shift : 0), corner[k][1],
                  level);
  for (uint32_t i = 0; i < 6; i++) {
    m.pri[0][i] = i;
    m.pri[1][i] = i + 3;
  }
  m.n_pri = 2;
  judge_close(&m);
  r = judged(&m);
  assert_int_equal(q->n_face, 1);
  assert_int_equal(q->n_boundary_face, 8);
  near_to(q->angle_max, atan(off) * DEGREE);
  face = (off / 2) / fmax(0.2 * sqrt(1 + off * off), 2 / 3.);
  for (size_t i = 0; i < q->n_worst[VG_WORST_SKEWNESS]; i++) {
    const struct vg_worst_place *w = &q->worst[VG_WORST_SKEWNESS][i];

    if (w->at[2] != 1 || w->cell != 0) continue;
    near_to(w->value, face);
    near_to(w->at[0], 1 / 3.);
    face = 0;
  }
  assert_true(face == 0);
  near_to(q->weight_min, 0.5);
  vg_mesh_release(&m);
}

/* --- tetrahedra ----------------------------------------------------------- */

/* Without neighbours only A and f count, and there is no determinant. */
static void one_regular_tetrahedron(void **state)
{
  static const uint32_t node[4] = { 0, 1, 2, 3 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_mesh_report r;

  (void)state;
  shape_point(&m, 0, 0, 0);
  shape_point(&m, 1, 0, 0);
  shape_point(&m, 0.5, sqrt(0.75), 0);
  shape_point(&m, 0.5, sqrt(0.75) / 3, sqrt(2 / 3.));
  m.tet = vg_alloc(1, sizeof *m.tet);
  shape_need(m.tet);
  memcpy(m.tet[m.n_tet++], node, sizeof node);
  judge_close(&m);
  r = judged(&m);
  assert_int_equal(r.solver.n_face, 0);
  assert_int_equal(r.solver.n_boundary_face, 4);
  near_to(r.solver.skewness_max, 0);
  near_to(r.solver.determinant_min, 0);
  assert_int_equal(r.solver.n_determinant, 1);
  assert_true(fabs(r.solver.quality_min - 1) < 1e-7);
  vg_mesh_release(&m);
}

struct vector {
  double x[3];
};

static struct vector minus(const double *a, const double *b)
{
  return (struct vector){ { a[0] - b[0], a[1] - b[1], a[2] - b[2] } };
}

static double times(struct vector a, struct vector b)
{
  return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

static double cosine(struct vector a, struct vector b)
{
  return times(a, b) / sqrt(times(a, a) * times(b, b));
}

static struct vector mean_of(const struct vg_mesh *m, const uint32_t *node,
                             const uint8_t *at, int n)
{
  struct vector c = { { 0, 0, 0 } };

  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) c.x[k] += m->point[node[at ? at[i] : i]][k] / n;
  return c;
}

static struct vector area_of(const struct vg_mesh *m, const uint32_t *node,
                             const uint8_t *at)
{
  struct vector u = minus(m->point[node[at[1]]], m->point[node[at[0]]]);
  struct vector v = minus(m->point[node[at[2]]], m->point[node[at[0]]]);

  return (struct vector){ { (u.x[1] * v.x[2] - u.x[2] * v.x[1]) / 2,
                            (u.x[2] * v.x[0] - u.x[0] * v.x[2]) / 2,
                            (u.x[0] * v.x[1] - u.x[1] * v.x[0]) / 2 } };
}

static int shares_face(const uint32_t *cell, const uint8_t *at,
                       const uint32_t *other)
{
  int same = 0;

  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 4; k++) same += cell[at[i]] == other[k];
  return same == 3;
}

/* Skewness of a face with centre f and corners x between the centres a and b.
 */
static double skewness(const struct vg_mesh *m, const uint32_t *node,
                       const uint8_t *at, struct vector area, struct vector f,
                       struct vector a, struct vector b, double share)
{
  struct vector d = minus(b.x, a.x), e = minus(f.x, a.x);
  double s = times(area, e) / times(area, d), length, far;

  for (int k = 0; k < 3; k++) e.x[k] -= s * d.x[k];
  length = sqrt(times(e, e));
  far = share * sqrt(times(d, d));
  for (int i = 0; i < 3; i++) {
    double reach = times(e, minus(m->point[node[at[i]]], f.x)) / length;

    if (length > 0) far = fmax(far, fabs(reach));
  }
  return length / far;
}

struct expected {
  double angle_cosine, sum_cosine, skewness, weight, quality, sum_quality;
  double determinant;
  size_t n_face, n_angle;
};

static double determinant_of(const struct vector *area, int n)
{
  double mean = 0, t[3][3] = { { 0 } };

  if (!n) return 0;
  for (int i = 0; i < n; i++) mean += sqrt(times(area[i], area[i])) / n;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      for (int l = 0; l < 3; l++)
        t[k][l] += area[i].x[k] * area[i].x[l] / (mean * mean);
  return fabs(t[0][0] * (t[1][1] * t[2][2] - t[1][2] * t[2][1]) -
              t[0][1] * (t[1][0] * t[2][2] - t[1][2] * t[2][0]) +
              t[0][2] * (t[1][0] * t[2][1] - t[1][1] * t[2][0])) /
         8;
}

static void expect_cell(const struct vg_mesh *m, size_t c, struct expected *w)
{
  const struct vg_cell_faces *faces = &vg_cell_faces[VG_CELL_TET];
  struct vector a = mean_of(m, m->tet[c], NULL, 4), inner[4];
  double quality = 1;
  int n = 0;

  for (int j = 0; j < 4; j++) {
    const uint8_t *at = faces->node[j];
    struct vector area = area_of(m, m->tet[c], at);
    struct vector f = mean_of(m, m->tet[c], at, 3), b, g = minus(f.x, a.x);
    size_t o = 0;
    double one;

    quality = fmin(quality, cosine(area, g));
    while (o < m->n_tet && (o == c || !shares_face(m->tet[c], at, m->tet[o])))
      o++;
    if (o == m->n_tet) {
      double along = times(area, g) / times(area, area);

      for (int k = 0; k < 3; k++) b.x[k] = a.x[k] + along * area.x[k];
      w->skewness = fmax(w->skewness,
                         skewness(m, m->tet[c], at, area, f, a, b, 0.4));
      continue;
    }
    b = mean_of(m, m->tet[o], NULL, 4);
    inner[n++] = area;
    one = cosine(area, minus(b.x, a.x));
    quality = fmin(quality, one);
    if (o < c) continue;
    w->n_face++;
    w->sum_cosine += one;
    w->angle_cosine = fmin(w->angle_cosine, one);
    w->n_angle += acos(one) * DEGREE > VG_LIMIT_ANGLE;
    w->skewness = fmax(w->skewness,
                       skewness(m, m->tet[c], at, area, f, a, b, 0.2));
    one = times(area, g) / times(area, minus(b.x, a.x));
    w->weight = fmin(w->weight, fmin(one, 1 - one));
  }
  w->determinant = fmin(w->determinant, determinant_of(inner, n));
  w->quality = fmin(w->quality, quality);
  w->sum_quality += quality;
}

static void tetrahedra_agree_with_the_definitions(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_mesh_report r = judged(&m);
  const struct vg_solver_quality *q = &r.solver;
  struct expected w = {
    .angle_cosine = 1, .weight = 1, .quality = 1, .determinant = 1
  };

  (void)state;
  for (size_t i = 0; i < m.n_tet; i++) expect_cell(&m, i, &w);
  assert_int_equal(q->n_face, w.n_face);
  assert_int_equal(q->n_boundary_face, m.n_tri);
  near_to(cos(q->angle_max / DEGREE), w.angle_cosine);
  near_to(cos(q->angle_mean / DEGREE), w.sum_cosine / (double)w.n_face);
  assert_int_equal(q->n_angle, w.n_angle);
  near_to(q->skewness_max, w.skewness);
  near_to(q->weight_min, w.weight);
  assert_true(fabs(q->determinant_min - w.determinant) < 1e-7);
  assert_true(fabs(q->quality_min - w.quality) < 1e-7);
  assert_true(fabs(q->quality_mean - w.sum_quality / (double)m.n_tet) < 1e-7);
  vg_mesh_release(&m);
}

/* The extremes of the cells are those of the mesh. */
static void fields_of_the_cells(void **state)
{
  (void)state;
  for (int cells = 0; cells < 2; cells++) {
    struct vg_mesh m = judge_mesh(cells ? VG_LAYER_MIXED : VG_LAYER_TETS);
    struct vg_mesh_report r = judged(&m);
    size_t n = m.n_tet + m.n_pyr + m.n_pri;
    float *field[3];
    double angle = 0, skewness = 0, quality = 1, sum = 0;

    for (int k = 0; k < 3; k++) {
      field[k] = vg_alloc(n, sizeof *field[k]);
      shape_need(field[k]);
    }
    assert_int_equal(vg_mesh_solver_fields(&m, field[0], field[1], field[2],
                                           NULL),
                     VG_OK);
    for (size_t i = 0; i < n; i++) {
      angle = fmax(angle, (double)field[0][i]);
      skewness = fmax(skewness, (double)field[1][i]);
      quality = fmin(quality, (double)field[2][i]);
      sum += (double)field[2][i];
    }
    assert_true(fabs(angle - r.solver.angle_max) < 1e-4);
    assert_true(fabs(skewness - r.solver.skewness_max) < 1e-5);
    assert_true(fabs(quality - r.solver.quality_min) < 1e-6);
    assert_true(fabs(sum / (double)n - r.solver.quality_mean) < 1e-6);
    for (int k = 0; k < 3; k++) free(field[k]);
    vg_mesh_release(&m);
  }
}

/* A mesh that is not valid has no such figures. */
static void invalid_meshes_have_no_figures(void **state)
{
  struct vg_mesh m = judge_mesh(VG_LAYER_TETS);
  struct vg_mesh_report r;

  (void)state;
  m.n_tri--;
  assert_int_equal(vg_mesh_judge(&m, NULL, &r, NULL), VG_OK);
  assert_false(r.is_valid);
  assert_false(r.has_solver);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(sheared_hexahedra),
    cmocka_unit_test(limits_are_counted),
    cmocka_unit_test(levels_of_unequal_height),
    cmocka_unit_test(skewed_pair_of_prisms),
    cmocka_unit_test(one_regular_tetrahedron),
    cmocka_unit_test(tetrahedra_agree_with_the_definitions),
    cmocka_unit_test(fields_of_the_cells),
    cmocka_unit_test(invalid_meshes_have_no_figures),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
