/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A job of one rank, without a launcher. With a launcher:
 * tests/mpi/test_comm_*.c. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "base/comm.h"
#include "base/parallel.h"

/* The test itself may run in a job. */
static int forget_launcher(void **state)
{
  static const char *const name[] = { "OMPI_COMM_WORLD_SIZE",
                                      "PMI_SIZE",
                                      "PMI_RANK",
                                      "PMIX_RANK",
                                      "SLURM_STEP_ID",
                                      "SLURM_PROCID",
                                      "SLURM_STEP_NUM_TASKS" };

  (void)state;
  for (size_t i = 0; i < sizeof name / sizeof *name; i++) unsetenv(name[i]);
  return 0;
}

static void alone(void **state)
{
  int dummy;
  struct vg_comm *c = (struct vg_comm *)&dummy;

  (void)state;
  assert_int_equal(vg_comm_open(&c, NULL), VG_OK);
  assert_null(c);
  assert_int_equal(vg_comm_rank(c), 0);
  assert_int_equal(vg_comm_size(c), 1);
  assert_int_equal(vg_comm_node_rank(c), 0);
  assert_int_equal(vg_comm_node_size(c), 1);
  assert_null(vg_comm_mpi(c));
  vg_comm_close(c);
}

static void collectives(void **state)
{
  unsigned char data[] = "bytes";
  struct vg_bytes mine = { 5, data }, out = { 0, NULL }, none = { 0, NULL };
  struct vg_error err = { VG_ERR_IO, "disk" };
  uint64_t sum[2] = { 3, UINT64_MAX };
  double max = -1;

  (void)state;
  assert_int_equal(vg_comm_sum(NULL, 2, sum, NULL), VG_OK);
  assert_true(sum[0] == 3 && sum[1] == UINT64_MAX);
  assert_int_equal(vg_comm_max(NULL, 1, &max, NULL), VG_OK);
  assert_true(max == -1);
  assert_int_equal(vg_comm_bcast(NULL, 0, &mine, NULL), VG_OK);
  assert_int_equal(vg_comm_node_bcast(NULL, &mine, NULL), VG_OK);
  assert_ptr_equal(mine.data, data);
  assert_int_equal(vg_comm_allgather(NULL, &mine, &out, NULL), VG_OK);
  assert_int_equal(out.n, 5);
  assert_memory_equal(out.data, "bytes", 5);
  free(out.data);
  assert_int_equal(vg_comm_exchange(NULL, &none, &out, NULL), VG_OK);
  assert_int_equal(out.n, 0);
  free(out.data);
  assert_int_equal(vg_comm_agree(NULL, VG_OK, NULL), VG_OK);
  assert_int_equal(vg_comm_agree(NULL, VG_BLOCKED, NULL), VG_BLOCKED);
  assert_int_equal(vg_comm_agree(NULL, VG_ERR_IO, &err), VG_ERR_IO);
  assert_string_equal(err.text, "disk");
}

static void messages_need_ranks(void **state)
{
  struct vg_bytes b = { 0, NULL };
  struct vg_message m;

  (void)state;
  assert_int_equal(vg_comm_post(NULL, 0, 1, &b, NULL), VG_ERR_UNSUPPORTED);
  assert_int_equal(vg_comm_poll(NULL, &m, NULL), VG_ERR_UNSUPPORTED);
}

static void cores(void **state)
{
  int n = vg_comm_default_threads(NULL);

  (void)state;
  assert_in_range(n, 1, vg_cores());
  assert_int_equal(vg_comm_node_cores(NULL, 1), n);
  assert_int_equal(vg_comm_node_cores(NULL, 0), n);
}

/* Each process would assume that it is alone, and all would write the same
 * files. */
static void unconnected_processes_are_refused(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_comm *c = NULL;

  (void)state;
  setenv("SLURM_STEP_ID", "0", 1);
  setenv("SLURM_PROCID", "1", 1);
  setenv("SLURM_STEP_NUM_TASKS", "3", 1);
  assert_int_equal(vg_comm_open(&c, &err), VG_ERR_UNSUPPORTED);
  assert_non_null(strstr(err.text, "srun started 3 processes"));
  setenv("SLURM_STEP_NUM_TASKS", "1", 1);
  assert_int_equal(vg_comm_open(&c, &err), VG_OK);
  assert_null(c);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test_setup(alone, forget_launcher),
    cmocka_unit_test(collectives),
    cmocka_unit_test(messages_need_ranks),
    cmocka_unit_test(cores),
    cmocka_unit_test_setup(unconnected_processes_are_refused, forget_launcher),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
