/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Voids decomposed before they are filled, by all ranks: the mesh equals that
 * of a single rank; also stopped and resumed elsewhere, and with subdomains
 * that cannot be filled. */
#define _GNU_SOURCE
#include "digest_support.h"

#include "base/child.h"
#include "partition/discrete/discrete.h"

static char dir[4096];

static int set_up(void **state)
{
  if (open_job(state)) return -1;
  snprintf(dir, sizeof dir, "%s/decomposition_run_%d", VG_TMP_DIR,
           vg_comm_size(job));
  return 0;
}

static int is_first(void)
{
  return vg_comm_rank(job) == 0;
}

static struct vg_partition_options options(int n_part, int threads,
                                           uint64_t shuffle)
{
  struct vg_partition_options o = options_of(3000, threads, shuffle);

  o.maker = vg_discrete_part;
  o.decomposition.n_part = n_part;
  return o;
}

/* The digest of rank 0's own mesh, broadcast to all. */
static struct mesh_digest alone(const struct scene *s,
                                const struct vg_partition_options *o)
{
  struct vg_partition_report r;
  struct mesh_digest d = { 0 };

  if (is_first()) d = run_of(NULL, s, o, 0, &r);
  return tell(&d);
}

static void compare(const struct scene *s, double fail)
{
  struct vg_partition_options o = options(9, 1, 0);
  struct mesh_digest expect, d;
  struct vg_partition_report r;

  o.fail_leaves = fail;
  o.fail_rounds = 1; /* with more rounds, all may become one void */
  expect = alone(s, &o);
  for (int threads = 1; threads < 3; threads++) {
    o.threads = threads;
    o.shuffle = threads == 2 ? 77 : 0;
    d = run_of(job, s, &o, threads == 2, &r);
    same_digest(&expect, &d);
    assert_true(r.n_part >= 9 && r.decomposition.n_face > 0);
    assert_true(!fail == !r.n_widened);
  }
}

static void as_one_rank_makes_it(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "sphere", 20000);
  compare(&s, 0);
  compare(&s, 0.3);
  scene_end(&s);
}

/* --- run directories ----------------------------------------------------- */

static struct vg_store *store_of(int resume)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_store *s;

  if (open_store(job, dir, 1, resume, &s, &err) != VG_OK)
    fail_msg("%s", err.text);
  return s;
}

static void clean(void)
{
  if (is_first()) remove_folder(dir);
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
}

static void stopped_and_resumed(void **state)
{
  struct vg_partition_options o = options(9, 1, 0);
  struct vg_partition_report r;
  struct vg_partition *p;
  struct stopper stopper;
  struct mesh_digest expect, d;
  struct scene s;

  (void)state;
  scene_demo(&s, "sphere", 20000);
  expect = alone(&s, &o);
  clean();
  stopper = (struct stopper){ store_of(0), 2 };
  o.store = stopper.store;
  o.job = job_digest(1);
  o.stop = (struct vg_stop){ stop_after, &stopper };
  assert_int_equal(grow(job, &s, &o, &p, &r, NULL), VG_ERR_STOPPED);
  vg_store_close(stopper.store, 0);
  o = options(9, 2, 3);
  o.store = store_of(1);
  o.job = job_digest(1);
  d = run_of(job, &s, &o, 0, &r);
  same_digest(&expect, &d);
  assert_true(r.n_found >= 2); /* the decomposition, and a leaf */
  vg_store_close(o.store, 1);
  clean();
  scene_end(&s);
}

/* The coarse mesh is made by all ranks, so all learn why it fails. */
static void all_ranks_learn_of_the_failure(void **state)
{
  static const struct {
    int parts, hole;
    const char *why;
  } what[] = {
    { 1000000, 0, "request fewer subdomains" },
    { 4500, 0, "a smaller coarsening" },
    { 6, 1, "coarse mesh" },
  };

  (void)state;
  for (size_t k = 0; k < sizeof what / sizeof *what; k++) {
    struct vg_partition_options o = options(what[k].parts, 2, 0);
    struct vg_partition_report r;
    struct vg_partition *p;
    struct vg_error err = VG_ERROR_INIT;
    struct scene s;
    uint64_t n;

    scene_demo(&s, "box", 5000);
    s.m.n_tri -= (size_t)what[k].hole;
    n = grow(job, &s, &o, &p, &r, &err) < 0 &&
        strstr(err.text, what[k].why) != NULL;
    assert_null(p);
    if (!n) fail_msg("%zu: %s", k, err.text);
    assert_int_equal(vg_comm_sum(job, 1, &n, NULL), VG_OK);
    assert_int_equal(n, vg_comm_size(job));
    s.m.n_tri += (size_t)what[k].hole;
    scene_end(&s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(as_one_rank_makes_it),
    cmocka_unit_test(stopped_and_resumed),
    cmocka_unit_test(all_ranks_learn_of_the_failure),
  };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, set_up, close_job);
}
