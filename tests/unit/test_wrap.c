#include "io_support.h"

#include <math.h>

#include "core/surface/surface_check.h"
#include "core/wrap/wrap.h"
#include "io/mesh/format.h"

static int needs_cgal(void **state)
{
  (void)state;
  if (vg_wrap_is_built()) return 0;
  print_message("built without CGAL: skipped\n");
  exit(77);
}

/* A brick of twelve triangles from `lo` with edges of 1, as a patch of its
 * own; `n` triangles of it. */
static void add_brick(struct vg_mesh *m, double lo, size_t n)
{
  static const uint32_t tri[12][3] = {
    { 0, 2, 3 }, { 0, 3, 1 }, { 4, 5, 7 }, { 4, 7, 6 }, { 0, 1, 5 },
    { 0, 5, 4 }, { 2, 6, 7 }, { 2, 7, 3 }, { 0, 4, 6 }, { 0, 6, 2 },
    { 1, 3, 7 }, { 1, 7, 5 } };
  size_t first = m->n_point, patch;

  m->point = realloc(m->point, (first + 8) * sizeof *m->point);
  m->tri = realloc(m->tri, (m->n_tri + n) * sizeof *m->tri);
  m->tri_patch = realloc(m->tri_patch, (m->n_tri + n) * sizeof *m->tri_patch);
  patch = vg_mesh_add_patch(m, (int32_t)m->n_patch + 1, "brick");
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++)
      m->point[first + (size_t)i][k] = lo + (i >> k & 1);
  m->n_point += 8;
  for (size_t i = 0; i < n; i++, m->n_tri++) {
    for (int k = 0; k < 3; k++)
      m->tri[m->n_tri][k] = (uint32_t)first + tri[i][k];
    m->tri_patch[m->n_tri] = (uint32_t)patch;
  }
}

/* What the promise is: a closed surface that points into the fluid. */
static size_t is_sound(struct vg_mesh *m)
{
  struct vg_surface_check_options o = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report r = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  size_t shells;

  o.external = 1;
  if (vg_surface_check(m, &o, &r, &err)) fail_msg("%s", err.text);
  assert_int_equal(r.n_defect, 0);
  assert_int_equal(r.n_flipped, 0);
  shells = r.n_shell;
  vg_surface_report_release(&r);
  return shells;
}

static void wrap(struct vg_mesh *m, double size, struct vg_wrap_report *r)
{
  struct vg_error err = VG_ERROR_INIT;

  if (vg_wrap(m, size, NULL, r, &err)) fail_msg("%s", err.text);
}

/* Parts that cross become one shell; patches follow nearness. */
static void crossing_bricks(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;
  size_t n_edge = 0;

  (void)state;
  add_brick(&m, 0, 12);
  add_brick(&m, 0.5, 12);
  wrap(&m, 0.1, &r);
  assert_int_equal(is_sound(&m), 1);
  assert_int_equal(r.n_before, 24);
  assert_int_equal(r.n_empty, 0);
  assert_int_equal(m.n_patch, 2);
  /* in the concave corner a ball of radius 0.1 stays so far away at most */
  assert_true(r.distance >= 0.9 * r.offset && r.distance < 0.1);
  /* points are on the bricks, and along their edges on these */
  assert_int_equal(r.n_point, m.n_point);
  assert_true(r.n_fit > 0.8 * (double)r.n_point);
  for (size_t i = 0; i < m.n_point; i++)
    n_edge += fabs(m.point[i][0]) < 1e-9 && fabs(m.point[i][1]) < 1e-9;
  assert_true(n_edge >= 5);   /* of a length of 1 in edges of about 0.1 */
  for (size_t i = 0; i < m.n_tri; i++) {
    double c = 0;

    for (int k = 0; k < 3; k++) c = fmax(c, m.point[m.tri[i][0]][k]);
    if (c > 1.2) assert_int_equal(m.tri_patch[i], 1);
    c = 2;
    for (int k = 0; k < 3; k++) c = fmin(c, m.point[m.tri[i][0]][k]);
    if (c < 0.3) assert_int_equal(m.tri_patch[i], 0);
  }
  vg_mesh_release(&m);
}

/* A body within another is lost, and said to be. */
static void what_is_inside_goes(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;

  (void)state;
  add_brick(&m, 0, 12);
  add_brick(&m, 0.3, 12);
  for (size_t i = 8; i < 16; i++)
    for (int k = 0; k < 3; k++) m.point[i][k] = 0.3 + 0.4 * (m.point[i][k] - 0.3);
  wrap(&m, 0.2, &r);
  assert_int_equal(is_sound(&m), 1);
  assert_int_equal(r.n_empty, 1);
  vg_mesh_release(&m);
}

static void a_small_hole_is_bridged_a_large_one_entered(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;
  double far;

  (void)state;
  add_brick(&m, 0, 10);      /* one side is missing */
  wrap(&m, 2, &r);
  is_sound(&m);
  far = r.distance;
  assert_true(far > 0.1);    /* the lid */
  vg_mesh_release(&m);
  add_brick(&m, 0, 10);
  wrap(&m, 0.1, &r);
  is_sound(&m);
  assert_true(r.distance < 0.1);
  vg_mesh_release(&m);
}

/* Points at an offset from an edge as sharp as a knife would fold if all of them
 * went onto it; they are put together there. */
static void knives_come_back(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;
  size_t n_knife = 0;

  (void)state;
  add_brick(&m, 0, 12);        /* 0.1 high at x = 0, nothing at x = 1 */
  for (size_t p = 0; p < 8; p++)
    m.point[p][2] = 0.1 * m.point[p][2] * (1 - m.point[p][0]);
  wrap(&m, 0.1, &r);
  assert_int_equal(is_sound(&m), 1);
  assert_true(r.n_zip > 0);
  assert_int_equal(r.n_fit, r.n_point);
  for (size_t p = 0; p < m.n_point; p++) {
    assert_true(m.point[p][0] < 1 + 1e-9);
    n_knife += m.point[p][0] > 1 - 1e-9;
  }
  assert_true(n_knife >= 6);   /* of a length of 1 in edges of about 0.1 */
  for (size_t t = 0; t < m.n_tri; t++) {
    size_t on = 0;

    for (int k = 0; k < 3; k++) on += m.point[m.tri[t][k]][0] > 1 - 1e-9;
    assert_true(on < 3);       /* no end is left between them */
  }
  vg_mesh_release(&m);
}

static int is_over(void *user)
{
  size_t *left = user;

  return *left ? --*left, 0 : 1;
}

/* Carving asks once a facet, and what comes after it once a point or two. */
static void stops_where_it_is(void **state)
{
  const size_t patience[4] = { 0, 1, 1000, 5000 };
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_wrap_report r;

  (void)state;
  add_brick(&m, 0, 12);
  for (int i = 0; i < 4; i++) {
    size_t left = patience[i];
    const struct vg_stop stop = { is_over, &left };

    assert_int_equal(vg_wrap(&m, 0.05, &stop, &r, &err), VG_ERR_STOPPED);
    assert_int_equal(m.n_tri, 12);
  }
  vg_mesh_release(&m);
}

static void the_same_twice(void **state)
{
  struct vg_mesh m[2] = { VG_MESH_INIT, VG_MESH_INIT };
  struct vg_wrap_report r;

  (void)state;
  for (int i = 0; i < 2; i++) {
    void *hole = malloc(12345);   /* other addresses */

    add_brick(&m[i], 0, 12);
    add_brick(&m[i], 0.7, 11);
    wrap(&m[i], 0.15, &r);
    free(hole);
  }
  assert_int_equal(m[0].n_point, m[1].n_point);
  assert_int_equal(m[0].n_tri, m[1].n_tri);
  assert_memory_equal(m[0].point, m[1].point,
                      m[0].n_point * sizeof *m[0].point);
  assert_memory_equal(m[0].tri, m[1].tri, m[0].n_tri * sizeof *m[0].tri);
  assert_memory_equal(m[0].tri_patch, m[1].tri_patch,
                      m[0].n_tri * sizeof *m[0].tri_patch);
  vg_mesh_release(&m[0]);
  vg_mesh_release(&m[1]);
}

static void refuses(struct vg_mesh *m, double size, vg_status code,
                    const char *phrase)
{
  struct vg_mesh before = *m;
  struct vg_wrap_report r;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_wrap(m, size, NULL, &r, &err);

  if (st != code || !strstr(err.text, phrase))
    fail_msg("status %d: '%s'", st, err.text);
  assert_memory_equal(m, &before, sizeof before);
}

static void what_cannot_be_is_refused(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  refuses(&m, 1, VG_ERR_INPUT, "only triangles");
  add_brick(&m, 0, 12);
  refuses(&m, 0, VG_ERR_INPUT, "must be > 0");
  refuses(&m, NAN, VG_ERR_INPUT, "must be > 0");
  refuses(&m, INFINITY, VG_ERR_INPUT, "must be > 0");
  refuses(&m, 1e-6, VG_ERR_INPUT, "in the unit of the surface?");
  m.n_tri = 10;                /* 15 / 2.5 times as many, by a hole of 1 x 1 */
  refuses(&m, 4e-3, VG_ERR_INPUT, "goes through holes");
  m.n_tri = 12;
  m.tri[3][1] = 8;
  refuses(&m, 1, VG_ERR_INPUT, "triangle 4");
  m.tri[3][1] = 0;
  m.tri_patch[11] = 1;
  refuses(&m, 1, VG_ERR_INPUT, "triangle 12");
  m.tri_patch[11] = 0;
  for (size_t i = 0; i < 12; i++)
    for (int k = 0; k < 3; k++) m.tri[i][k] = 0;
  refuses(&m, 1, VG_ERR_INPUT, "degenerate");
  vg_mesh_release(&m);
}

/* 704 intersections, 11 overlapping components, open edges. */
static void real_soups_become_sound(void **state)
{
  static const struct { const char *path; double size; } cases[] = {
    { "dirty/three_plugs.bin.tri.xz", 4 },
    { "dirty/toy_airplane_with_holes.obj.xz", 0.6 },
    { "dirty/f16_components_overlapping.stl.xz", 0.3 } };

  (void)state;
  for (size_t i = 0; i < 3; i++) {
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_wrap_report r;
    struct vg_error err = VG_ERROR_INIT;

    if (vg_surface_read(io_real(cases[i].path), &m, NULL, &err))
      fail_msg("%s", err.text);
    wrap(&m, cases[i].size, &r);
    assert_int_equal(is_sound(&m), 1);
    /* wider bridges would not have stopped the ball */
    assert_true(r.distance < cases[i].size);
    vg_mesh_release(&m);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(crossing_bricks),
    cmocka_unit_test(what_is_inside_goes),
    cmocka_unit_test(a_small_hole_is_bridged_a_large_one_entered),
    cmocka_unit_test(knives_come_back),
    cmocka_unit_test(stops_where_it_is),
    cmocka_unit_test(the_same_twice),
    cmocka_unit_test(what_cannot_be_is_refused),
    cmocka_unit_test(real_soups_become_sound),
  };

  return cmocka_run_group_tests(tests, needs_cgal, NULL);
}
