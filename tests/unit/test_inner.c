/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Inner surfaces: sheets in a box are doubled, and the void on both sides is
 * filled, with the same mesh in any decomposition. */
#define _GNU_SOURCE
#include "advance_support.h"
#include "inner_shapes.h"

#include "core/mesh/copies.h"
#include "core/mesh/edges.h"
#include "core/mesh/sheets.h"
#include "partition/discrete/discrete.h"
#include "partition/graph/graph.h"
#include "partition/octree/octree.h"

static const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 };

/* A box from -1 to 1 of 4 x 4 x 4 and a sheet of n x n. */
static vg_status make(struct vg_mesh *m, const double o[3], const double u[3],
                      const double v[3], int n, struct vg_inner_report *r,
                      struct vg_error *err)
{
  memset(m, 0, sizeof *m);
  shape_box(m, 4, 1);
  add_sheet(m, o, u, v, n);
  return put_back(m, r, err);
}

/* Closed, of unchanged volume, and every copy is known to be one. */
static void expect(const struct vg_mesh *m, const struct vg_inner_report *r,
                   size_t n_tri, size_t n_cut, size_t n_point)
{
  uint64_t n_copy;

  assert_int_equal(r->n_tri, n_tri);
  assert_int_equal(r->n_cut, n_cut);
  assert_int_equal(r->n_point, n_point);
  assert_int_equal(vg_mesh_open_edges(m), 0);
  assert_true(fabs(scene_volume(m) - 8) < 1e-12);
  assert_int_equal(vg_mesh_copies(m, &n_copy, NULL), VG_OK);
  assert_int_equal(n_copy, n_point);
  assert_true(vg_mesh_has_inner(m));
}

static void a_free_sheet(void **state)
{
  const double o[3] = { -.5, -.5, .1 };
  struct vg_inner_report r;
  struct vg_mesh m;

  (void)state;
  assert_int_equal(make(&m, o, x, y, 4, &r, NULL), VG_OK);
  /* 32 triangles, two more for each corner with one triangle; copies of the
   * nine inner points and of the two middles. */
  expect(&m, &r, 36, 2, 11);
  vg_mesh_release(&m);
}

/* One triangle pair: all points are on free edges; the diagonal is cut. */
static void a_sheet_of_two_triangles(void **state)
{
  const double o[3] = { -.5, -.5, .1 };
  struct vg_inner_report r;
  struct vg_mesh m;

  (void)state;
  assert_int_equal(make(&m, o, x, y, 1, &r, NULL), VG_OK);
  expect(&m, &r, 4, 1, 1);
  vg_mesh_release(&m);
}

static void a_single_triangle(void **state)
{
  struct vg_inner_report r;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 2, 1);
  vg_mesh_add_patch(&m, 40, "sheet");
  shape_tri(&m, shape_point(&m, 0, 0, 0), shape_point(&m, .5, 0, 0),
            shape_point(&m, 0, .5, .1), 6);
  assert_int_equal(put_back(&m, &r, NULL), VG_OK);
  expect(&m, &r, 3, 1, 1);
  vg_mesh_release(&m);
}

/* From the wall at z = -1 up: the middle points of the common edge have one
 * copy, its ends none. */
static void a_sheet_on_a_wall(void **state)
{
  const double o[3] = { -.5, 0, -1 }, v[3] = { 0, 0, 1 };
  struct vg_inner_report r;
  struct vg_mesh m;

  (void)state;
  assert_int_equal(make(&m, o, x, v, 2, &r, NULL), VG_OK);
  assert_int_equal(r.n_point, r.n_cut + 2);
  expect(&m, &r, 8 + 2 * r.n_cut, r.n_cut, r.n_point);
  vg_mesh_release(&m);
}

/* Half-edges that occur more than once. */
static size_t n_repeated(const struct vg_mesh *m)
{
  size_t n = 0;

  for (size_t g = 0; g < 3 * m->n_tri; g++)
    for (size_t h = 0; h < g; h++)
      n += vg_half_from((const uint32_t(*)[3])m->tri, (uint32_t)g) ==
             vg_half_from((const uint32_t(*)[3])m->tri, (uint32_t)h) &&
           vg_half_to((const uint32_t(*)[3])m->tri, (uint32_t)g) ==
             vg_half_to((const uint32_t(*)[3])m->tri, (uint32_t)h);
  return n;
}

/* One edge on the wall, between two free ones, is cut, and the diagonal. */
static void a_sheet_on_one_edge(void **state)
{
  const double o[3] = { -.5, 0, -1 }, u[3] = { .5, 0, 0 }, v[3] = { 0, 0, .5 };
  struct vg_inner_report r;
  struct vg_mesh m;

  (void)state;
  assert_int_equal(make(&m, o, u, v, 1, &r, NULL), VG_OK);
  expect(&m, &r, 5, 2, 2);
  assert_int_equal(n_repeated(&m), 0);
  vg_mesh_release(&m);
}

/* The sheet divides the box: every point of it occurs twice. */
static void a_wall_across(void **state)
{
  const double o[3] = { -1, -1, 0 }, u[3] = { 2, 0, 0 }, v[3] = { 0, 2, 0 };
  struct vg_inner_report r;
  struct vg_mesh m;

  (void)state;
  assert_int_equal(make(&m, o, u, v, 4, &r, NULL), VG_OK);
  expect(&m, &r, 32, 0, 25);
  assert_int_equal(r.n_sealed, 1);
  assert_int_equal(r.n_near, 0);
  vg_mesh_release(&m);
}

/* The mesh continues through it: no point is copied, no edge cut, nothing
 * sealed. Without its triangles the boundary is the box. */
static void a_sheet_that_the_mesh_passes(void **state)
{
  const double o[3] = { -1, -1, 0 }, u[3] = { 2, 0, 0 }, v[3] = { 0, 2, 0 };
  struct vg_inner_report r;
  struct vg_mesh m;
  size_t n_tri;

  (void)state;
  memset(&m, 0, sizeof m);
  shape_box(&m, 4, 1);
  n_tri = m.n_tri;
  add_sheet(&m, o, u, v, 4);
  assert_int_equal(put_sides(&m, 1, &r, NULL), VG_OK);
  expect(&m, &r, 32, 0, 0);
  assert_int_equal(r.n_sealed, 0);
  assert_int_equal(vg_mesh_part_sheets(&m, NULL), VG_OK);
  assert_int_equal(m.n_tri, n_tri);
  assert_int_equal(m.n_sheet, 1);
  assert_int_equal(m.n_sheet_tri, 32);
  assert_int_equal(m.sheet[0].id, 40);
  assert_true(fabs(vg_mesh_sheet_area(&m, 0) - 4) < 1e-12);
  assert_int_equal(vg_mesh_find_patch(&m, 40), SIZE_MAX);
  assert_int_equal(vg_mesh_find_patch(&m, 50), SIZE_MAX);
  assert_int_equal(vg_mesh_open_edges(&m), 0);
  vg_mesh_release(&m);
}

/* A baffle of 4 x 4 whose edge at x = 0 is continued by a sheet: the fluid
 * passes behind that edge as around a free one. */
static void a_sheet_behind_a_baffle(void **state)
{
  const double o[3] = { -.5, -.5, .1 }, w[3] = { 0, -.5, .1 };
  const double h[3] = { .5, 0, 0 };
  uint8_t is_inner[11] = { 0 };
  uint32_t back[11] = { 0 };
  struct vg_inner_report r;
  struct vg_mesh m;
  size_t baffle, sheet;

  (void)state;
  memset(&m, 0, sizeof m);
  shape_box(&m, 4, 1);
  add_sheet(&m, o, h, y, 4);
  baffle = m.n_patch - 1;
  m.patch[baffle].id = 41;
  add_sheet(&m, w, h, y, 4);
  sheet = m.n_patch - 1;
  back[baffle] = (uint32_t)vg_mesh_add_patch(&m, 50, "baffle_back");
  back[sheet] = (uint32_t)vg_mesh_add_patch(&m, 51, "sheet_back");
  is_inner[baffle] = is_inner[sheet] = 1;
  m.patch[baffle].inner = m.patch[sheet].inner = VG_INNER_FRONT;
  m.patch[back[baffle]].inner = m.patch[back[sheet]].inner = VG_INNER_BACK;
  m.patch[sheet].is_sheet = m.patch[back[sheet]].is_sheet = 1;
  assert_int_equal(vg_surface_merge_points(&m, NULL), VG_OK);
  assert_int_equal(vg_inner_double(&m, is_inner, back, &r, NULL), VG_OK);
  /* the nine inner points of the baffle, and the middles of cut edges */
  expect(&m, &r, r.n_tri, r.n_cut, 9 + r.n_cut);
  assert_int_equal(r.n_sealed, 0);
  vg_mesh_release(&m);
}

/* Backs of baffles come before those of sheets, whatever the order of their
 * fronts. */
static void fronts_of_backs(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  for (int i = 0; i < 7; i++) {
    vg_mesh_add_patch(&m, i + 1, "");
    m.patch[i].inner = i == 0 ? VG_INNER_NOT
                     : i < 4  ? VG_INNER_FRONT
                              : VG_INNER_BACK;
  }
  m.patch[1].is_sheet = m.patch[3].is_sheet = 1;
  m.patch[5].is_sheet = m.patch[6].is_sheet = 1;
  assert_int_equal(vg_mesh_front_patch(&m, 0), 0);
  assert_int_equal(vg_mesh_front_patch(&m, 2), 2);
  assert_int_equal(vg_mesh_front_patch(&m, 4), 2);
  assert_int_equal(vg_mesh_front_patch(&m, 5), 1);
  assert_int_equal(vg_mesh_front_patch(&m, 6), 3);
  vg_mesh_release(&m);
}

static void reverse(uint32_t v[3])
{
  const uint32_t second = v[1];

  v[1] = v[2];
  v[2] = second;
}

/* A sheet with every other triangle reversed, the first one included: all of
 * its front looks down. */
static void triangles_that_disagree(void **state)
{
  const double o[3] = { -.5, -.5, .1 };
  struct vg_inner_report r;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 4, 1);
  add_sheet(&m, o, x, y, 4);
  for (size_t t = m.n_tri - 32; t < m.n_tri; t += 2) reverse(m.tri[t]);
  assert_int_equal(put_back(&m, &r, NULL), VG_OK);
  expect(&m, &r, 36, 2, 11);
  assert_int_equal(r.n_turned, 16);
  assert_true(fabs(r.turned_at[2] - .1) < 1e-12);
  for (size_t t = 0; t < m.n_tri; t++) {
    const double *a = m.point[m.tri[t][0]], *b = m.point[m.tri[t][1]];
    const double *c = m.point[m.tri[t][2]];
    const double up = (b[0] - a[0]) * (c[1] - a[1]) -
                      (b[1] - a[1]) * (c[0] - a[0]);
    const int32_t side = m.patch[m.tri_patch[t]].inner;

    if (side) assert_true(side == VG_INNER_FRONT ? up < 0 : up > 0);
  }
  vg_mesh_release(&m);
}

/* A strip of n quadrilaterals around the z axis, with half a twist. */
static void add_strip(struct vg_mesh *m, uint32_t n)
{
  const size_t patch = vg_mesh_add_patch(m, 40, "sheet");
  const uint32_t first = (uint32_t)m->n_point;

  for (uint32_t i = 0; i < n; i++)
    for (int k = -1; k <= 1; k += 2) {
      const double a = 2 * acos(-1) * i / n, r = .5 + .2 * k * cos(a / 2);

      shape_point(m, r * cos(a), r * sin(a), .2 * k * sin(a / 2));
    }
  for (uint32_t i = 0; i < n; i++) {
    const uint32_t last = i + 1 == n;
    const uint32_t a = first + 2 * i, b = last ? first : a + 2;

    shape_tri(m, a, a + 1, b + last, patch);
    shape_tri(m, a + 1, b + !last, b + last, patch);
  }
}

static void a_strip_with_one_side(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_inner_report r;
  struct vg_mesh m = VG_MESH_INIT;
  size_t n_tri;

  (void)state;
  shape_box(&m, 4, 1);
  n_tri = m.n_tri;
  add_strip(&m, 24);
  assert_int_equal(put_back(&m, &r, &err), VG_ERR_GEOMETRY);
  assert_non_null(strstr(err.text, "patch 40 sheet has only one side"));
  assert_int_equal(m.n_tri, n_tri + 48);
  vg_mesh_release(&m);
}

/* An edge at a small distance from the wall at z = -1. */
static void sheets_near_walls(void **state)
{
  const double o[3] = { -.5, .2, -1 + 1e-4 }, v[3] = { 0, 0, 1 };
  struct vg_inner_report r;
  struct vg_mesh m;

  (void)state;
  assert_int_equal(make(&m, o, x, v, 2, &r, NULL), VG_OK);
  assert_int_equal(r.n_sealed, 0);
  assert_in_range(r.n_near, 1, 99);
  assert_true(fabs(r.gap - 1e-4) < 1e-12);
  assert_true(r.at[2] > -1 && r.at[2] < -.5);
  vg_mesh_release(&m);
}

/* Edges of two sheets that pass each other, far from all corners. */
static void edges_that_pass(void **state)
{
  const double below[3] = { .03, -.5, -.5 }, above[3] = { -.5, .07, 1e-4 };
  const double up[3] = { 0, 0, .5 };
  struct vg_inner_report r;
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  shape_box(&m, 4, 1);
  add_sheet(&m, below, y, up, 1);
  add_sheet(&m, above, x, up, 1);
  for (size_t t = m.n_tri - 4; t < m.n_tri; t++)
    m.tri_patch[t] = (uint32_t)m.n_patch - 1;
  assert_int_equal(put_back(&m, &r, NULL), VG_OK);
  assert_int_equal(r.n_near, 1);
  assert_true(fabs(r.gap - 1e-4) < 1e-12);
  vg_mesh_release(&m);
}

static void expect_refused(const double o[3], const double v[3],
                           const char *text)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_inner_report r;
  struct vg_mesh m;
  size_t n_tri;

  assert_int_equal(make(&m, o, x, v, 2, &r, &err), VG_ERR_GEOMETRY);
  n_tri = m.n_tri;
  assert_non_null(strstr(err.text, "patch 40 sheet"));
  assert_non_null(strstr(err.text, text));
  assert_int_equal(n_tri, 6 * 32 + 8);
  vg_mesh_release(&m);
}

static void sheets_outside(void **state)
{
  const double far[3] = { 5, 0, 0 }, on_wall[3] = { -.5, 0, 1 };
  const double corner[3] = { 1, 1, 1 }, up[3] = { 0, 0, 1 };
  const double rounded[3] = { -.5, .2, -1 + 1e-12 };

  (void)state;
  expect_refused(far, y, "not in the fluid");
  expect_refused(on_wall, up, "not in the fluid");
  expect_refused(corner, up, "single point");
  expect_refused(rounded, up, "nearly touches patch ");
}

/* --- meshes ----------------------------------------------------------------
 */

static void sheet_scene(struct scene *s)
{
  const double o[3] = { -.5, 0, -1 }, u[3] = { 1, .1, 0 }, v[3] = { 0, .2, 1 };
  struct vg_inner_report r;

  memset(s, 0, sizeof *s);
  shape_box(&s->m, 8, 1);
  add_sheet(&s->m, o, u, v, 8);
  /* the edge on the wall is not one of its edges: lift it off */
  for (size_t p = s->m.n_point - 81; p < s->m.n_point; p++)
    s->m.point[p][2] += .25;
  assert_int_equal(put_back(&s->m, &r, NULL), VG_OK);
  s->sizing = shape_sizing(&s->m, 1.2, .12);
  s->volume = scene_volume(&s->m);
}

static void any_decomposition(void **state)
{
  vg_decomposition_maker *const maker[] = { NULL, vg_discrete_part,
                                            vg_octree_part };
  struct scene s;

  (void)state;
  sheet_scene(&s);
  for (size_t i = 0; i < sizeof maker / sizeof *maker; i++) {
    struct vg_partition_options o = options_of(4000, 1, 0);
    struct mesh_digest expect, d;
    struct vg_partition_report r;

    if (maker[i] && !vg_graph_is_built()) continue;
    o.maker = maker[i];
    o.decomposition.n_part = maker[i] ? 4 : 0;
    expect = run_of(NULL, &s, &o, 1, &r);
    assert_true(r.n_leaf > 1);
    o.threads = 3;
    o.shuffle = 7;
    d = run_of(NULL, &s, &o, 0, &r);
    same_digest(&expect, &d);
  }
  scene_end(&s);
}

/* Leaves that fail are filled again together with adjacent pieces; sides of the
 * sheet within these stay. */
static void leaves_that_fail(void **state)
{
  struct scene s;

  (void)state;
  sheet_scene(&s);
  for (int k = 1; k <= 3; k++) {
    struct vg_partition_options o = options_of(1500, 2, 0);
    struct vg_partition_report r;

    o.fail_leaves = .3 * k;
    o.fail_rounds = 1;
    run_of(NULL, &s, &o, 1, &r);
    assert_true(r.n_widened > 0);
  }
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_free_sheet),
    cmocka_unit_test(a_sheet_of_two_triangles),
    cmocka_unit_test(a_single_triangle),
    cmocka_unit_test(a_sheet_on_a_wall),
    cmocka_unit_test(a_sheet_on_one_edge),
    cmocka_unit_test(a_wall_across),
    cmocka_unit_test(a_sheet_that_the_mesh_passes),
    cmocka_unit_test(a_sheet_behind_a_baffle),
    cmocka_unit_test(fronts_of_backs),
    cmocka_unit_test(triangles_that_disagree),
    cmocka_unit_test(a_strip_with_one_side),
    cmocka_unit_test(sheets_near_walls),
    cmocka_unit_test(edges_that_pass),
    cmocka_unit_test(sheets_outside),
    cmocka_unit_test(any_decomposition),
    cmocka_unit_test(leaves_that_fail),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
