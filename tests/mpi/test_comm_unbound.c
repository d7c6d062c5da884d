/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Ranks that the launcher does not bind share the cores of the node. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include "base/parallel.h"

static void cores_are_divided(void **state)
{
  int size = vg_comm_size(job), all = vg_comm_node_cores(job, 0);
  int mine = vg_comm_default_threads(job);
  uint64_t n = (uint64_t)mine;

  (void)state;
  assert_in_range(all, 1, vg_cores());
  assert_int_equal(vg_comm_node_cores(job, 1), all);
  assert_int_equal(mine, all / size > 1 ? all / size : 1);
  assert_int_equal(vg_comm_sum(job, 1, &n, NULL), VG_OK);
  assert_true(n <= (uint64_t)(all > size ? all : size));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(cores_are_divided),
  };

  return RUN_IN_JOB(tests);
}
