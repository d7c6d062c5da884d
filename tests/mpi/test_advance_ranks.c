/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Voids cut and filled by all ranks: the mesh equals that of a single rank;
 * every rank learns of stops and failures; runs are resumed on other numbers of
 * ranks. */
#define _GNU_SOURCE
#include "digest_support.h"

#include "base/child.h"
#include "io/slices/slices.h"

static char dir[4096], alone_stem[4096], all_stem[4096];
static struct scene real; /* read before the job begins; may be empty */

/* Names for this job: tests on other numbers of ranks run at the same time. */
static int set_up(void **state)
{
  int size;

  if (open_job(state)) return -1;
  size = vg_comm_size(job);
  snprintf(dir, sizeof dir, "%s/advance_run_%d", VG_TMP_DIR, size);
  snprintf(alone_stem, sizeof dir, "%s/advance_alone_%d", VG_TMP_DIR, size);
  snprintf(all_stem, sizeof dir, "%s/advance_all_%d", VG_TMP_DIR, size);
  return 0;
}

static int is_first(void)
{
  return vg_comm_rank(job) == 0;
}

/* The mesh that rank 0 makes alone, in one thread. */
static struct mesh_digest alone(const struct scene *s,
                                const struct vg_partition_options *o)
{
  struct vg_partition_report r;
  struct mesh_digest d = { 0 };

  if (is_first()) d = run_of(NULL, s, o, 0, &r);
  return tell(&d);
}

static void compare_with(const struct scene *s, struct vg_partition_options o,
                         int n_way)
{
  static const struct {
    int threads;
    uint64_t shuffle;
  } way[] = { { 1, 0 }, { 2, 5 }, { 3, 77 } };
  struct mesh_digest expect = alone(s, &o), d;
  struct vg_partition_report r;

  for (int w = 0; w < n_way; w++) {
    o.threads = way[w].threads;
    o.shuffle = way[w].shuffle;
    d = run_of(job, s, &o, w == n_way - 1, &r);
    same_digest(&expect, &d);
    assert_true(r.n_node > 0 && r.n_leaf > 4);
  }
}

static void compare(const struct scene *s, double leaf, int n_way)
{
  compare_with(s, options_of(leaf, 1, 0), n_way);
}

static void as_one_rank_makes_it(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 30000);
  compare(&s, 2000, 3);
  scene_end(&s);
  scene_demo(&s, "sphere", 20000);
  compare(&s, 3000, 2);
  scene_end(&s);
}

static void overloaded_leaves(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 80000);
  compare_with(&s, surprise_of(4000), 2);
  scene_end(&s);
}

static void a_wing(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "wing-half", 0);
  compare(&s, 40000, 1);
  scene_end(&s);
}

static void a_real_surface(void **state)
{
  (void)state;
  if (!real.m.n_tri) {
    print_message("VG_DATA_DIR has no simple/: skipped (verification/fetch.md "
                  "has the sources)\n");
    skip();
  }
  compare(&real, 5000, 1);
}

static void the_same_file(void **state)
{
  struct vg_partition_options o = options_of(3000, 1, 0);
  struct vg_partition_report r;
  struct vg_partition *p;
  struct scene s;
  char path[2][4200];

  (void)state;
  scene_demo(&s, "sphere", 20000);
  for (int all = 0; all < 2; all++) {
    struct vg_comm *comm = all ? job : NULL;
    const char *stem = all ? all_stem : alone_stem;

    snprintf(path[all], sizeof path[all], "%s.lb8.ugrid", stem);
    if (!all && !is_first()) continue;
    assert_int_equal(grow(comm, &s, &o, &p, &r, NULL), VG_OK);
    assert_int_equal(vg_slices_write(comm, vg_partition_slices(p), stem,
                                     "lb8.ugrid", 1, NULL),
                     VG_OK);
    vg_partition_free(p);
    o.threads = 2;
    o.shuffle = 3;
  }
  if (is_first()) {
    size_t n[2];
    unsigned char *data[2] = { io_slurp(path[0], &n[0]),
                               io_slurp(path[1], &n[1]) };

    assert_int_equal(n[0], n[1]);
    assert_memory_equal(data[0], data[1], n[0]);
    free(data[0]);
    free(data[1]);
    remove(path[0]);
    remove(path[1]);
  }
  scene_end(&s);
}

/* --- run directories ----------------------------------------------------- */

static struct vg_store *store_of(struct vg_comm *comm, int resume)
{
  struct vg_store *s;
  struct vg_error err = VG_ERROR_INIT;

  if (open_store(comm, dir, 1, resume, &s, &err) != VG_OK)
    fail_msg("%s", err.text);
  return s;
}

static void clean(void)
{
  if (is_first()) remove_folder(dir);
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
}

/* One run that is stopped by its last rank. */
static void stopped(struct vg_comm *comm, const struct scene *s, double leaf)
{
  struct vg_partition_options o = options_of(leaf, 1, 0);
  struct vg_partition_report r;
  struct vg_partition *p;
  struct stopper stopper = { store_of(comm, 0), 1 };

  o.store = stopper.store;
  o.job = job_digest(1);
  if (vg_comm_rank(comm) == vg_comm_size(comm) - 1)
    o.stop = (struct vg_stop){ stop_after, &stopper };
  assert_int_equal(grow(comm, s, &o, &p, &r, NULL), VG_ERR_STOPPED);
  assert_null(p);
  vg_store_close(stopper.store, 0);
}

/* One run that continues. Returns the number of tasks found in the
 * directory. */
static uint64_t resumed(struct vg_comm *comm, const struct scene *s,
                        double leaf, const struct mesh_digest *expect, int last)
{
  struct vg_partition_options o = options_of(leaf, 2, 5);
  struct vg_partition_report r;
  struct mesh_digest d;

  o.store = store_of(comm, 1);
  o.job = job_digest(1);
  d = run_of(comm, s, &o, 0, &r);
  same_digest(expect, &d);
  if (last) assert_int_equal(r.n_found, n_task(&r));
  vg_store_close(o.store, last);
  return r.n_found;
}

static void resumed_elsewhere(void **state)
{
  const double leaf = 3000;
  const struct vg_partition_options o = options_of(leaf, 1, 0);
  struct mesh_digest expect;
  struct scene s;

  (void)state;
  scene_demo(&s, "sphere", 40000);
  expect = alone(&s, &o);
  clean();
  stopped(job, &s, leaf);
  if (is_first()) assert_true(resumed(NULL, &s, leaf, &expect, 0) > 0);
  clean();
  if (is_first()) stopped(NULL, &s, leaf);
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
  assert_true(resumed(job, &s, leaf, &expect, 0) > 0);
  resumed(job, &s, leaf, &expect, 1);
  clean();
  scene_end(&s);
}

/* --- failures ------------------------------------------------------------ */

static void same_everywhere(vg_status st, vg_status expect)
{
  uint64_t n = st == expect;

  assert_int_equal(vg_comm_sum(job, 1, &n, NULL), VG_OK);
  assert_int_equal(n, vg_comm_size(job));
}

static void refused(const struct scene *s, const struct vg_partition_options *o,
                    vg_status expect)
{
  struct vg_partition_report r;
  struct vg_partition *p;
  struct vg_error err = VG_ERROR_INIT;

  same_everywhere(grow(job, s, o, &p, &r, &err), expect);
  assert_null(p);
  if (expect < 0) assert_true(strlen(err.text) > 0);
}

static int at_once(void *user)
{
  (void)user;
  return 1;
}

static void all_ranks_learn_of_the_failure(void **state)
{
  struct vg_partition_options o = options_of(2000, 2, 0), few = o, stop = o;
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  few.max_cells = 1000;
  refused(&s, &few, VG_ERR_UNSUPPORTED);
  few.max_cells =
    35000; /* below the actual number, but above half of it: noticed late */
  refused(&s, &few, VG_ERR_UNSUPPORTED);
  if (vg_comm_rank(job) == vg_comm_size(job) - 1) stop.stop.ask = at_once;
  refused(&s, &stop, VG_ERR_STOPPED);
  scene_turn(&s.m);
  refused(&s, &o, VG_ERR_GEOMETRY);
  scene_turn(&s.m);
  s.m.n_tri--;
  for (o.shuffle = 0; o.shuffle < 3; o.shuffle++)
    refused(&s, &o, VG_ERR_GEOMETRY);
  s.m.n_tri++;
  scene_end(&s);
}

/* Files are unpacked by a child process, which may disturb MPI. */
static void read_real(void)
{
  static const char name[] = "simple/hemisphere_cylinder_farfield.lb8.ugrid.xz";

  if (!*VG_DATA_DIR || access(VG_DATA_DIR "/simple", R_OK)) return;
  scene_file(&real, io_real(name));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(as_one_rank_makes_it),
    cmocka_unit_test(overloaded_leaves),
    cmocka_unit_test(a_wing),
    cmocka_unit_test(a_real_surface),
    cmocka_unit_test(the_same_file),
    cmocka_unit_test(resumed_elsewhere),
    cmocka_unit_test(all_ranks_learn_of_the_failure),
  };
  int bad;

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  read_real();
  bad = cmocka_run_group_tests(tests, set_up, close_job);
  if (real.m.n_tri) scene_end(&real);
  return bad;
}
