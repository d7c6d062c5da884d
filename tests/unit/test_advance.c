/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The advancing partition on one rank: rules, records, refusals, and voids that
 * turn out larger than expected. */
#define _GNU_SOURCE
#include "advance_support.h"

#include "base/child.h"
#include "fill_support.h"

/* --- without cuts the result is that of the fill ------------------------- */

static void as_filled(const struct scene *s, double leaf)
{
  struct vg_partition_options o = options_of(leaf, 2, 0);
  struct vg_fill_options fill_options = VG_FILL_OPTIONS_INIT;
  struct vg_fill_report fill_report = { 0 };
  struct vg_mesh mesh = VG_MESH_INIT, fill = VG_MESH_INIT;
  struct vg_partition_report r;
  struct vg_partition *p;

  assert_int_equal(fill_mesh(&s->m, s->sizing, &fill_options, &fill,
                             &fill_report, NULL),
                   VG_OK);
  assert_int_equal(grow(NULL, s, &o, &p, &r, NULL), VG_OK);
  assert_int_equal(r.n_leaf, 1);
  assert_int_equal(r.n_node + r.n_pencil + r.n_tile + r.n_outgrown, 0);
  assert_int_equal(vg_slices_collect(vg_partition_slices(p), 2, &mesh, NULL),
                   VG_OK);
  assert_int_equal(mesh.n_point, fill.n_point);
  assert_int_equal(mesh.n_tet, fill.n_tet);
  assert_int_equal(mesh.n_tri, fill.n_tri);
  assert_memory_equal(mesh.point, fill.point,
                      fill.n_point * sizeof *fill.point);
  assert_memory_equal(mesh.tet, fill.tet, fill.n_tet * sizeof *fill.tet);
  assert_memory_equal(mesh.tri, fill.tri, fill.n_tri * sizeof *fill.tri);
  assert_int_equal(r.fill.n_inserted, fill_report.n_inserted);
  vg_partition_free(p);
  vg_mesh_release(&mesh);
  vg_mesh_release(&fill);
}

static void a_void_without_cuts_equals_the_fill(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 20000);
  as_filled(&s, 1e9);
  as_filled(&s, 0); /* by number of bisections, which is 0 */
  scene_end(&s);
  scene_demo(&s, "sphere", 20000);
  as_filled(&s, 1e9);
  scene_end(&s);
}

/* --- any order ----------------------------------------------------------- */

static struct vg_partition_report same_in_any_order(const struct scene *s,
                                                    double leaf, int more)
{
  static const uint64_t shuffle[] = { 5, 77 };
  struct vg_partition_options o = options_of(leaf, 1, 0);
  struct vg_partition_report first, r;
  struct mesh_digest expect = run_of(NULL, s, &o, 1, &first);

  assert_true(first.n_node > 1);
  assert_int_equal(first.n_uncut, 0);
  for (int k = 0; k < more; k++) {
    struct mesh_digest d;

    o.threads = 3 - k;
    o.shuffle = shuffle[k];
    d = run_of(NULL, s, &o, 0, &r);
    same_digest(&expect, &d);
  }
  return first;
}

static void several_generations(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  same_in_any_order(&s, 2000, 2);
  scene_end(&s);
  scene_demo(&s, "sphere", 40000);
  same_in_any_order(&s, 3000, 2);
  scene_end(&s);
}

/* Its surface alone requires 290,000 cells. */
static void around_a_wing(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "wing-half", 0);
  same_in_any_order(&s, 40000, 1);
  scene_end(&s);
}

static void real_surface(void **state)
{
  struct scene s;

  (void)state;
  scene_file(&s, io_real("simple/hemisphere_cylinder_farfield.lb8.ugrid.xz"));
  same_in_any_order(&s, 5000, 1);
  scene_end(&s);
}

/* --- rules --------------------------------------------------------------- */

/* Leaves with more cells than small components have. */
static size_t large_leaves(const struct vg_partition *p, double least)
{
  uint64_t *size;
  size_t n, large = 0;

  assert_int_equal(vg_partition_leaves(p, &n, &size, NULL), VG_OK);
  for (size_t i = 0; i < n; i++) large += (double)size[i] >= least;
  free(size);
  return large;
}

/* Uniform spacing: bisections halve the cells, and separator zones take some of
 * them. Therefore leaves are similar; a small component is far below a quarter
 * of the mean. */
static void levels_double_the_leaves(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 60000);
  for (int level = 1; level <= 5; level++) {
    struct vg_partition_options o = options_of(0, 2, 0);
    struct vg_partition_report r;
    struct vg_partition *p;
    struct vg_error err = VG_ERROR_INIT;
    double mean;

    o.levels = level;
    if (grow(NULL, &s, &o, &p, &r, &err) != VG_OK) fail_msg("%s", err.text);
    mean = (double)(vg_partition_slices(p)->n_cell[VG_SLICE_TET] -
                    r.n_zone_cell) /
           (1 << level);
    assert_int_equal(large_leaves(p, 0.25 * mean), 1 << level);
    assert_true(r.n_leaf <= (2u << level));
    assert_int_equal(r.n_outgrown, 0);
    check_mesh(NULL, &s, p);
    vg_partition_free(p);
  }
  scene_end(&s);
}

/* The least extent, over all large leaves, of a leaf's cells along an axis. */
static double least_extent(const struct vg_partition *p, int axis, size_t least)
{
  const struct vg_slices *s = vg_partition_slices(p);
  double narrow = INFINITY;

  for (size_t i = 0; i < s->n_slice; i++) {
    struct vg_slice slice;
    double lo = INFINITY, hi = -INFINITY;

    assert_int_equal(s->get(s, i, &slice, NULL), VG_OK);
    for (size_t k = 0; k < slice.n_point; k++) {
      lo = fmin(lo, slice.x[k][axis]);
      hi = fmax(hi, slice.x[k][axis]);
    }
    if (slice.kind == 1 && slice.n_cell[VG_SLICE_TET] >= least)
      narrow = fmin(narrow, hi - lo);
    s->put(s, &slice);
  }
  return narrow;
}

/* The box is 1 wide. If it is cut across one axis only, leaves reach from wall
 * to wall along the two other axes; two bisections leave about a quarter along
 * the first. */
static void directions_are_respected(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 60000);
  for (int axis = 0; axis < 3; axis++)
    for (int constant = 0; constant < 2; constant++) {
      struct vg_partition_options o = options_of(0, 2, 0);
      struct vg_partition_report r;
      struct vg_partition *p;

      o.rule.first_axis = axis;
      o.rule.constant = constant;
      o.levels = constant ? 2 : 1;
      assert_int_equal(grow(NULL, &s, &o, &p, &r, NULL), VG_OK);
      assert_int_equal(large_leaves(p, 2000), 1 << o.levels);
      for (int k = 0; k < 3; k++) {
        double extent = least_extent(p, k, 2000);

        if (k == axis) assert_true(extent < (constant ? 0.35 : 0.6));
        else assert_true(extent > 1 - 1e-12);
      }
      vg_partition_free(p);
    }
  scene_end(&s);
}

/* --- records ------------------------------------------------------------- */

static void everything_is_found_again(void **state)
{
  const char *dir = VG_TMP_DIR "/advance_run";
  struct vg_partition_options o = options_of(4000, 2, 0);
  struct vg_partition_report r, again;
  struct vg_error err = VG_ERROR_INIT;
  struct mesh_digest expect, d;
  struct vg_store *store;
  struct scene s;

  (void)state;
  remove_folder(dir);
  scene_demo(&s, "sphere", 40000);
  expect = run_of(NULL, &s, &o, 0, &r);
  assert_int_equal(open_store(NULL, dir, 1, 0, &store, NULL), VG_OK);
  o.store = store;
  o.job = job_digest(1);
  d = run_of(NULL, &s, &o, 0, &r);
  same_digest(&expect, &d);
  assert_int_equal(r.n_found, 0);
  vg_store_close(store, 0);
  assert_int_equal(open_store(NULL, dir, 1, 1, &store, NULL), VG_OK);
  o.store = store;
  o.threads = 1;
  o.shuffle = 9;
  d = run_of(NULL, &s, &o, 1, &again);
  same_digest(&expect, &d);
  assert_int_equal(n_task(&again), n_task(&r));
  assert_int_equal(again.n_found, n_task(&again));
  assert_int_equal(again.n_zone_cell, r.n_zone_cell);
  assert_int_equal(again.n_blocked, r.n_blocked);
  /* the same folder, another sizing field or other options */
  o.job = job_digest(2);
  run_of(NULL, &s, &o, 0, &again);
  assert_int_equal(again.n_found, 0);
  vg_store_close(store, 0);
  assert_int_equal(open_store(NULL, dir, 2, 1, &store, &err), VG_ERR_INPUT);
  assert_null(store);
  assert_true(strlen(err.text) > 0);
  remove_folder(dir);
  scene_end(&s);
}

/* Leaves that exceed their estimate are cut again, in any order; nothing is
 * kept of their first attempts. */
static void overloaded_leaves(void **state)
{
  const char *dir = VG_TMP_DIR "/advance_outgrown";
  struct vg_partition_options o = surprise_of(4000);
  struct vg_partition_report first, r;
  struct mesh_digest expect, d;
  struct scene s;

  (void)state;
  remove_folder(dir);
  scene_demo(&s, "box", 80000);
  expect = run_of(NULL, &s, &o, 1, &first);
  assert_true(first.n_outgrown > 0);
  assert_true((double)expect.n_cell > 1.5 * first.estimate);
  o.threads = 3;
  o.shuffle = 5;
  o.job = job_digest(1);
  for (int resume = 0; resume < 2; resume++) {
    assert_int_equal(open_store(NULL, dir, 1, resume, &o.store, NULL), VG_OK);
    d = run_of(NULL, &s, &o, 0, &r);
    same_digest(&expect, &d);
    assert_int_equal(r.n_outgrown, first.n_outgrown);
    assert_int_equal(n_task(&r), n_task(&first));
    assert_int_equal(r.n_found, resume ? n_task(&r) : 0);
    vg_store_close(o.store, resume);
  }
  scene_end(&s);
}

/* --- refusals ------------------------------------------------------------ */

static void too_many_cells(void **state)
{
  struct vg_partition_options o = options_of(4000, 2, 0);
  struct vg_partition_report r;
  struct vg_partition *p;
  struct vg_error err = VG_ERROR_INIT;
  struct mesh_digest d;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 20000);
  o.max_cells = 1000; /* detected before anything is made */
  assert_int_equal(grow(NULL, &s, &o, &p, &r, &err), VG_ERR_UNSUPPORTED);
  assert_null(p);
  assert_int_equal(r.n_leaf + r.n_node, 0);
  assert_non_null(strstr(err.text, "1000"));
  assert_non_null(strstr(err.text, "coarser"));
  o.max_cells = 0;
  d = run_of(NULL, &s, &o, 0, &r);
  o.max_cells = d.n_cell - 1; /* detected at the end */
  assert_int_equal(grow(NULL, &s, &o, &p, &r, &err), VG_ERR_UNSUPPORTED);
  assert_null(p);
  o.max_cells = d.n_cell;
  run_of(NULL, &s, &o, 0, &r);
  o.max_cells = d.n_cell + 99; /* all that the layers leave */
  o.layer_cells = 100;
  assert_int_equal(grow(NULL, &s, &o, &p, &r, &err), VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "100 of them in layers"));
  o.layer_cells = 99;
  run_of(NULL, &s, &o, 0, &r);
  scene_end(&s);
}

/* Failed subdomains are extended until they have no neighbours. */
static void refused(const struct scene *s, double leaf, int cuts)
{
  for (uint64_t shuffle = 0; shuffle < 2; shuffle++) {
    struct vg_partition_options o = options_of(leaf, 2, shuffle);
    struct vg_partition_report r;
    struct vg_partition *p;
    struct vg_error err = VG_ERROR_INIT;

    assert_int_equal(grow(NULL, s, &o, &p, &r, &err), VG_ERR_GEOMETRY);
    assert_null(p);
    assert_true(strlen(err.text) > 0);
    assert_true(!cuts == !r.n_widened);
  }
}

static void fronts_that_bound_nothing(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 20000);
  scene_turn(&s.m);
  refused(&s, 4000, 0);
  refused(&s, 1e9, 0);
  scene_turn(&s.m);
  s.m.n_tri--; /* a hole */
  refused(&s, 4000, 1);
  refused(&s, 1e9, 0);
  s.m.n_tri++;
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_void_without_cuts_equals_the_fill),
    cmocka_unit_test(several_generations),
    cmocka_unit_test(around_a_wing),
    cmocka_unit_test(real_surface),
    cmocka_unit_test(levels_double_the_leaves),
    cmocka_unit_test(directions_are_respected),
    cmocka_unit_test(everything_is_found_again),
    cmocka_unit_test(overloaded_leaves),
    cmocka_unit_test(too_many_cells),
    cmocka_unit_test(fronts_that_bound_nothing),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
