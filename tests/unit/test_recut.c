/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Subdomains that cannot be filled are filled together with their
 * neighbours. */
#define _GNU_SOURCE
#include "advance_support.h"

#include <pthread.h>

#include "base/child.h"
#include "partition/cut/node.h"

/* --- fronts -------------------------------------------------------------- */

/* Two cells on one triangle, in the points of one piece or of two. */
static struct vg_piece piece_of(size_t n_cell, const uint32_t (*cell)[4])
{
  static const double x[5][3] = {
    { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, -1 }
  };
  struct vg_piece q = { .serial = 7, .n_in = 5, .n_cell = n_cell };

  q.in = vg_alloc(5, sizeof *q.in);
  q.x = vg_alloc(5, sizeof *q.x);
  assert_true(q.in && q.x);
  assert_int_equal(vg_packed_cells_new(n_cell, cell, 5, &q.cell), 0);
  for (uint32_t k = 0; k < 5; k++) q.in[k] = VG_POINT_ID(3, 9 - k);
  memcpy(q.x, x, sizeof x);
  return q;
}

/* The boundary of cells is the same for one piece and for two pieces in either
 * order. */
static void boundary_of_cells_is_independent_of_pieces(void **state)
{
  static const uint32_t cell[2][4] = { { 0, 1, 2, 3 }, { 0, 2, 1, 4 } };
  struct vg_piece both = piece_of(2, cell);
  const struct vg_doubled none = { .first = NULL };
  struct vg_front whole = VG_FRONT_INIT;

  (void)state;
  assert_int_equal(vg_recut_front(&none, &both, &whole, NULL), VG_OK);
  assert_int_equal(whole.n_face, 6);
  assert_int_equal(whole.n_point, 5);
  assert_true(fabs(vg_front_volume(&whole) - 1. / 6 - 1. / 6) < 1e-12);
  for (int k = 0; k < 2; k++) {
    struct vg_piece one = piece_of(1, &cell[k]), two = piece_of(1, &cell[!k]);
    struct vg_front f = VG_FRONT_INIT, g = VG_FRONT_INIT;

    assert_int_equal(vg_recut_front(&none, &one, &f, NULL), VG_OK);
    assert_int_equal(vg_recut_front(&none, &two, &g, NULL), VG_OK);
    assert_int_equal(f.n_face + g.n_face, 8);
    assert_int_equal(f.n_point + g.n_point, 8);
    assert_int_equal(vg_front_join(&f, &g, NULL), VG_OK);
    assert_int_equal(vg_front_weld(&f, NULL), VG_OK);
    assert_int_equal(vg_recut_settle(&none, &f, NULL), VG_OK);
    assert_int_equal(f.n_face, whole.n_face);
    assert_int_equal(f.n_point, whole.n_point);
    assert_memory_equal(f.x, whole.x, 5 * sizeof *f.x);
    assert_memory_equal(f.id, whole.id, 5 * sizeof *f.id);
    assert_memory_equal(f.face, whole.face, 6 * sizeof *f.face);
    vg_front_release(&f);
    vg_front_release(&g);
    vg_piece_release(&one);
    vg_piece_release(&two);
  }
  assert_int_equal(vg_front_join(&whole, &whole, NULL), VG_OK);
  assert_int_equal(vg_front_weld(&whole, NULL), VG_OK);
  assert_int_equal(vg_recut_settle(&none, &whole, NULL), VG_ERR_GEOMETRY);
  vg_front_release(&whole);
  vg_piece_release(&both);
}

/* --- whole runs ---------------------------------------------------------- */

/* A valid mesh, the same in any order, in threads, and after a resume. Returns
 * the report. */
static struct vg_partition_report always(const struct scene *s, double share,
                                         int rounds)
{
  const char *dir = VG_TMP_DIR "/redo_run";
  struct vg_partition_options o = options_of(2000, 1, 0);
  struct vg_partition_report first, r;
  struct mesh_digest expect, d;

  o.fail_leaves = share;
  o.fail_rounds = rounds;
  expect = run_of(NULL, s, &o, 1, &first);
  remove_folder(dir);
  o.threads = 3;
  o.job = job_digest(1);
  for (int resume = 0; resume < 2; resume++) {
    o.shuffle = resume ? 5 : 77;
    assert_int_equal(open_store(NULL, dir, 1, resume, &o.store, NULL), VG_OK);
    d = run_of(NULL, s, &o, 0, &r);
    same_digest(&expect, &d);
    assert_int_equal(r.n_widened, first.n_widened);
    assert_int_equal(r.n_widened_cell, first.n_widened_cell);
    assert_int_equal(r.n_zone_cell, first.n_zone_cell);
    if (resume) assert_true(r.n_found > 0);
    vg_store_close(o.store, resume);
  }
  return first;
}

/* A subdomain that fails costs its neighbours; one that fails twice costs the
 * neighbours of those too. */
static void only_neighbours_are_refilled(void **state)
{
  uint64_t before = 0;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  for (int rounds = 1; rounds <= 3; rounds++) {
    struct vg_partition_report r = always(&s, 0.04, rounds);

    print_message("%d rounds: %d voids, %d cells replaced\n", rounds,
                  (int)r.n_widened, (int)r.n_widened_cell);
    /* Two leaves fail by their paths, 0.0.0.1.0 and 0.1.1.0.1. Both share faces
     * with the zone of the first plane, so the first round joins them to one
     * void. That void keeps the path of the first leaf and therefore fails
     * again in every round but the last: each round makes one void. */
    assert_int_equal(r.n_widened, rounds);
    assert_true(r.n_widened_cell > before);
    assert_true(r.n_widened_cell < (rounds == 1 ? 8000 : 20000));
    before = r.n_widened_cell;
  }
  scene_end(&s);
}

static void parts_that_meet_are_one(void **state)
{
  struct vg_partition_report r;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  r = always(&s, 0.3, 1);
  assert_true(r.n_widened > 0 && r.n_widened < 8);
  r = always(&s, 1, 1);
  assert_int_equal(r.n_widened, 1);
  scene_end(&s);
}

static void leaves_that_always_fail(void **state)
{
  struct vg_partition_options o = options_of(2000, 2, 0);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_partition_report r;
  struct vg_partition *p = NULL;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  o.fail_leaves = 0.04;
  o.fail_rounds = 1000;
  assert_int_equal(vg_partition_grow(NULL, &s.m, s.sizing, &o, &p, &r, NULL,
                                     &err),
                   VG_ERR_GEOMETRY);
  assert_null(p);
  assert_non_null(strstr(err.text, "requested for a test"));
  scene_end(&s);
}

/* The timeline continues after the first tasks; cells that were made in vain do
 * not appear in it. */
static void the_timeline_covers_all_rounds(void **state)
{
  struct vg_partition_options o = options_of(2000, 2, 0);
  struct vg_spans spans = VG_SPANS_INIT;
  struct vg_partition_report r;
  struct vg_partition *p;
  struct scene s;
  uint64_t n_cell = 0, n_mesh, n_again = 0;

  (void)state;
  scene_demo(&s, "box", 40000);
  o.fail_leaves = 0.04;
  o.fail_rounds = 2;
  assert_int_equal(vg_partition_grow(NULL, &s.m, s.sizing, &o, &p, &r, &spans,
                                     NULL),
                   VG_OK);
  for (size_t k = 0; k < spans.n; k++) {
    const struct vg_span *t = &spans.span[k];

    assert_true(t->start >= 0 && t->end <= spans.wall);
    if (t->kind == VG_SPAN_REPAIR) continue;
    n_cell += t->n_cell;
    n_again += strchr(t->path, '~') != NULL;
  }
  n_mesh = vg_partition_slices(p)->n_cell[VG_SLICE_TET];
  assert_true(n_cell > 0.99 * n_mesh && n_cell < 1.01 * n_mesh); /* repairs */
  assert_int_equal(n_again, 2);
  vg_spans_release(&spans);
  vg_partition_free(p);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(boundary_of_cells_is_independent_of_pieces),
    cmocka_unit_test(only_neighbours_are_refilled),
    cmocka_unit_test(parts_that_meet_are_one),
    cmocka_unit_test(leaves_that_always_fail),
    cmocka_unit_test(the_timeline_covers_all_rounds),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
