/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Inner surfaces and walls that are remeshed one after the other, and inner
 * surfaces that cross walls: the parts in the fluid are those of a polygon that
 * is clipped by the planes of a box. */
#include "io_support.h"

#include <math.h>

#include "core/geometry/vector.h"
#include "core/junction/junction.h"
#include "core/mesh/edges.h"
#include "core/remesh/remesh.h"
#include "core/surface/surface_check.h"
#include "core/wrap/unite.h"
#include "core/wrap/wrap.h"
#include "inner_shapes.h"

#define CASES 200 /* random sheets */

static double area_of(const struct vg_mesh *m, size_t first, size_t end)
{
  double sum = 0;

  for (size_t t = first; t < end; t++)
    sum += vg_triangle_area(m->point[m->tri[t][0]], m->point[m->tri[t][1]],
                            m->point[m->tri[t][2]]);
  return sum;
}

/* A box from -1 to 1 and sheets. */
struct scene {
  struct vg_mesh m;
  size_t n_wall;
};

static void open_scene(struct scene *s)
{
  memset(&s->m, 0, sizeof s->m);
  shape_box(&s->m, 4, 1);
  s->n_wall = s->m.n_tri;
}

static void remesh(struct vg_mesh *m, const double *stretch,
                   const uint8_t *still, const double *cap)
{
  struct vg_remesh_options o = VG_REMESH_OPTIONS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  o.h_max = 0.15;
  o.stretch = stretch;
  o.still = still;
  o.cap = cap;
  if (vg_remesh(m, &o, NULL, &err) != VG_OK) fail_msg("%s", err.text);
}

static void append(struct vg_mesh *to, const struct vg_mesh *m)
{
  to->point = realloc(to->point,
                      (to->n_point + m->n_point) * sizeof *to->point);
  to->tri = realloc(to->tri, (to->n_tri + m->n_tri) * sizeof *to->tri);
  to->tri_patch = realloc(to->tri_patch,
                          (to->n_tri + m->n_tri) * sizeof *to->tri_patch);
  memcpy(to->point + to->n_point, m->point, m->n_point * sizeof *m->point);
  for (size_t t = 0; t < m->n_tri; t++, to->n_tri++) {
    for (int k = 0; k < 3; k++)
      to->tri[to->n_tri][k] = m->tri[t][k] + (uint32_t)to->n_point;
    to->tri_patch[to->n_tri] = m->tri_patch[t];
  }
  to->n_point += m->n_point;
}

static void walls_of(const struct scene *s, struct vg_mesh *walls)
{
  assert_int_equal(vg_mesh_copy(walls, &s->m, NULL), VG_OK);
  walls->n_tri = s->n_wall;
}

/* Remeshes walls and sheets, and returns all of them as one mesh. */
static void remesh_all(const struct scene *s, struct vg_junctions *j,
                       struct vg_mesh *walls)
{
  double *stretch = calloc(3 * s->n_wall, sizeof *stretch);
  uint8_t *still = calloc(s->m.n_point, 1);
  struct vg_mesh all = VG_MESH_INIT;

  walls_of(s, walls);
  assert_int_equal(vg_junctions_find(&s->m, s->n_wall, j, NULL), VG_OK);
  vg_junctions_mark(j, walls, stretch, still);
  /* Points without triangles are not allowed. */
  walls->n_point = 98;
  remesh(walls, stretch, still, NULL);
  assert_int_equal(vg_junctions_trace(j, 0, walls, NULL), VG_OK);
  for (uint32_t i = 1; i < j->n_piece; i++) {
    struct vg_junction_piece p = VG_JUNCTION_PIECE_INIT;
    struct vg_error err = VG_ERROR_INIT;

    if (vg_junctions_piece(j, i, &p, &err) != VG_OK) fail_msg("%s", err.text);
    remesh(&p.mesh, p.stretch, p.still, p.cap);
    assert_int_equal(vg_junctions_trace(j, i, &p.mesh, NULL), VG_OK);
    append(&all, &p.mesh);
    vg_junction_piece_release(&p);
  }
  append(walls, &all);
  vg_mesh_release(&all);
  free(stretch);
  free(still);
  assert_int_equal(vg_surface_merge_points(walls, NULL), VG_OK);
}

/* Edges by their number of triangles. */
static void count_edges(const struct vg_mesh *m, size_t n[5])
{
  struct vg_edges e = VG_EDGES_INIT;

  memset(n, 0, 5 * sizeof *n);
  assert_int_equal(vg_edges_build(&e, m->n_point, m->n_tri,
                                  (const uint32_t(*)[3])m->tri, NULL, 0, NULL),
                   VG_OK);
  for (size_t i = 0; i < e.n; i++)
    n[vg_edges_count(&e, i) < 5 ? vg_edges_count(&e, i) : 0]++;
  vg_edges_release(&e);
}

static const double ex[3] = { 1, 0, 0 }, ez[3] = { 0, 0, 1 };

/* A fin on the floor, and a plate on a line of the fin. */
static void surfaces_share_edges(void **state)
{
  const double o[3] = { -.5, 0, -1 }, q[3] = { -.5, 0, -.5 };
  const double along[3] = { 0, .5, 0 };
  struct vg_junctions j = VG_JUNCTIONS_INIT;
  struct vg_mesh made = VG_MESH_INIT;
  struct scene s;
  size_t n[5], edges = 0;

  (void)state;
  open_scene(&s);
  add_sheet(&s.m, o, ex, ez, 2);
  vg_mesh_add_patch(&s.m, 41, "plate");
  add_sheet(&s.m, q, ex, along, 2);
  for (size_t t = s.n_wall + 8; t < s.m.n_tri; t++)
    s.m.tri_patch[t] = s.m.tri_patch[s.n_wall] + 1;
  assert_int_equal(vg_surface_merge_points(&s.m, NULL), VG_OK);
  remesh_all(&s, &j, &made);
  assert_int_equal(j.n_piece, 3);
  assert_int_equal(j.n, 2);
  for (size_t i = 0; i < j.n; i++) edges += j.curve[i].n_made - 1;
  assert_true(edges >= 2 * 6);
  count_edges(&made, n);
  /* Three triangles at each edge of both curves, and free edges. */
  assert_int_equal(n[3], edges);
  assert_int_equal(n[0] + n[4], 0);
  assert_true(n[1] > 20);
  assert_true(fabs(area_of(&made, 0, made.n_tri) - (24 + 1 + .5)) < 1e-9);
  vg_junctions_release(&j);
  vg_mesh_release(&made);
  vg_mesh_release(&s.m);
}

/* --- sheets that cross walls ------------------------------------------------
 */

static int needs_cgal(void)
{
  if (vg_wrap_is_available(NULL, 0)) return 1;
  print_message("no vanguard-wrap: skipped\n");
  return 0;
}

static double random_in(uint64_t *seed, double lo, double hi)
{
  *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
  return lo + (hi - lo) * (double)(*seed >> 11) / 9007199254740992.0;
}

/* Area of the part of a parallelogram for which all coordinates are between -1
 * and 1, and the first one is not below `least`. */
static double clipped_area(const double o[3], const double u[3],
                           const double v[3], double least)
{
  double p[16][3], q[16][3], sum[3] = { 0, 0, 0 };
  size_t n = 4;

  for (int k = 0; k < 3; k++) {
    p[0][k] = o[k];
    p[1][k] = o[k] + u[k];
    p[2][k] = o[k] + u[k] + v[k];
    p[3][k] = o[k] + v[k];
  }
  for (int plane = 0; plane < 6; plane++) {
    const int axis = plane / 2;
    const double sign = plane % 2 ? -1 : 1;
    const double at = plane ? 1 : -least;
    size_t made = 0;

    for (size_t i = 0; i < n; i++) {
      const double *a = p[i], *b = p[(i + 1) % n];
      const double da = sign * a[axis] + at, db = sign * b[axis] + at;

      if (da >= 0) memcpy(q[made++], a, sizeof *q);
      if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
        for (int k = 0; k < 3; k++)
          q[made][k] = a[k] + da / (da - db) * (b[k] - a[k]);
        made++;
      }
    }
    memcpy(p, q, sizeof p);
    n = made;
  }
  for (size_t i = 1; i + 1 < n; i++) {
    double a[3], b[3], c[3];

    vg_sub(p[i], p[0], a);
    vg_sub(p[i + 1], p[0], b);
    vg_cross(a, b, c);
    for (int k = 0; k < 3; k++) sum[k] += c[k] / 2;
  }
  return vg_norm(sum);
}

/* Cuts the sheet of s to the box. */
static void cut(struct scene *s, double *lost)
{
  const struct vg_stop stop = { NULL, NULL };
  struct vg_error err = VG_ERROR_INIT;

  *lost = 0;
  if (vg_imprint(&s->m, s->n_wall, &stop, &s->n_wall, &err) != VG_OK)
    fail_msg("%s", err.text);
  assert_int_equal(vg_surface_merge_points(&s->m, NULL), VG_OK);
  s->n_wall = vg_junction_drop_flat(&s->m, s->n_wall);
  if (vg_junction_drop_solid(&s->m, s->n_wall, lost, &err) != VG_OK)
    fail_msg("%s", err.text);
}

/* Random parallelograms that contain a point of the box. */
static void random_sheets_are_cut(void **state)
{
  uint64_t seed = 1;

  (void)state;
  if (!needs_cgal()) return;
  for (int i = 0; i < CASES; i++) {
    const double at = random_in(&seed, .2, .8);
    double o[3], u[3], v[3], whole, expected, lost;
    struct scene s;

    for (int k = 0; k < 3; k++) {
      const double in = random_in(&seed, 0, .9);

      u[k] = random_in(&seed, -2, 2);
      v[k] = random_in(&seed, -2, 2);
      o[k] = in - at * (u[k] + v[k]);
    }
    open_scene(&s);
    assert_int_equal(vg_surface_merge_points(&s.m, NULL), VG_OK);
    add_sheet(&s.m, o, u, v, 1 + i % 3);
    whole = area_of(&s.m, s.n_wall, s.m.n_tri);
    expected = clipped_area(o, u, v, -1);
    cut(&s, &lost);
    assert_true(fabs(area_of(&s.m, 0, s.n_wall) - 24) < 1e-10);
    assert_true(fabs(area_of(&s.m, s.n_wall, s.m.n_tri) - expected) < 1e-10);
    assert_true(fabs(whole - expected - lost) < 1e-10);
    vg_mesh_release(&s.m);
  }
}

/* Both sides of a plane have the whole sheet together. */
static void random_sheets_are_clipped(void **state)
{
  uint64_t seed = 2;

  (void)state;
  for (int i = 0; i < CASES; i++) {
    const double at = random_in(&seed, -.8, .8);
    double o[3], u[3], v[3], expected;

    for (int k = 0; k < 3; k++) {
      u[k] = random_in(&seed, -.5, .5);
      v[k] = random_in(&seed, -.5, .5);
      o[k] = random_in(&seed, -.5, .5) - (u[k] + v[k]) / 2;
    }
    expected = clipped_area(o, u, v, at);
    for (int is_above = 0; is_above < 2; is_above++) {
      const struct vg_junction_half half = { 0, is_above, at };
      struct vg_mesh m = VG_MESH_INIT;
      double lost = 0, whole, area;

      add_sheet(&m, o, u, v, 1 + i % 4);
      whole = area_of(&m, 0, m.n_tri);
      assert_int_equal(vg_junction_clip(&m, 0, &half, &lost, NULL), VG_OK);
      area = area_of(&m, 0, m.n_tri);
      assert_true(fabs(area + lost - whole) < 1e-12);
      assert_true(fabs((is_above ? area : whole - area) - expected) < 1e-12);
      vg_mesh_release(&m);
    }
  }
}

/* A sheet that misses a sharp edge by little has its edges afterwards. */
static void sheets_snap_to_sharp_edges(void **state)
{
  /* The upper edge of the box along y at x = 1 is -1 to 1. */
  const double o[3] = { 1 + 3e-7, -.7, 1 - 2e-7 }, u[3] = { 1, 0, .1 };
  const double v[3] = { 0, 1.4, 0 };
  struct vg_mesh walls = VG_MESH_INIT, sheet = VG_MESH_INIT;
  struct scene s;
  size_t n_moved, n[5];

  (void)state;
  open_scene(&s);
  assert_int_equal(vg_surface_merge_points(&s.m, NULL), VG_OK);
  walls_of(&s, &walls);
  add_sheet(&sheet, o, u, v, 3);
  assert_int_equal(vg_junction_snap(&walls, &sheet, 1e-5, &n_moved, NULL),
                   VG_OK);
  assert_int_equal(n_moved, 4);
  append(&walls, &sheet);
  assert_int_equal(vg_surface_merge_points(&walls, NULL), VG_OK);
  count_edges(&walls, n);
  /* Points at -.7, -.5, -.23, 0, .23, .5 and .7. */
  assert_int_equal(n[3], 6);
  assert_int_equal(n[0] + n[4], 0);
  vg_mesh_release(&walls);
  vg_mesh_release(&sheet);
  vg_mesh_release(&s.m);
}

/* A sheet that enters the body through a hole of the walls is refused. */
static void a_sheet_through_a_hole(void **state)
{
  const double o[3] = { -.2, -.2, .5 }, u[3] = { .4, 0, 0 };
  const double v[3] = { 0, .1, 1 };
  struct vg_error err = VG_ERROR_INIT;
  struct scene s;
  double lost = 0;

  (void)state;
  open_scene(&s);
  add_sheet(&s.m, o, u, v, 2);
  assert_int_equal(vg_surface_merge_points(&s.m, NULL), VG_OK);
  /* No common edges: nothing is known, nothing is dropped. */
  assert_int_equal(vg_junction_drop_solid(&s.m, s.n_wall, &lost, &err), VG_OK);
  assert_int_equal(s.m.n_tri, s.n_wall + 8);
  assert_true(lost == 0);
  vg_mesh_release(&s.m);
}

/* A triangle and the same one moved in its plane, turned around an edge, and
 * next to it, in random positions. */
static void triangles_overlap(void **state)
{
  uint64_t seed = 5;

  (void)state;
  for (int round = 0; round < 200; round++) {
    double s[3][3], t[3][3], n[3], u[3], v[3];

    for (int i = 0; i < 9; i++) s[i / 3][i % 3] = random_in(&seed, 0, 4);
    vg_sub(s[1], s[0], u);
    vg_sub(s[2], s[0], v);
    vg_cross(u, v, n);
    if (!(vg_unit(n) > 0.5)) continue;
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) t[i][k] = s[i][k] + 0.2 * (u[k] + v[k]);
    assert_true(
      vg_junction_overlap((const double(*)[3])s, (const double(*)[3])t, 1e-9));
    /* Off the plane. */
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++) t[i][k] += 1e-3 * n[k];
    assert_false(
      vg_junction_overlap((const double(*)[3])s, (const double(*)[3])t, 1e-9));
    /* The neighbour across the edge u, in the plane, and turned out of it. */
    for (int k = 0; k < 3; k++) {
      t[0][k] = s[1][k];
      t[1][k] = s[0][k];
      t[2][k] = s[0][k] + u[k] - v[k];
    }
    assert_false(
      vg_junction_overlap((const double(*)[3])s, (const double(*)[3])t, 1e-9));
    for (int k = 0; k < 3; k++) t[2][k] = s[2][k] + n[k];
    assert_false(
      vg_junction_overlap((const double(*)[3])s, (const double(*)[3])t, 1e-9));
    /* One inside the other. */
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        t[i][k] = (s[0][k] + s[1][k] + s[2][k] + s[i][k]) / 4;
    assert_true(
      vg_junction_overlap((const double(*)[3])t, (const double(*)[3])s, 1e-9));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(surfaces_share_edges),
    cmocka_unit_test(random_sheets_are_cut),
    cmocka_unit_test(random_sheets_are_clipped),
    cmocka_unit_test(sheets_snap_to_sharp_edges),
    cmocka_unit_test(a_sheet_through_a_hole),
    cmocka_unit_test(triangles_overlap),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
