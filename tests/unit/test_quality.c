/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The mesh check: known figures, and every kind of fault found and counted. */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "core/judge/quality.h"
#include "io/mesh/ugrid.h"
#include "io/vgrid/vgrid.h"
#include "io_support.h"

#define N 4 /* cells per side of the test cube */
#define P (N + 1)

/* Nodes along the six paths of a cube from corner to opposite corner (Kuhn);
 * the last three paths are odd and invert the tetrahedron. */
static const int path[6][3] = { { 0, 1, 2 }, { 1, 2, 0 }, { 2, 0, 1 },
                                { 0, 2, 1 }, { 2, 1, 0 }, { 1, 0, 2 } };
static const size_t stride[3] = { 1, P, P *P };

#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static void *room(size_t n, size_t size)
{
  void *p = vg_calloc(n, size);

  assert_non_null(p);
  return p;
}

static void cube_cells(struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t c = 0; c < N * N * N; c++) {
    size_t o = c % N + P * (c / N % N) + P * P * (c / N / N);

    for (int q = 0; q < 6; q++) {
      uint32_t *t = m->tet[n++];

      t[0] = (uint32_t)o;
      t[1] = (uint32_t)(t[0] + stride[path[q][0]]);
      t[q < 3 ? 2 : 3] = (uint32_t)(t[1] + stride[path[q][1]]);
      t[q < 3 ? 3 : 2] = (uint32_t)(t[1] + stride[path[q][1]] +
                                    stride[path[q][2]]);
    }
  }
}

static void cube_boundary(struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t f = 0; f < 6 * N * N; f++) {
    size_t d = f / (2 * N * N), side = f / (N * N) % 2;
    size_t du = stride[(d + 1) % 3], dv = stride[(d + 2) % 3];
    size_t o = side * N * stride[d] + f % N * du + f / N % N * dv;
    uint32_t *t = m->tri[n], *u = m->tri[n + 1];

    t[0] = u[0] = (uint32_t)o;
    t[side ? 2 : 1] = (uint32_t)(o + du);
    t[side ? 1 : 2] = u[side ? 2 : 1] = (uint32_t)(o + du + dv);
    u[side ? 1 : 2] = (uint32_t)(o + dv);
    n += 2;
  }
}

/* The unit cube in N^3 cells of six tetrahedra each. */
static struct vg_mesh cube(void)
{
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = P * P * P;
  m.n_tet = 6 * N * N * N;
  m.n_tri = 12 * N * N;
  m.point = room(m.n_point, sizeof *m.point);
  m.tet = room(m.n_tet, sizeof *m.tet);
  m.tri = room(m.n_tri, sizeof *m.tri);
  m.tri_patch = room(m.n_tri, sizeof *m.tri_patch);
  for (size_t i = 0; i < m.n_point; i++) {
    m.point[i][0] = (double)(i % P) / N;
    m.point[i][1] = (double)(i / P % P) / N;
    m.point[i][2] = (double)(i / P / P) / N;
  }
  cube_cells(&m);
  cube_boundary(&m);
  assert_true(vg_mesh_add_patch(&m, 1, "cube") == 0);
  return m;
}

static struct vg_mesh_report judge(const struct vg_mesh *m)
{
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;

  assert_int_equal(vg_mesh_judge(m, NULL, &r, &err), VG_OK);
  return r;
}

/* Sum of all figures that must be zero, except for the volume. */
static size_t faults(const struct vg_mesh_report *r)
{
  return r->bad_index + r->unused_point + r->not_finite + r->duplicate_point +
         r->not_positive + r->open_face + r->crowded_face + r->same_side_face +
         r->orphan_boundary + r->outward_boundary;
}

static void a_cube_is_valid(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r = judge(&m);

  (void)state;
  assert_true(r.is_valid);
  assert_int_equal(faults(&r), 0);
  assert_int_equal(r.n_cell, 384);
  assert_int_equal(r.n_component, 1);
  assert_int_equal(r.n_inner_face, (4 * 384 - 192) / 2);
  assert_near(r.volume, 1, 1e-15);
  assert_near(r.enclosed, 1, 1e-15);
  /* Kuhn's tetrahedra: 45, 60, 90 degrees; radius ratio of legs 1, 1, 1: V =
   * 1/6, area (1 + sqrt 2), R = sqrt(3)/2 of a unit cube */
  assert_near(r.angle_min, 45, 1e-9);
  assert_near(r.angle_max, 90, 1e-9);
  assert_near(r.angle_min_p1, 45, 0.011);
  assert_near(r.radius_ratio_mean, 3 * (0.5 / (1 + sqrt(2.))) / (sqrt(3.) / 2),
              1e-12);
  assert_near(r.radius_ratio_min, r.radius_ratio_mean, 1e-12);
  assert_near(r.mean_ratio_mean, 12 * cbrt(0.25) / 10, 1e-12);
  for (int k = 0; k < 3; k++) assert_near(r.volume_ratio[k], 1, 1. / 256);
  assert_true(r.below[4] == 0 && r.above[0] == 0);
  assert_int_equal(r.n_worst, VG_WORST);
  vg_mesh_release(&m);
}

static struct vg_mesh one_tet(const double x[4][3])
{
  static const uint32_t face[4][3] = {
    { 0, 1, 2 }, { 0, 3, 1 }, { 1, 3, 2 }, { 0, 2, 3 }
  };
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = 4;
  m.n_tet = 1;
  m.n_tri = 4;
  m.point = room(4, sizeof *m.point);
  m.tet = room(1, sizeof *m.tet);
  m.tri = room(4, sizeof *m.tri);
  m.tri_patch = room(4, sizeof *m.tri_patch);
  memcpy(m.point, x, sizeof(double[4][3]));
  memcpy(m.tri, face, sizeof face);
  for (uint32_t i = 0; i < 4; i++) m.tet[0][i] = i;
  return m;
}

static void a_regular_tetrahedron_has_the_known_figures(void **state)
{
  static const double x[4][3] = {
    { 1, 1, 1 }, { -1, 1, -1 }, { 1, -1, -1 }, { -1, -1, 1 }
  };
  struct vg_mesh m = one_tet(x);
  struct vg_mesh_report r = judge(&m);
  float angle, ratio;

  (void)state;
  assert_true(r.is_valid);
  assert_near(r.angle_min, acos(1 / 3.) * 180 / M_PI, 1e-6);
  assert_near(r.angle_max, acos(1 / 3.) * 180 / M_PI, 1e-6);
  assert_near(r.radius_ratio_mean, 1, 1e-12);
  assert_near(r.mean_ratio_mean, 1, 1e-12);
  assert_near(r.volume, 8 / 3., 1e-12);
  assert_int_equal(r.hist_angle_min[14], 1);
  assert_int_equal(r.n_worst, 1);
  assert_near(r.worst[0].at[0], 0, 1e-15);
  vg_mesh_cell_quality(&m, &angle, &ratio);
  assert_near(angle, 70.5287794, 1e-5);
  assert_near(ratio, 1, 1e-6);
  vg_mesh_cell_quality(&m, NULL, NULL);
  vg_mesh_release(&m);
}

static void a_flat_cell_is_not_positive(void **state)
{
  static const double x[4][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0.25, 0.5, 0 }
  };
  static const double up[4][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0.25, 0.5, -1e-3 }
  };
  struct vg_mesh m = one_tet(x);
  struct vg_mesh_report r = judge(&m);

  (void)state;
  assert_false(r.is_valid);
  assert_int_equal(r.not_positive, 1);
  assert_near(r.angle_min, 0, 1e-6);
  assert_near(r.angle_max, 180, 1e-6);
  vg_mesh_release(&m);
  m = one_tet(up);
  r = judge(&m);
  assert_int_equal(r.not_positive, 1);
  assert_true(r.volume < 0);
  vg_mesh_release(&m);
}

/* A needle whose sign floating-point arithmetic cannot determine: four points
 * of a grid of 2^-30 near (1, 1, 1), coplanar except for one step of one
 * coordinate. */
static void signs_are_exact(void **state)
{
  const double e = ldexp(1, -30);
  double x[4][3] = {
    { 1, 1, 1 }, { 1 + e, 1, 1 }, { 1, 1 + e, 1 }, { 1 + e, 1 + e, 1 + e }
  };
  struct vg_mesh m = one_tet((const double(*)[3])x);
  struct vg_mesh_report r = judge(&m);

  (void)state;
  assert_int_equal(r.not_positive, 0);
  vg_mesh_release(&m);
  x[3][2] = 1;
  m = one_tet((const double(*)[3])x);
  r = judge(&m);
  assert_int_equal(r.not_positive, 1);
  vg_mesh_release(&m);
}

static void indices_out_of_range_are_counted(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;

  (void)state;
  m.tet[7][2] = (uint32_t)m.n_point;
  m.tri[3][1] = UINT32_MAX;
  r = judge(&m);
  assert_int_equal(r.bad_index, 2);
  assert_false(r.is_valid);
  vg_mesh_release(&m);
}

static void nan_and_infinity_are_counted(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;

  (void)state;
  m.point[5][1] = NAN;
  m.point[9][0] = INFINITY;
  m.point[9][2] = -INFINITY;
  r = judge(&m);
  assert_int_equal(r.not_finite, 2);
  assert_false(r.is_valid);
  vg_mesh_release(&m);
}

static void unused_and_coincident_points_are_counted(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;

  (void)state;
  m.point = vg_realloc(m.point, m.n_point + 2, sizeof *m.point);
  assert_non_null(m.point);
  for (int k = 0; k < 3; k++) {
    m.point[m.n_point][k] = -0.0; /* the corner, except for the sign of 0 */
    m.point[m.n_point + 1][k] = 7;
  }
  m.n_point += 2;
  r = judge(&m);
  assert_int_equal(r.unused_point, 2);
  assert_int_equal(r.duplicate_point, 1);
  assert_false(r.is_valid);
  vg_mesh_release(&m);
}

static void an_inverted_cell_is_found(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;
  uint32_t t = m.tet[100][0];

  (void)state;
  m.tet[100][0] = m.tet[100][1];
  m.tet[100][1] = t;
  r = judge(&m);
  assert_int_equal(r.not_positive, 1);
  assert_true(r.same_side_face + r.outward_boundary == 4);
  assert_true(r.volume_error > 1e-3);
  assert_false(r.is_valid);
  vg_mesh_release(&m);
}

static void a_missing_cell_opens_faces(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;

  (void)state;
  /* the middle cube is surrounded by other cubes only */
  memmove(m.tet + 6 * 21, m.tet + 6 * 21 + 1,
          (m.n_tet - 6 * 21 - 1) * sizeof *m.tet);
  m.n_tet--;
  r = judge(&m);
  assert_int_equal(r.open_face, 4);
  assert_false(r.is_valid);
  vg_mesh_release(&m);
}

static void a_duplicate_cell_crowds_its_faces(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;

  (void)state;
  m.tet = vg_realloc(m.tet, m.n_tet + 1, sizeof *m.tet);
  assert_non_null(m.tet);
  memcpy(m.tet[m.n_tet], m.tet[6 * 21], sizeof *m.tet);
  m.n_tet++;
  r = judge(&m);
  assert_int_equal(r.crowded_face, 4);
  assert_false(r.is_valid);
  vg_mesh_release(&m);
}

static void boundary_faces_are_matched(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;
  uint32_t t = m.tri[17][0];

  (void)state;
  m.tri[17][0] = m.tri[17][1];
  m.tri[17][1] = t;
  r = judge(&m);
  assert_int_equal(r.outward_boundary, 1);
  assert_false(r.is_valid);
  m.tri[20][2] = m.tri[20][2] == 124 ? 123 : 124;
  r = judge(&m);
  assert_int_equal(r.orphan_boundary, 1);
  assert_int_equal(r.open_face, 1);
  m.n_tri -= 2;
  r = judge(&m);
  assert_int_equal(r.open_face, 3);
  vg_mesh_release(&m);
}

static void two_neighbours_on_one_side_are_found(void **state)
{
  static const double x[4][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }
  };
  struct vg_mesh m = one_tet(x);
  struct vg_mesh_report r;

  (void)state;
  m.point = vg_realloc(m.point, 5, sizeof *m.point);
  m.tet = vg_realloc(m.tet, 2, sizeof *m.tet);
  assert_true(m.point && m.tet);
  m.point[4][0] = m.point[4][1] = m.point[4][2] = 0.1;
  m.n_point = 5;
  m.n_tet = 2;
  m.tet[1][0] = 0;
  m.tet[1][1] = 1;
  m.tet[1][2] = 2;
  m.tet[1][3] = 4;
  m.n_tri = 0;
  r = judge(&m);
  assert_int_equal(r.same_side_face, 1);
  assert_int_equal(r.open_face, 6);
  assert_int_equal(r.n_component, 1);
  vg_mesh_release(&m);
}

static void components_are_counted(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r;

  (void)state;
  /* remove the second layer of cubes: two blocks remain */
  memmove(m.tet + 6 * N * N, m.tet + 12 * N * N,
          (m.n_tet - 12 * N * N) * sizeof *m.tet);
  m.n_tet -= 6 * N * N;
  r = judge(&m);
  assert_int_equal(r.n_component, 2);
  assert_int_equal(r.open_face, 4 * N * N);
  assert_int_equal(r.orphan_boundary, 8 * N);
  vg_mesh_release(&m);
}

static void an_empty_mesh_is_not_valid(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_mesh_report r = judge(&m);

  (void)state;
  assert_false(r.is_valid);
}

/* A hexahedron and a prism side by side, a pyramid on top of the first, of
 * volumes 1, 1/2 and 1/3. */
static struct vg_mesh mixed(void)
{
  static const double x[11][3] = { { 0, 0, 0 }, { 1, 0, 0 },    { 1, 1, 0 },
                                   { 0, 1, 0 }, { 0, 0, 1 },    { 1, 0, 1 },
                                   { 1, 1, 1 }, { 0, 1, 1 },    { 2, 0, 0 },
                                   { 2, 0, 1 }, { 0.5, 0.5, 2 } };
  static const uint32_t hex[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  static const uint32_t pri[6] = { 1, 8, 2, 5, 9, 6 };
  static const uint32_t pyr[5] = { 4, 7, 10, 5, 6 };
  static const uint32_t quad[6][4] = { { 0, 1, 2, 3 }, { 0, 4, 5, 1 },
                                       { 2, 6, 7, 3 }, { 3, 7, 4, 0 },
                                       { 1, 5, 9, 8 }, { 8, 9, 6, 2 } };
  static const uint32_t tri[6][3] = {
    { 1, 8, 2 },  { 5, 6, 9 },  { 4, 10, 5 },
    { 5, 10, 6 }, { 6, 10, 7 }, { 7, 10, 4 }
  };
  struct vg_mesh m = VG_MESH_INIT;

  m.n_point = 11;
  m.n_hex = m.n_pri = m.n_pyr = 1;
  m.n_tri = m.n_quad = 6;
  m.point = room(11, sizeof *m.point);
  m.hex = room(1, sizeof *m.hex);
  m.pri = room(1, sizeof *m.pri);
  m.pyr = room(1, sizeof *m.pyr);
  m.tri = room(6, sizeof *m.tri);
  m.quad = room(6, sizeof *m.quad);
  m.tri_patch = room(6, sizeof *m.tri_patch);
  m.quad_patch = room(6, sizeof *m.quad_patch);
  memcpy(m.point, x, sizeof x);
  memcpy(m.hex, hex, sizeof hex);
  memcpy(m.pri, pri, sizeof pri);
  memcpy(m.pyr, pyr, sizeof pyr);
  memcpy(m.tri, tri, sizeof tri);
  memcpy(m.quad, quad, sizeof quad);
  return m;
}

static void mixed_cells_are_judged(void **state)
{
  struct vg_mesh m = mixed();
  struct vg_mesh_report r = judge(&m);

  (void)state;
  assert_int_equal(faults(&r), 0);
  assert_true(r.is_valid);
  assert_int_equal(r.n_component, 1);
  assert_int_equal(r.n_inner_face, 2);
  assert_near(r.volume, 1 + 1 / 2. + 1 / 3., 1e-14);
  assert_near(r.volume_ratio[2], 3, 3. / 256);
  /* warped quads still enclose the sum of the cells' volumes */
  m.point[6][0] += 0.11;
  m.point[6][2] += 0.07;
  r = judge(&m);
  assert_true(r.is_valid);
  assert_true(r.volume_error < 1e-14);
  vg_mesh_release(&m);
}

static void inverted_mixed_cells_are_found(void **state)
{
  struct vg_mesh m = mixed();
  struct vg_mesh_report r;

  (void)state;
  m.point[10][2] = 0.5; /* the apex below its base */
  r = judge(&m);
  assert_int_equal(r.not_positive, 1);
  m.point[10][2] = 2;
  m.point[8][0] = 0.5; /* an inverted prism */
  m.point[9][0] = 0.5;
  r = judge(&m);
  assert_int_equal(r.not_positive, 1);
  m.point[8][0] = m.point[9][0] = 2;
  m.point[4][2] = -0.5; /* one corner of the hexahedron */
  r = judge(&m);
  assert_true(r.not_positive >= 1);
  vg_mesh_release(&m);
}

/* Every interior edge of the cube is counted once and compared with its
 * target. */
static void edges_are_measured_against_the_field(void **state)
{
  struct vg_mesh m = cube();
  struct vg_sizing_options options = VG_SIZING_OPTIONS_INIT;
  struct vg_source source = { .kind = VG_SOURCE_SPHERE,
                              .h0 = 1. / N,
                              .r0 = 100 };
  struct vg_sizing *sizing = NULL;
  struct vg_mesh_report r;
  struct vg_error err = VG_ERROR_INIT;
  size_t total = 0, axis = 3 * N * (N - 1) * (N - 1);
  size_t face = 3 * N * N * (N - 1), body = N * N * N;

  (void)state;
  options.from_surface = 0;
  assert_int_equal(vg_sizing_new(&options, 1, &source, &m, &sizing, &err),
                   VG_OK);
  assert_int_equal(vg_mesh_judge(&m, sizing, &r, &err), VG_OK);
  for (int i = 0; i < VG_HIST_UNIT; i++) total += r.hist_edge[i];
  assert_true(r.has_sizing);
  assert_int_equal(total, axis + face + body);
  /* lengths 1, sqrt 2 and sqrt 3 times the spacing */
  assert_near(r.edge_mean,
              ((double)axis + sqrt(2.) * (double)face +
               sqrt(3.) * (double)body) /
                (double)total,
              1e-9);
  assert_near(r.edge_within, 100. * (double)(axis + face) / (double)total,
              1e-9);
  vg_sizing_free(sizing);
  vg_mesh_release(&m);
}

/* Numbering does not affect the figures, even with a node of very many
 * faces. */
static void figures_do_not_depend_on_numbering(void **state)
{
  struct vg_mesh m = cube();
  struct vg_mesh_report r = judge(&m), s;

  (void)state;
  for (size_t i = 0; i < m.n_tet; i++)
    for (int k = 0; k < 4; k++)
      m.tet[i][k] = (uint32_t)(m.n_point - 1 - m.tet[i][k]);
  for (size_t i = 0; i < m.n_tri; i++)
    for (int k = 0; k < 3; k++)
      m.tri[i][k] = (uint32_t)(m.n_point - 1 - m.tri[i][k]);
  for (size_t i = 0; i < m.n_point / 2; i++)
    for (int k = 0; k < 3; k++) {
      double x = m.point[i][k];

      m.point[i][k] = m.point[m.n_point - 1 - i][k];
      m.point[m.n_point - 1 - i][k] = x;
    }
  s = judge(&m);
  assert_true(s.is_valid);
  assert_int_equal(s.n_inner_face, r.n_inner_face);
  assert_near(s.radius_ratio_mean, r.radius_ratio_mean, 1e-13);
  assert_memory_equal(s.hist_radius_ratio, r.hist_radius_ratio,
                      sizeof r.hist_radius_ratio);
  vg_mesh_release(&m);
}

/* A spindle of n tetrahedra around one edge: node 0 is in all of them. */
static void faces_around_a_shared_edge_are_matched(void **state)
{
  enum { RING = 500 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_mesh_report r;

  (void)state;
  m.n_point = RING + 2;
  m.n_tet = RING;
  m.n_tri = 2 * RING;
  m.point = room(m.n_point, sizeof *m.point);
  m.tet = room(m.n_tet, sizeof *m.tet);
  m.tri = room(m.n_tri, sizeof *m.tri);
  m.point[0][2] = -1;
  m.point[1][2] = 1;
  for (uint32_t i = 0; i < RING; i++) {
    uint32_t a = 2 + i, b = 2 + (i + 1) % RING;
    const uint32_t t[4] = { 0, a, b, 1 };
    const uint32_t f[2][3] = { { 0, a, b }, { 1, b, a } };

    m.point[a][0] = cos(2 * M_PI * i / RING);
    m.point[a][1] = sin(2 * M_PI * i / RING);
    memcpy(m.tet[i], t, sizeof t);
    memcpy(m.tri[2 * i], f[0], sizeof f[0]);
    memcpy(m.tri[2 * i + 1], f[1], sizeof f[1]);
  }
  r = judge(&m);
  assert_true(r.is_valid);
  assert_int_equal(r.n_inner_face, RING);
  vg_mesh_release(&m);
}

/* VGRID's own mesh of a 20 x 20 x 20 box with layers: counts from its headers,
 * angles as an independent program (long double volumes, sorted faces) prints
 * them, with its rounding. */
static void a_mesh_of_vgrid(void **state)
{
  const char *file = io_real("vgrid_box/box.cogsg");
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh_report r;

  (void)state;
  assert_int_equal(vg_cogsg_read(file, &m, NULL, NULL, &err), VG_OK);
  r = judge(&m);
  assert_true(r.is_valid);
  assert_int_equal(r.n_cell, 63926);
  assert_int_equal(r.n_point, 12440);
  assert_int_equal(r.n_inner_face, (4 * 63926 - 6810) / 2);
  assert_int_equal(r.n_component, 1);
  assert_near(r.volume, 8000, 1e-8);
  assert_near(r.angle_min, 0.03, 0.006);
  assert_near(r.angle_max, 179.15, 0.006);
  vg_mesh_release(&m);
}

/* AFLR3's mesh of a body in a box: 38,604 tetrahedra, 85,900 prisms. The same
 * independent program gives: inner faces 290,603, angles 11.001 and 155.021,
 * enclosed volume 79983.302897, no inverted cells. */
static void a_mesh_with_prisms(void **state)
{
  const char *file = io_real("simple/cape_cigar_viscous_volume.lb8.ugrid.xz");
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_mesh_report r;

  (void)state;
  assert_int_equal(vg_ugrid_read(file, &m, NULL, &err), VG_OK);
  r = judge(&m);
  assert_true(r.is_valid);
  assert_int_equal(r.n_cell, 38604 + 85900);
  assert_int_equal(r.n_inner_face, 290603);
  assert_near(r.angle_min, 11.001, 0.0006);
  assert_near(r.angle_max, 155.021, 0.0006);
  assert_near(r.enclosed, 79983.302897, 1e-6);
  assert_true(r.volume_error < 1e-13);
  vg_mesh_release(&m);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_cube_is_valid),
    cmocka_unit_test(a_regular_tetrahedron_has_the_known_figures),
    cmocka_unit_test(a_flat_cell_is_not_positive),
    cmocka_unit_test(signs_are_exact),
    cmocka_unit_test(indices_out_of_range_are_counted),
    cmocka_unit_test(nan_and_infinity_are_counted),
    cmocka_unit_test(unused_and_coincident_points_are_counted),
    cmocka_unit_test(an_inverted_cell_is_found),
    cmocka_unit_test(a_missing_cell_opens_faces),
    cmocka_unit_test(a_duplicate_cell_crowds_its_faces),
    cmocka_unit_test(boundary_faces_are_matched),
    cmocka_unit_test(two_neighbours_on_one_side_are_found),
    cmocka_unit_test(components_are_counted),
    cmocka_unit_test(an_empty_mesh_is_not_valid),
    cmocka_unit_test(mixed_cells_are_judged),
    cmocka_unit_test(inverted_mixed_cells_are_found),
    cmocka_unit_test(edges_are_measured_against_the_field),
    cmocka_unit_test(figures_do_not_depend_on_numbering),
    cmocka_unit_test(faces_around_a_shared_edge_are_matched),
    cmocka_unit_test(a_mesh_of_vgrid),
    cmocka_unit_test(a_mesh_with_prisms),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
