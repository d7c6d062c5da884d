/* SPDX-License-Identifier: LGPL-3.0-or-later */
#include "io_support.h"

#include <math.h>

#include "core/surface/surface_check.h"
#include "core/wrap/wrap_parts.h"
#include "io/mesh/format.h"
#include "run/input/input.h"

static int needs_cgal(void **state)
{
  (void)state;
  if (vg_wrap_is_available(NULL, 0)) return 0;
  print_message("no vanguard-wrap: skipped\n");
  exit(77);
}

/* A brick of twelve triangles from `lo` with edges of 1, as a separate patch;
 * only its first `n` triangles. */
static void add_brick(struct vg_mesh *m, double lo, size_t n)
{
  static const uint32_t tri[12][3] = { { 0, 2, 3 }, { 0, 3, 1 }, { 4, 5, 7 },
                                       { 4, 7, 6 }, { 0, 1, 5 }, { 0, 5, 4 },
                                       { 2, 6, 7 }, { 2, 7, 3 }, { 0, 4, 6 },
                                       { 0, 6, 2 }, { 1, 3, 7 }, { 1, 7, 5 } };
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

/* The promised result: a closed surface that points into the fluid. */
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
  for (size_t i = 0; i < r.n_shell; i++) {
    assert_int_equal(r.shell[i].depth, 0);
    assert_true(r.shell[i].volume > 0);
  }
  shells = r.n_shell;
  vg_surface_report_release(&r);
  return shells;
}

static void wrap(struct vg_mesh *m, double size, struct vg_wrap_report *r)
{
  const struct vg_wrap_options o = { .size = size };
  struct vg_error err = VG_ERROR_INIT;

  if (vg_wrap(m, &o, r, &err)) fail_msg("%s", err.text);
}

/* Scale the last brick about its first corner. */
static void scale_last(struct vg_mesh *m, double by)
{
  const double lo[3] = { m->point[m->n_point - 8][0],
                         m->point[m->n_point - 8][1],
                         m->point[m->n_point - 8][2] };

  for (size_t i = m->n_point - 8; i < m->n_point; i++)
    for (int k = 0; k < 3; k++)
      m->point[i][k] = lo[k] + by * (m->point[i][k] - lo[k]);
}

static void refuses_options(struct vg_mesh *m, const struct vg_wrap_options *o,
                            vg_status code, const char *phrase)
{
  struct vg_mesh before = *m;
  struct vg_wrap_report r;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_wrap(m, o, &r, &err);

  if (st != code || !strstr(err.text, phrase))
    fail_msg("status %d: '%s'", st, err.text);
  assert_memory_equal(m, &before, sizeof before);
}

static void refuses(struct vg_mesh *m, double size, vg_status code,
                    const char *phrase)
{
  const struct vg_wrap_options o = { .size = size };

  refuses_options(m, &o, code, phrase);
}

/* Bodies that intersect become one shell; patches follow the nearest
 * triangle. */
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
  /* in the concave corner a ball of radius 0.1 is at most this far away */
  assert_true(r.distance >= 0.9 * r.offset && r.distance < 0.1);
  /* points are on the bricks, and those near an edge are exactly on it */
  assert_int_equal(r.n_point, m.n_point);
  assert_true(r.n_fit > 0.8 * (double)r.n_point);
  for (size_t i = 0; i < m.n_point; i++)
    n_edge += fabs(m.point[i][0]) < 1e-9 && fabs(m.point[i][1]) < 1e-9;
  assert_true(n_edge >= 5); /* of a length of 1 in edges of about 0.1 */
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

/* A body within another is lost, and the report names its patch and its share
 * of the area: 6 * 0.4^2 of 6 + 6 * 0.4^2. */
static void bodies_inside_others_are_dropped(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;
  struct vg_error err = VG_ERROR_INIT;
  uint8_t empty[2];
  const struct vg_wrap_options o = { .size = 0.2, .empty = empty };

  (void)state;
  add_brick(&m, 0, 12);
  add_brick(&m, 0.3, 12);
  scale_last(&m, 0.4);
  if (vg_wrap(&m, &o, &r, &err)) fail_msg("%s", err.text);
  assert_int_equal(is_sound(&m), 1);
  assert_int_equal(r.n_empty, 1);
  assert_int_equal(empty[0], 0);
  assert_int_equal(empty[1], 1);
  assert_true(fabs(r.inside - 0.96 / 6.96) < 1e-9);
  assert_true(r.missing < 1.01 * r.offset);
  vg_mesh_release(&m);
}

/* The rim is a square of 1 x 1, so 1 wide. */
static void a_small_hole_is_bridged_a_large_one_refused(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;

  (void)state;
  add_brick(&m, 0, 10); /* one side is missing */
  wrap(&m, 2, &r);
  is_sound(&m);
  assert_true(r.distance > 0.1); /* the lid */
  vg_mesh_release(&m);
  add_brick(&m, 0, 10);
  refuses(&m, 0.3, VG_ERR_GEOMETRY, "close_holes yes"); /* after the wrap */
  refuses(&m, 0.3, VG_ERR_GEOMETRY, "up to 1 wide");
  refuses(&m, 0.1, VG_ERR_GEOMETRY, "would go through"); /* before */
  vg_mesh_release(&m);
  add_brick(&m, 0, 10);
  wrap(&m, 1.01, &r); /* as the message suggests */
  assert_int_equal(is_sound(&m), 1);
  vg_mesh_release(&m);
}

/* A hole between two bodies, each with a rim that the other covers: no refusal
 * in advance. */
static void covered_rims_are_no_holes(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;

  (void)state;
  add_brick(&m, 0, 12);
  add_brick(&m, 0.3, 10);
  scale_last(&m, 0.4);
  wrap(&m, 0.1, &r);
  assert_int_equal(is_sound(&m), 1);
  assert_true(r.sheet == 0);
  vg_mesh_release(&m);
}

/* A flat sheet of 1 x 1, repeated `times` times. */
static void add_sheet(struct vg_mesh *m, int times)
{
  for (int i = 0; i < times; i++) add_brick(m, 0, 2);
}

static void sheets_are_named(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  enum vg_wrap_reason reason;
  double size;

  (void)state;
  for (int times = 1; times < 3; times++) {
    add_sheet(&m, times);
    refuses(&m, 0.1, VG_ERR_GEOMETRY, "sheets without thickness");
    assert_int_equal(vg_wrap_suggest(&m, NULL, &size, &reason, &err), VG_OK);
    assert_int_equal(reason, VG_WRAP_SHEETS);
    assert_true(size == 0);
    vg_mesh_release(&m);
  }
}

/* Inner shells and tiny shells are removed; the others keep their order. */
static void shells_that_bound_no_body_are_removed(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_wrap_report r = { .offset = 0.01 };

  (void)state;
  add_brick(&m, 5, 12);
  scale_last(&m, 0.009); /* less than 0.01^3 */
  add_brick(&m, 0, 12);
  add_brick(&m, 0.3, 12);
  scale_last(&m, 0.4); /* a cavity */
  add_brick(&m, 0.4, 12);
  scale_last(&m, 0.1); /* in it */
  add_brick(&m, 2, 12);
  if (vg_wrap_prune(&m, NULL, &r, &err)) fail_msg("%s", err.text);
  assert_int_equal(r.n_crumb, 1);
  assert_int_equal(r.n_cavity, 2);
  assert_int_equal(m.n_tri, 24);
  assert_int_equal(m.n_point, 16);
  assert_int_equal(m.tri_patch[0], 1);
  assert_int_equal(m.tri_patch[12], 4);
  assert_int_equal(is_sound(&m), 2);
  vg_mesh_release(&m);
}

/* A brick in a tunnel that is ten times as large. */
static void add_tunnel(struct vg_mesh *m, double lo, uint8_t keep[36])
{
  add_brick(m, -4, 12);
  scale_last(m, 10);
  add_brick(m, lo, 12);
  memset(keep, 1, 12);
  memset(keep + 12, 0, 24);
}

static void outer_boundaries_are_kept(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_surface_check_options so = VG_SURFACE_CHECK_OPTIONS_INIT;
  struct vg_surface_report sr = VG_SURFACE_REPORT_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_wrap_report r;
  uint8_t keep[36];
  const struct vg_wrap_options o = { .size = 0.2, .keep = keep };

  (void)state;
  add_tunnel(&m, 0, keep);
  add_brick(&m, 0.5, 12); /* another one that intersects the first */
  if (vg_wrap(&m, &o, &r, &err)) fail_msg("%s", err.text);
  assert_int_equal(r.n_kept, 12);
  assert_int_equal(r.n_before, 24);
  assert_int_equal(r.n_point + 8, m.n_point);
  for (size_t i = 0; i < m.n_tri; i++)
    assert_int_equal(m.tri_patch[i] == 0, i >= m.n_tri - 12);
  for (size_t i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++)
      assert_true(m.point[r.n_point + i][k] == -4 + 10 * (double)(i >> k & 1));
  so.external = 0;
  if (vg_surface_check(&m, &so, &sr, &err)) fail_msg("%s", err.text);
  assert_int_equal(sr.n_defect, 0);
  assert_int_equal(sr.n_shell, 2);
  vg_surface_report_release(&sr);
  vg_mesh_release(&m);
}

static void bodies_that_leave_the_tunnel_are_refused(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  uint8_t keep[36];
  const struct vg_wrap_options o = { .size = 0.2, .keep = keep };

  (void)state;
  add_tunnel(&m, 5.5, keep); /* through the wall at 6 */
  refuses_options(&m, &o, VG_ERR_GEOMETRY, "meets the outer boundary");
  vg_mesh_release(&m);
  add_tunnel(&m, 6.001, keep); /* outside */
  refuses_options(&m, &o, VG_ERR_GEOMETRY, "outside the outer boundary");
  memset(keep, 1, sizeof keep);
  refuses_options(&m, &o, VG_ERR_INPUT, "nothing to wrap");
  vg_mesh_release(&m);
}

static void count_up(void *user, size_t done, size_t expected)
{
  size_t *seen = user;

  assert_true(done > seen[0]);
  seen[0] = done;
  seen[1] = expected;
}

/* The forecast's factor is between 0.4 and 2.5 on all surfaces measured. */
static void progress_has_a_share(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_wrap_forecast f;
  struct vg_wrap_report r;
  size_t seen[2] = { 0, 0 };
  const struct vg_wrap_options o = { .size = 0.04,
                                     .progress = count_up,
                                     .user = seen };

  (void)state;
  add_brick(&m, 0, 12);
  if (vg_wrap_foresee(&m, &o, &f, &err)) fail_msg("%s", err.text);
  if (vg_wrap(&m, &o, &r, &err)) fail_msg("%s", err.text);
  assert_true(seen[0] > 0 && seen[1] == (size_t)f.triangles / 2);
  assert_true(f.triangles > 0.4 * (double)m.n_tri);
  assert_true(f.triangles < 2.5 * (double)m.n_tri);
  assert_true(f.seconds > 0 && f.widest == 0 && f.n_part == 1 && !f.n_open);
  assert_true(fabs(f.area - 6) < 1e-12);
  vg_mesh_release(&m);
}

/* A suggested size works, and reason names its cause. */
static void suggestions_work(void **state)
{
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  for (size_t n = 10; n <= 12; n += 2) {
    struct vg_mesh m = VG_MESH_INIT;
    enum vg_wrap_reason reason;
    struct vg_wrap_report r;
    double size;

    add_brick(&m, 0, n);
    scale_last(&m, 100);
    for (size_t p = 0; p < 8; p++) /* a hole of 20 x 20 at an end */
      for (int k = 1; k < 3; k++) m.point[p][k] *= 0.2;
    if (vg_wrap_suggest(&m, NULL, &size, &reason, &err))
      fail_msg("%s", err.text);
    assert_int_equal(reason, n == 12 ? VG_WRAP_FITS : VG_WRAP_HOLES);
    wrap(&m, size, &r);
    assert_int_equal(is_sound(&m), 1);
    vg_mesh_release(&m);
  }
}

/* Up to three far points are found at any distance, but not four, which may be
 * a farfield: then the limit on points ends the search. */
static void far_points_are_named(void **state)
{
  (void)state;
  for (double far = 40; far < 1e9; far *= 1000)
    for (size_t n = 0; n <= 4; n++) {
      struct vg_mesh m = VG_MESH_INIT;
      enum vg_wrap_reason reason;
      uint32_t point = 0;
      size_t tri = 0;
      double size;

      add_brick(&m, 0, 12);
      m.n_tri--; /* a hole */
      for (size_t p = 0; p < n; p++) m.point[p][p % 3] += far * (1 + (double)p);
      assert_int_equal(vg_wrap_far_point(&m, &point, &tri), n && n < 4);
      if (n && n < 4) {
        assert_true(point < n);
        assert_true(m.tri[tri][0] == point || m.tri[tri][1] == point ||
                    m.tri[tri][2] == point);
      }
      if (n == 4) vg_wrap_suggest(&m, NULL, &size, &reason, NULL);
      vg_mesh_release(&m);
    }
}

/* Points at an offset from a sharp edge of zero thickness would fold if all of
 * them moved onto it; they are merged there. */
static void sharp_edges_are_restored(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;
  size_t n_knife = 0;

  (void)state;
  add_brick(&m, 0, 12); /* 0.1 high at x = 0, nothing at x = 1 */
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
  assert_true(n_knife >= 6); /* of a length of 1 in edges of about 0.1 */
  for (size_t t = 0; t < m.n_tri; t++) {
    size_t on = 0;

    for (int k = 0; k < 3; k++) on += m.point[m.tri[t][k]][0] > 1 - 1e-9;
    assert_true(on < 3); /* no end is left between them */
  }
  vg_mesh_release(&m);
}

static int is_over(void *user)
{
  size_t *left = user;

  return *left ? --*left, 0 : 1;
}

/* Carving polls the stop request once per facet, and later stages once per
 * point or two. */
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

    const struct vg_wrap_options o = { .size = 0.05, .stop = stop };

    assert_int_equal(vg_wrap(&m, &o, &r, &err), VG_ERR_STOPPED);
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
    void *hole = malloc(12345); /* other addresses */

    add_brick(&m[i], 0, 12);
    add_brick(&m[i], 0.7, 11);
    scale_last(&m[i], 0.2); /* the rim is inside the first one */
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

static void invalid_requests_are_refused(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;

  (void)state;
  refuses(&m, 1, VG_ERR_INPUT, "only triangles");
  add_brick(&m, 0, 12);
  refuses(&m, 0, VG_ERR_INPUT, "must be positive");
  refuses(&m, NAN, VG_ERR_INPUT, "must be positive");
  refuses(&m, INFINITY, VG_ERR_INPUT, "must be positive");
  refuses(&m, 1e-6, VG_ERR_INPUT, "in the unit of the surface?");
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
  /* rims of several bodies may be covered: no refusal in advance, but a
   * forecast of 15 / 2.5 times the limit */
  add_brick(&m, 0, 10);
  add_brick(&m, 0.2, 12);
  refuses(&m, 4e-3, VG_ERR_INPUT, "may go through holes");
  vg_mesh_release(&m);
}

static vg_status shape(size_t lo, const char *walls, struct vg_error *err)
{
  const struct vg_shape_options o = { .threads = 0 };
  struct vg_problem p = VG_PROBLEM_INIT;
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_display show;
  vg_status st;

  vg_display_init(&show, 1);
  add_brick(&m, 0, 12);
  add_brick(&m, (double)lo, 12);
  if (!lo) {
    add_brick(&m, 0.3, 12);
    scale_last(&m, 0.4);
  }
  vg_settings_default(&p.asked);
  p.asked.flow = VG_FLOW_EXTERNAL;
  p.asked.wrap = 0.2;
  snprintf(p.asked.layer.walls, sizeof p.asked.layer.walls, "%s", walls);
  st = vg_problem_given(&p, "bricks", &m, err);
  if (st >= 0) st = vg_boundary_shape(&p.read, &o, &show, &p.boundary, err);
  vg_problem_release(&p);
  return st;
}

/* A patch that walls name has faces after the wrap, or the run ends. */
static void walls_do_not_vanish(void **state)
{
  struct vg_error err = VG_ERROR_INIT;

  (void)state;
  assert_int_equal(shape(0, "1", &err), VG_OK);
  assert_int_equal(shape(0, "1-3", &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "nothing is left of patch 3"));
}

/* 704 intersections, 11 overlapping components, open edges. */
static void real_soups_become_sound(void **state)
{
  static const struct {
    const char *path;
    double size;
  } cases[] = { { "dirty/three_plugs.bin.tri.xz", 4 },
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

/* A file of the field set, unpacked and read. */
static void read_field(const char *name, struct vg_mesh *m)
{
  struct vg_error err = VG_ERROR_INIT;
  const char *plain = io_temp(name);
  char packed[100], command[4096];

  snprintf(packed, sizeof packed, "field/%s.gz", name);
  snprintf(command, sizeof command, "gzip -dc '%s' > '%s'", io_real(packed),
           plain);
  assert_int_equal(system(command), 0);
  if (vg_surface_read(plain, m, NULL, &err)) fail_msg("%s", err.text);
}

/* A pipe of diameter 0.2, its walls alone. A wrap enters it partly at 0.095. */
static void a_real_pipe_is_not_a_hollow_shell(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_wrap_report r;

  (void)state;
  read_field("pipe_open.stl", &m);
  refuses(&m, 0.02, VG_ERR_GEOMETRY, "would go through");
  refuses(&m, 0.05, VG_ERR_GEOMETRY, "holes are up to 0.198 wide");
  refuses(&m, 0.095, VG_ERR_GEOMETRY, "close_holes yes");
  wrap(&m, 0.2, &r);
  assert_int_equal(is_sound(&m), 1);
  vg_mesh_release(&m);
}

/* Solid 1 is the tunnel, solid 2 the ball. */
static void a_real_ball_stays_in_its_tunnel(void **state)
{
  struct vg_mesh m = VG_MESH_INIT;
  struct vg_error err = VG_ERROR_INIT;
  struct vg_wrap_report r;
  uint8_t *keep;
  struct vg_wrap_options o = { .size = 0.2 };
  size_t n_tunnel = 0, n_ball = 0;

  (void)state;
  read_field("tunnel_ball.stl", &m);
  keep = malloc(m.n_tri);
  for (size_t i = 0; i < m.n_tri; i++) n_tunnel += keep[i] = !m.tri_patch[i];
  o.keep = keep;
  if (vg_wrap(&m, &o, &r, &err)) fail_msg("%s", err.text);
  assert_int_equal(r.n_kept, n_tunnel);
  for (size_t i = 0; i < m.n_tri; i++) n_ball += m.tri_patch[i] == 1;
  assert_int_equal(n_ball + n_tunnel, m.n_tri);
  assert_true(n_ball > 100);
  free(keep);
  vg_mesh_release(&m);
}

/* --- random search ------------------------------------------------------- */

static uint32_t draw(uint32_t *seed, uint32_t n)
{
  *seed = *seed * 1664525u + 1013904223u;
  return (*seed >> 8) % n;
}

static double between(uint32_t *seed, double lo, double hi)
{
  return lo + (hi - lo) * draw(seed, 1u << 16) / 65536.0;
}

/* A box with sides of n x n squares; squares of one side whose both numbers are
 * below `hole` are missing; turned is its orientation. */
static void add_box(struct vg_mesh *m, const double lo[3], const double hi[3],
                    uint32_t n, uint32_t hole, int turned)
{
  size_t patch = vg_mesh_add_patch(m, (int32_t)m->n_patch + 1, "box");
  size_t most = 6 * n * n;

  m->point = realloc(m->point, (m->n_point + 4 * most) * sizeof *m->point);
  m->tri = realloc(m->tri, (m->n_tri + 2 * most) * sizeof *m->tri);
  m->tri_patch = realloc(m->tri_patch,
                         (m->n_tri + 2 * most) * sizeof *m->tri_patch);
  for (uint32_t side = 0; side < 6; side++)
    for (uint32_t i = 0; i < n; i++)
      for (uint32_t j = 0; j < n; j++) {
        uint32_t a = side / 2, at = (uint32_t)m->n_point;
        int flip = turned ^ (side % 2 == 0);

        if (side == 0 && i < hole && j < hole) continue;
        for (uint32_t q = 0; q < 4; q++) {
          double *x = m->point[m->n_point++];
          uint32_t b = (a + 1) % 3, c = (a + 2) % 3;

          x[a] = side % 2 ? hi[a] : lo[a];
          x[b] = lo[b] + (hi[b] - lo[b]) * (i + (q == 1 || q == 2)) / n;
          x[c] = lo[c] + (hi[c] - lo[c]) * (j + (q > 1)) / n;
        }
        for (uint32_t t = 0; t < 2; t++, m->n_tri++) {
          uint32_t v[3] = { at, at + 1 + t, at + 2 + t };

          m->tri[m->n_tri][0] = v[0];
          m->tri[m->n_tri][1] = v[flip ? 2 : 1];
          m->tri[m->n_tri][2] = v[flip ? 1 : 2];
          m->tri_patch[m->n_tri] = (uint32_t)patch;
        }
      }
}

/* One to three boxes: next to each other, intersecting, nested, flat, with
 * holes of any width, either orientation. lo, hi: of the first one, which has
 * the hole. */
static void draw_boxes(struct vg_mesh *m, uint32_t *seed, double lo[3],
                       double hi[3], uint32_t *hole)
{
  uint32_t n = 1 + draw(seed, 3), cells = 2 + draw(seed, 5);

  for (int k = 0; k < 3; k++) {
    lo[k] = 0;
    hi[k] = between(seed, 0.5, 2);
  }
  *hole = draw(seed, 2) ? draw(seed, cells + 1) : 0;
  add_box(m, lo, hi, cells, *hole, (int)draw(seed, 2));
  for (uint32_t i = 1; i < n; i++) {
    double a[3], b[3];

    for (int k = 0; k < 3; k++) {
      a[k] = between(seed, -0.5, 1.5);
      b[k] = a[k] + between(seed, 0.1, 1);
    }
    if (!draw(seed, 4)) b[2] = a[2]; /* no thickness */
    add_box(m, a, b, 1 + draw(seed, 4), 0, (int)draw(seed, 2));
  }
}

/* The middle of the first box is inside the wrap, so that it is not hollow. */
static int encloses_middle(const struct vg_mesh *m, const double lo[3],
                           const double hi[3])
{
  const double x[1][3] = { { (lo[0] + hi[0]) / 2, (lo[1] + hi[1]) / 2,
                             (lo[2] + hi[2]) / 2 } };
  struct vg_error err = VG_ERROR_INIT;
  uint8_t outside;

  if (vg_wrap_outside(m, 1, x, NULL, &outside, &err)) fail_msg("%s", err.text);
  return !outside;
}

static void any_input_is_refused_or_valid(void **state)
{
  size_t n_done = 0, n_refused = 0;

  (void)state;
  for (uint32_t i = 0; i < 120; i++) {
    uint32_t seed = 77 + i, hole;
    struct vg_mesh m = VG_MESH_INIT;
    struct vg_wrap_report r;
    struct vg_error err = VG_ERROR_INIT;
    struct vg_wrap_options o = { .size = 0 };
    double lo[3], hi[3];
    vg_status st;

    draw(&seed, 1);
    draw_boxes(&m, &seed, lo, hi, &hole);
    o.size = between(&seed, 0.08, 0.4);
    st = vg_wrap(&m, &o, &r, &err);
    if (st < 0) {
      /* only open ones are refused, with a remedy */
      assert_int_equal(st, VG_ERR_GEOMETRY);
      if (!hole || !strstr(err.text, "size"))
        fail_msg("case %u: %s", i, err.text);
      n_refused++;
    } else {
      is_sound(&m);
      if (!encloses_middle(&m, lo, hi)) fail_msg("case %u is hollow", i);
      if (r.missing > o.size)
        fail_msg("case %u: input up to %g outside the wrap", i, r.missing);
      n_done++;
    }
    vg_mesh_release(&m);
  }
  print_message("wrapped %zu, refused %zu\n", n_done, n_refused);
  assert_true(n_done > 60 && n_refused > 10);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(crossing_bricks),
    cmocka_unit_test(bodies_inside_others_are_dropped),
    cmocka_unit_test(a_small_hole_is_bridged_a_large_one_refused),
    cmocka_unit_test(covered_rims_are_no_holes),
    cmocka_unit_test(sheets_are_named),
    cmocka_unit_test(shells_that_bound_no_body_are_removed),
    cmocka_unit_test(outer_boundaries_are_kept),
    cmocka_unit_test(bodies_that_leave_the_tunnel_are_refused),
    cmocka_unit_test(progress_has_a_share),
    cmocka_unit_test(suggestions_work),
    cmocka_unit_test(far_points_are_named),
    cmocka_unit_test(walls_do_not_vanish),
    cmocka_unit_test(any_input_is_refused_or_valid),
    cmocka_unit_test(a_real_pipe_is_not_a_hollow_shell),
    cmocka_unit_test(a_real_ball_stays_in_its_tunnel),
    cmocka_unit_test(sharp_edges_are_restored),
    cmocka_unit_test(stops_where_it_is),
    cmocka_unit_test(the_same_twice),
    cmocka_unit_test(invalid_requests_are_refused),
    cmocka_unit_test(real_soups_become_sound),
  };

  return cmocka_run_group_tests(tests, needs_cgal, NULL);
}
