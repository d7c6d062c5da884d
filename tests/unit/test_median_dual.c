/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Orthogonality of the median dual: values in closed form, and cells of all
 * kinds compared with the definition. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/geometry/vector.h"
#include "core/judge/dual.h"
#include "judge_support.h"

#define DEGREE 57.295779513082320877

static struct vg_dual_quality dual_of(const struct vg_mesh *m)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;

  if (vg_mesh_judge(m, NULL, &r, &err) < 0) fail_msg("%s", err.text);
  assert_int_equal(r.has_dual, 0);
  if (vg_mesh_judge_dual(m, &r, &err) < 0) fail_msg("%s", err.text);
  assert_true(r.is_valid && r.has_dual);
  return r.dual;
}

static void near_to(double got, double want, double tolerance)
{
  if (!(fabs(got - want) < tolerance)) fail_msg("%.15g, not %.15g", got, want);
}

/* --- closed form ---------------------------------------------------------- */

enum { SIDE = 3, ROW = SIDE + 1, LEVEL = ROW * ROW };

/* A block of SIDE^3 cubes, sheared in x; the spacing grows in all
 * directions. */
static struct vg_mesh hexes(double shear)
{
  static const double at[ROW] = { 0, 0.01, 0.5, 7 };
  struct vg_mesh m = VG_MESH_INIT;

  m.hex = vg_alloc(SIDE * SIDE * SIDE, sizeof *m.hex);
  shape_need(m.hex);
  for (uint32_t i = 0; i < LEVEL * ROW; i++)
    shape_point(&m, at[i % ROW] + shear * at[i / LEVEL], at[i / ROW % ROW],
                at[i / LEVEL]);
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

static void boxes_are_orthogonal(void **state)
{
  struct vg_mesh m = hexes(0);
  struct vg_dual_quality q = dual_of(&m);

  (void)state;
  near_to(q.face_min, 90, 1e-5);
  near_to(q.point_min, 90, 1e-5);
  assert_int_equal(q.n_point, m.n_point);
  assert_int_equal(q.n_face, 3 * SIDE * LEVEL);
  assert_int_equal(q.n_opposed, 0);
  assert_true(q.below[0] == 0 && q.below[1] == 0 && q.below[2] == 0);
  /* steps from 0.01 to 0.49 to 6.5 in all directions */
  near_to(q.volume_ratio_max / (49. * 49 * 49), 1, 1e-5);
  vg_mesh_release(&m);
}

/* The dual faces of edges along x and z are inclined by the shear, those of
 * edges along y are not. */
static void shear_inclines_dual_faces(void **state)
{
  const double want = 90 - atan(8) * DEGREE;
  struct vg_mesh m = hexes(8);
  struct vg_dual_quality q = dual_of(&m);

  (void)state;
  near_to(q.face_min, want, 1e-5);
  assert_true(q.point_min > want && q.point_min < 90);
  assert_true(q.below[0] == 0 && q.below[1] > 0 && q.below[2] >= q.below[1]);
  vg_mesh_release(&m);
}

/* --- the definition ------------------------------------------------------- */

static void centre_of(const struct vg_mesh *m, const uint32_t *node,
                      const uint8_t *which, int n, double out[3])
{
  for (int k = 0; k < 3; k++) {
    out[k] = 0;
    for (int i = 0; i < n; i++)
      out[k] += m->point[node[which ? which[i] : i]][k] / n;
  }
}

static void add_triangle(const double a[3], const double b[3],
                         const double c[3], double sign, double sum[3])
{
  double u[3], v[3], n[3];

  vg_sub(b, a, u);
  vg_sub(c, a, v);
  vg_cross(u, v, n);
  for (int k = 0; k < 3; k++) sum[k] += 0.5 * sign * n[k];
}

/* Adds the triangles of the dual face of (v, w) in a cell: for each face with
 * this side, from the middle of the side to the centres of face and cell. */
static int add_cell(const struct vg_mesh *m, int kind, const uint32_t *node,
                    uint32_t v, uint32_t w, double sum[3])
{
  const struct vg_cell_faces *f = &vg_cell_faces[kind];
  double g[3], middle[3], centre[3];
  int found = 0;

  centre_of(m, node, NULL, f->n_node, g);
  for (int k = 0; k < 3; k++) middle[k] = (m->point[v][k] + m->point[w][k]) / 2;
  for (int j = 0; j < f->n_face; j++) {
    int n = j < f->n_tri ? 3 : 4;

    for (int i = 0; i < n; i++) {
      uint32_t a = node[f->node[j][i]], b = node[f->node[j][(i + 1) % n]];

      if (!((a == v && b == w) || (a == w && b == v))) continue;
      centre_of(m, node, f->node[j], n, centre);
      add_triangle(middle, g, centre, a == v ? 1 : -1, sum);
      found = 1;
    }
  }
  return found;
}

/* Area vector from v to w over all cells; 0: (v, w) is not an edge. */
static int dual_face(const struct vg_mesh *m, uint32_t v, uint32_t w,
                     double sum[3])
{
  int found = 0;

  sum[0] = sum[1] = sum[2] = 0;
  for (int kind = 0; kind < VG_CELL_KINDS; kind++) {
    struct vg_cells c = vg_mesh_cells(m, kind);

    for (size_t i = 0; i < c.n; i++)
      found |= add_cell(m, kind,
                        c.node + i * (size_t)vg_cell_faces[kind].n_node, v, w,
                        sum);
  }
  return found;
}

/* Widens the range of point v by the tetrahedron from v to the middle of the
 * side (v, w) and the centres of a cell and of its face j. */
static void add_volume(const struct vg_mesh *m, int kind, const uint32_t *node,
                       int j, uint32_t v, uint32_t w, double range[2])
{
  const struct vg_cell_faces *f = &vg_cell_faces[kind];
  double x[3][3], volume;

  centre_of(m, node, NULL, f->n_node, x[0]);
  centre_of(m, node, f->node[j], j < f->n_tri ? 3 : 4, x[1]);
  for (int k = 0; k < 3; k++) {
    x[2][k] = (m->point[w][k] - m->point[v][k]) / 2;
    x[0][k] -= m->point[v][k];
    x[1][k] -= m->point[v][k];
  }
  volume = fabs(vg_triple(x[0], x[1], x[2])) / 6;
  range[0] = fmin(range[0], volume);
  range[1] = fmax(range[1], volume);
}

static void add_volumes(const struct vg_mesh *m, int kind, const uint32_t *node,
                        double (*range)[2])
{
  const struct vg_cell_faces *f = &vg_cell_faces[kind];

  for (int j = 0; j < f->n_face; j++) {
    int n = j < f->n_tri ? 3 : 4;

    for (int i = 0; i < n; i++) {
      uint32_t v = node[f->node[j][i]], w = node[f->node[j][(i + 1) % n]];

      add_volume(m, kind, node, j, v, w, range[v]);
      add_volume(m, kind, node, j, w, v, range[w]);
    }
  }
}

static double volume_ratio(const struct vg_mesh *m)
{
  double(*range)[2] = vg_alloc(m->n_point, sizeof *range), most = 0;

  shape_need(range);
  for (size_t v = 0; v < m->n_point; v++) range[v][0] = 1e9, range[v][1] = 0;
  for (int kind = 0; kind < VG_CELL_KINDS; kind++) {
    struct vg_cells c = vg_mesh_cells(m, kind);

    for (size_t i = 0; i < c.n; i++)
      add_volumes(m, kind, c.node + i * (size_t)vg_cell_faces[kind].n_node,
                  range);
  }
  for (size_t v = 0; v < m->n_point; v++)
    most = fmax(most, range[v][1] / range[v][0]);
  free(range);
  return most;
}

static void check(const struct vg_mesh *m)
{
  struct vg_dual_quality q = dual_of(m);
  double least = 90, least_point = 90;
  size_t n_face = 0, n_below = 0, n_opposed = 0;

  for (uint32_t v = 0; v < m->n_point; v++) {
    double sum = 0, total = 0;

    for (uint32_t w = 0; w < m->n_point; w++) {
      double s[3], e[3], angle;

      if (v == w || !dual_face(m, v, w, s)) continue;
      vg_sub(m->point[w], m->point[v], e);
      angle = asin(vg_dot(s, e) / (vg_norm(s) * vg_norm(e))) * DEGREE;
      least = fmin(least, angle);
      n_face += v < w;
      n_opposed += v < w && angle <= 0;
      sum += vg_norm(s) * angle;
      total += vg_norm(s);
    }
    n_below += sum / total < 20;
    least_point = fmin(least_point, sum / total);
  }
  assert_int_equal(q.n_face, n_face);
  assert_int_equal(q.n_point, m->n_point);
  assert_int_equal(q.n_opposed, n_opposed);
  near_to(q.face_min, least, 1e-5);
  near_to(q.point_min, least_point, 1e-5);
  near_to(q.volume_ratio_max / volume_ratio(m), 1, 1e-5);
  near_to(q.below[2], 100. * (double)n_below / (double)m->n_point, 1e-9);
}

/* Moves the points of a block at random, which stays valid. */
static void shake(struct vg_mesh *m, double size)
{
  uint64_t seed = 7;

  for (size_t i = 0; i < m->n_point; i++)
    for (int k = 0; k < 3; k++)
      m->point[i][k] += size * (double)(model_random(&seed) % 1000) / 1000;
}

static void prisms_agree_with_the_definition(void **state)
{
  struct vg_mesh m = judge_prisms(3, 2, 3);

  (void)state;
  check(&m);
  shake(&m, 0.1);
  check(&m);
  vg_mesh_release(&m);
}

/* A cube of pyramids around its centre, one of them cut into two tetrahedra,
 * next to a hexahedron. */
static struct vg_mesh one_of_each(void)
{
  static const uint32_t base[6][4] = { { 0, 3, 2, 1 }, { 0, 1, 5, 4 },
                                       { 1, 2, 6, 5 }, { 2, 3, 7, 6 },
                                       { 3, 0, 4, 7 }, { 4, 5, 6, 7 } };
  struct vg_mesh m = VG_MESH_INIT;

  m.pyr = vg_alloc(5, sizeof *m.pyr);
  m.tet = vg_alloc(2, sizeof *m.tet);
  m.hex = vg_alloc(1, sizeof *m.hex);
  shape_need(m.pyr);
  shape_need(m.tet);
  shape_need(m.hex);
  for (int i = 0; i < 12; i++)
    shape_point(&m, (i & 3) == 1 || (i & 3) == 2, (i & 3) > 1, i / 4);
  shape_point(&m, 0.5, 0.45, 0.4);
  for (int j = 1; j < 6; j++) {
    /* the mesh has the apex as its third node */
    const uint32_t *b = base[j];
    const uint32_t node[5] = { b[0], b[1], 12, b[3], b[2] };

    memcpy(m.pyr[m.n_pyr++], node, sizeof node);
  }
  for (int j = 0; j < 2; j++) {
    const uint32_t node[4] = { 0, j ? 1 : 2, j ? 2 : 3, 12 };

    memcpy(m.tet[m.n_tet++], node, sizeof node);
  }
  for (uint32_t i = 0; i < 8; i++) m.hex[0][i] = 4 + i;
  m.n_hex = 1;
  judge_close(&m);
  return m;
}

static void pyramids_agree_with_the_definition(void **state)
{
  struct vg_mesh m = one_of_each();

  (void)state;
  check(&m);
  shake(&m, 0.1);
  check(&m);
  vg_mesh_release(&m);
}

/* Cubes of six tetrahedra, along the edges from one corner to the opposite
 * one. */
static struct vg_mesh tetrahedra(void)
{
  static const uint32_t step[3] = { 1, ROW, LEVEL };
  static const int order[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
                                   { 1, 0, 2 }, { 0, 2, 1 }, { 2, 1, 0 } };
  struct vg_mesh m = VG_MESH_INIT;

  m.tet = vg_alloc(6 * SIDE * SIDE * SIDE, sizeof *m.tet);
  shape_need(m.tet);
  for (uint32_t i = 0; i < LEVEL * ROW; i++)
    shape_point(&m, i % ROW, i / ROW % ROW, i / LEVEL);
  for (uint32_t c = 0; c < SIDE * SIDE * SIDE; c++)
    for (int k = 0; k < 6; k++) {
      uint32_t *t = m.tet[m.n_tet++];

      t[0] = c % SIDE + ROW * (c / SIDE % SIDE) + LEVEL * (c / SIDE / SIDE);
      for (int i = 0; i < 3; i++) t[i + 1] = t[i] + step[order[k][i]];
      if (k > 2) judge_swap(&t[2], &t[3]);
    }
  judge_close(&m);
  return m;
}

/* Regular, at random, and as flat as in layers. */
static void tetrahedra_agree_with_the_definition(void **state)
{
  struct vg_mesh m = tetrahedra();

  (void)state;
  check(&m);
  shake(&m, 0.2);
  check(&m);
  for (size_t i = 0; i < m.n_point; i++) m.point[i][2] *= 1e-3;
  check(&m);
  vg_mesh_release(&m);
}

/* --- sums ----------------------------------------------------------------- */

static void sums_do_not_depend_on_the_order(void **state)
{
  enum { N = 300 };
  double x[N][3], got[3], want[3], exact[3] = { 0, 0, 0 };
  uint64_t seed = 3;

  (void)state;
  for (int i = 0; i < N; i++)
    for (int k = 0; k < 3; k++) {
      x[i][k] = ldexp((double)(model_random(&seed) % 2001) - 1000,
                      (int)(model_random(&seed) % 200) - 150);
      exact[k] += x[i][k];
    }
  for (int try = 0; try < 20; try++) {
    struct vg_grid_sum part[3] = { { .top = 0 } };

    for (int i = 0; i < N; i++) {
      int j = (i * 7 + try * 11) % N;

      vg_grid_sum_add(&part[(i / (try + 1)) % 3], x[j]);
    }
    vg_grid_sum_join(&part[2], &part[0]);
    vg_grid_sum_join(&part[2], &part[1]);
    vg_grid_sum_value(&part[2], got);
    if (!try) memcpy(want, got, sizeof want);
    assert_memory_equal(got, want, sizeof want);
  }
  for (int k = 0; k < 3; k++) near_to(got[k] / exact[k], 1, 1e-9);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(boxes_are_orthogonal),
    cmocka_unit_test(shear_inclines_dual_faces),
    cmocka_unit_test(prisms_agree_with_the_definition),
    cmocka_unit_test(pyramids_agree_with_the_definition),
    cmocka_unit_test(tetrahedra_agree_with_the_definition),
    cmocka_unit_test(sums_do_not_depend_on_the_order),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
