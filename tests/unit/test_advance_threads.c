/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Voids cut and filled in threads: the same mesh for any number of threads and
 * any order. Also run under the thread sanitizer. */
#define _GNU_SOURCE
#include "advance_support.h"

#include "base/child.h"

static void any_number_in_any_order(void **state)
{
  static const struct {
    const char *name;
    size_t n;
    double leaf;
  } cut[] = { { "box", 8000, 700 }, { "sphere", 15000, 3000 } };
  static const uint64_t shuffle[] = { 5, 77 };

  (void)state;
  for (int c = 0; c < 2; c++) {
    struct vg_partition_options o = options_of(cut[c].leaf, 1, 0);
    struct vg_partition_report first, r;
    struct mesh_digest expect;
    struct scene s;

    scene_demo(&s, cut[c].name, cut[c].n);
    expect = run_of(NULL, &s, &o, 1, &first);
    assert_true(first.n_node > 0 && first.n_leaf > 4 && first.n_tile > 2);
    for (int k = 0; k < 2; k++) {
      struct mesh_digest d;

      o.threads = 3 - k;
      o.shuffle = shuffle[k];
      d = run_of(NULL, &s, &o, 0, &r);
      same_digest(&expect, &d);
      assert_int_equal(r.n_node, first.n_node);
      assert_int_equal(n_task(&r), n_task(&first));
      assert_int_equal(r.n_zone_cell, first.n_zone_cell);
    }
    scene_end(&s);
  }
}

/* Threads that keep and find records concurrently, and a stop among them. The
 * run is long enough for the stop request, which is polled every 20 ms, to
 * arrive in the middle of it. */
static void stopped_and_resumed(void **state)
{
  const char *dir = VG_TMP_DIR "/advance_threads_run";
  struct vg_partition_options o = options_of(2000, 2, 0);
  struct vg_partition_report r;
  struct vg_partition *p;
  struct vg_store *store;
  struct mesh_digest expect, d;
  struct stopper stopper;
  struct scene s;

  (void)state;
  remove_folder(dir);
  scene_demo(&s, "box", 60000);
  expect = run_of(NULL, &s, &o, 0, &r);
  assert_int_equal(open_store(NULL, dir, 1, 0, &store, NULL), VG_OK);
  stopper = (struct stopper){ store, 3 };
  o.job = job_digest(1);
  o.store = store;
  o.stop = (struct vg_stop){ stop_after, &stopper };
  assert_int_equal(grow(NULL, &s, &o, &p, &r, NULL), VG_ERR_STOPPED);
  assert_null(p);
  vg_store_close(store, 0);
  assert_int_equal(open_store(NULL, dir, 1, 1, &store, NULL), VG_OK);
  o.store = store;
  o.stop = (struct vg_stop){ NULL, NULL };
  o.threads = 3;
  o.shuffle = 5;
  d = run_of(NULL, &s, &o, 0, &r);
  same_digest(&expect, &d);
  assert_true(r.n_found >= 3 && r.n_found < n_task(&r));
  vg_store_close(store, 1);
  scene_end(&s);
}

/* The thread sanitizer's allocator does not survive a fork while threads run,
 * so TetGen's child processes come from a server, as in the program. */
int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(any_number_in_any_order),
    cmocka_unit_test(stopped_and_resumed),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, NULL, NULL);
}
