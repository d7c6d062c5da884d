/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Subdomains that cannot be filled: any number of ranks gives the result of
 * one. */
#define _GNU_SOURCE
#include "digest_support.h"

#include "base/child.h"

static void as_on_one(const struct scene *s, double share, int rounds)
{
  struct vg_partition_options o = options_of(2000, 1, 0);
  struct vg_partition_report r;
  struct mesh_digest expect = { 0 }, d;

  o.fail_leaves = share;
  o.fail_rounds = rounds;
  if (vg_comm_rank(job) == 0) expect = run_of(NULL, s, &o, 0, &r);
  expect = tell(&expect);
  for (o.shuffle = 0; o.shuffle < 3; o.shuffle++) {
    o.threads = 1 + (int)o.shuffle % 2;
    d = run_of(job, s, &o, o.shuffle == 2, &r);
    same_digest(&expect, &d);
    assert_true(r.n_widened > 0 && r.n_widened_cell > 0);
  }
}

static void as_one_rank_makes_it(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  as_on_one(&s, 0.04, 2);
  as_on_one(&s, 0.3, 1);
  as_on_one(&s, 1, 1);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(as_one_rank_makes_it) };

  if (vg_child_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, open_job, close_job);
}
