/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Voids decomposed into octants and filled by all ranks: the mesh equals that
 * of a single rank, and that of a run begun on another number of ranks. */
#define _GNU_SOURCE
#include "digest_support.h"

#include "base/child.h"
#include "partition/octree/octree.h"

static char dir[4096];

static int set_up(void **state)
{
  if (open_job(state)) return -1;
  snprintf(dir, sizeof dir, "%s/octree_run_%d", VG_TMP_DIR, vg_comm_size(job));
  return 0;
}

static int is_first(void)
{
  return vg_comm_rank(job) == 0;
}

static struct vg_partition_options parted(int partitioner, int threads,
                                          uint64_t shuffle)
{
  struct vg_partition_options o = options_of(300000, threads, shuffle);

  o.maker = vg_octree_part;
  o.decomposition.n_part = 8;
  o.decomposition.partitioner = partitioner;
  return o;
}

static struct mesh_digest run(struct vg_comm *comm, const struct scene *s,
                              const struct vg_partition_options *o, int judge,
                              struct vg_partition_report *r)
{
  struct vg_partition *p;
  struct vg_error err = VG_ERROR_INIT;
  struct mesh_digest d;

  if (grow(comm, s, o, &p, r, &err) != VG_OK) fail_msg("%s", err.text);
  d = digest_of(comm, vg_partition_slices(p), &s->m);
  if (judge) check_mesh(comm, s, p);
  vg_partition_free(p);
  return d;
}

/* The digest of rank 0's own mesh, broadcast to all. */
static struct mesh_digest alone(const struct scene *s,
                                const struct vg_partition_options *o)
{
  struct vg_partition_report r;
  struct mesh_digest d = { 0 };

  if (is_first()) d = run(NULL, s, o, 1, &r);
  return tell(&d);
}

/* Octants, and a gap region that is cut by planes: both occur. */
static void as_one_rank_makes_it(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "sphere", 120000);
  for (int partitioner = 0; partitioner < 2; partitioner++) {
    struct vg_partition_options o = parted(partitioner, 1, 0);
    struct mesh_digest expect = alone(&s, &o), d;
    struct vg_partition_report r;

    o = parted(partitioner, 2, 5);
    d = run(job, &s, &o, 1, &r);
    same_digest(&expect, &d);
    assert_true(r.n_leaf > 5 && r.n_tile > 0);
  }
  scene_end(&s);
}

static struct vg_store *store_of(struct vg_comm *comm, int resume)
{
  struct vg_store *s;
  struct vg_error err = VG_ERROR_INIT;

  if (open_store(comm, dir, 1, resume, &s, &err) != VG_OK)
    fail_msg("%s", err.text);
  return s;
}

static void resumed_elsewhere(void **state)
{
  struct vg_partition_options o = parted(VG_PARTITIONER_METIS, 1, 0);
  struct mesh_digest expect, d;
  struct vg_partition_report r;
  struct vg_partition *p;
  struct scene s;
  struct stopper stopper = { NULL, 2 };

  (void)state;
  scene_demo(&s, "sphere", 60000);
  expect = alone(&s, &o);
  if (is_first()) {
    remove_folder(dir);
    o.store = stopper.store = store_of(NULL, 0);
    o.job = job_digest(1);
    o.stop = (struct vg_stop){ stop_after, &stopper };
    assert_int_equal(grow(NULL, &s, &o, &p, &r, NULL), VG_ERR_STOPPED);
    vg_store_close(o.store, 0);
  }
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
  o = parted(VG_PARTITIONER_METIS, 2, 7);
  o.store = store_of(job, 1);
  o.job = job_digest(1);
  d = run(job, &s, &o, 0, &r);
  same_digest(&expect, &d);
  assert_true(r.n_found >= 2);
  vg_store_close(o.store, 1);
  if (is_first()) remove_folder(dir);
  scene_end(&s);
}

static void all_ranks_learn_of_the_failure(void **state)
{
  struct vg_partition_options o = parted(VG_PARTITIONER_METIS, 2, 0);
  struct vg_partition_report r;
  struct vg_partition *p;
  struct vg_error err = VG_ERROR_INIT;
  struct scene s;
  uint64_t n;

  (void)state;
  scene_demo(&s, "box", 20000);
  o.decomposition.coarsening = 1.5;
  n = grow(job, &s, &o, &p, &r, &err) == VG_ERR_INPUT;
  assert_null(p);
  assert_non_null(strstr(err.text, "coarsening of 1.5"));
  assert_int_equal(vg_comm_sum(job, 1, &n, NULL), VG_OK);
  assert_int_equal(n, vg_comm_size(job));
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(as_one_rank_makes_it),
    cmocka_unit_test(resumed_elsewhere),
    cmocka_unit_test(all_ranks_learn_of_the_failure),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, set_up, close_job);
}
