/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Outcomes of tasks are kept by all ranks and found by any of them; refusals
 * reach all. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include <ftw.h>
#include <sys/stat.h>
#include <unistd.h>

#include "partition/store/store.h"

#define N_KEY 60

static const struct vg_digest zero = { { 0, 0 } };
static char dir[256];

static int remove_one(const char *path, const struct stat *s, int flag,
                      struct FTW *f)
{
  (void)s;
  (void)flag;
  (void)f;
  return remove(path);
}

/* A separate folder for each number of ranks, as these tests may run at the
 * same time. */
static int open_job_and_clean(void **state)
{
  int bad = open_job(state);

  if (bad) return bad;
  snprintf(dir, sizeof dir, VG_TMP_DIR "/store_run_%d", vg_comm_size(job));
  if (!vg_comm_rank(job)) nftw(dir, remove_one, 16, FTW_DEPTH | FTW_PHYS);
  return vg_comm_agree(job, VG_OK, NULL) < 0;
}

static struct vg_digest key_of(uint64_t k)
{
  return vg_digest_of(zero, sizeof k, &k);
}

static vg_status try_open(uint64_t run, int resume, uint64_t limit,
                          struct vg_store **s, struct vg_error *err)
{
  struct vg_store_options o = { .dir = dir,
                                .job = key_of(run),
                                .what = "a run",
                                .resume = resume,
                                .limit = limit };

  *s = NULL;
  return vg_store_open(job, &o, s, err);
}

static uint64_t sum_of(uint64_t v)
{
  assert_int_equal(vg_comm_sum(job, 1, &v, NULL), VG_OK);
  return v;
}

static void kept_by_one_found_by_all(void **state)
{
  unsigned char data[1000];
  struct vg_store *s;
  struct stat info;
  struct vg_store_report r;

  (void)state;
  assert_int_equal(try_open(1, 0, 0, &s, NULL), VG_OK);
  for (uint64_t k = 0; k < N_KEY; k++) {
    if ((int)k % vg_comm_size(job) != vg_comm_rank(job)) continue;
    memset(data, (int)k, sizeof data);
    vg_store_keep(s, key_of(k), sizeof data, data);
  }
  vg_store_state(s, &r);
  assert_int_equal(sum_of(r.n_kept), N_KEY);
  vg_store_close(s, 0);
  assert_int_equal(try_open(1, 1, 0, &s, NULL), VG_OK);
  for (uint64_t k = 0; k < N_KEY; k++) {
    struct vg_bytes b = { 0, NULL };

    memset(data, (int)k, sizeof data);
    assert_int_equal(vg_store_find(s, key_of(k), &b, NULL), VG_OK);
    assert_int_equal(b.n, sizeof data);
    assert_memory_equal(b.data, data, sizeof data);
    free(b.data);
  }
  vg_store_close(s, 1);
  assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
  assert_int_equal(stat(dir, &info), -1);
}

static void all_ranks_are_refused(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_store *s, *again;

  (void)state;
  assert_int_equal(try_open(1, 1, 0, &s, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "run directory does not exist"));
  assert_int_equal(try_open(1, 0, 0, &s, NULL), VG_OK);
  assert_int_equal(try_open(1, 1, 0, &again, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "another run is using"));
  if (vg_comm_rank(job)) assert_int_equal(strncmp(err.text, "rank 0: ", 8), 0);
  assert_null(again);
  vg_store_keep(s, key_of(9), 3, "abc");
  vg_store_close(s, 0);
  assert_int_equal(try_open(2, 1, 0, &s, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "have changed"));
  assert_int_equal(try_open(1, 1, 0, &s, NULL), VG_OK);
  vg_store_close(s, 1);
}

static void the_limit_applies_to_all_ranks_together(void **state)
{
  static const char data[1000];
  const uint64_t limit = 20000;
  struct vg_store *s;
  struct vg_store_report r;
  uint64_t sum;

  (void)state;
  assert_int_equal(try_open(1, 0, limit, &s, NULL), VG_OK);
  for (uint64_t k = 0; k < 30; k++)
    vg_store_keep(s, key_of(100 * k + (uint64_t)vg_comm_rank(job)), sizeof data,
                  data);
  vg_store_state(s, &r);
  assert_non_null(strstr(r.stopped, "limit of 20000 bytes over all ranks"));
  sum = sum_of(r.bytes_kept);
  /* the unused rest of each rank's share is less than one record */
  assert_true(sum <= limit &&
              sum + 1100u * (unsigned)vg_comm_size(job) > limit);
  vg_store_close(s, 0);
  assert_int_equal(try_open(1, 1, limit, &s, NULL), VG_OK);
  for (uint64_t k = 0; k < 30; k++)
    vg_store_keep(s, key_of(10000 + 100 * k + (uint64_t)vg_comm_rank(job)),
                  sizeof data, data);
  vg_store_state(s, &r);
  assert_true(sum + sum_of(r.bytes_kept) <= limit);
  vg_store_close(s, 1);
}

/* Visible to rank 0 only, as on a local disk of one node. The path of rank 1 is
 * absent, an empty folder, or the directory of another run. */
static void a_directory_of_one_node(void **state)
{
  static const char other[] =
    "vanguard run 1\njob=00112233445566778899aabbccddeeff\nwhat=x\n";
  char run[300], kept[256];

  (void)state;
  if (vg_comm_size(job) < 2) skip();
  for (int k = 0; k < 3; k++) {
    struct vg_error err = VG_ERROR_INIT;
    struct vg_store *s;

    memcpy(kept, dir, sizeof dir);
    if (vg_comm_rank(job) == 1) {
      strcat(dir, "_elsewhere");
      if (k) assert_int_equal(mkdir(dir, 0777), 0);
      snprintf(run, sizeof run, "%s/run.txt", dir);
      if (k == 2) {
        FILE *f = fopen(run, "w");

        assert_non_null(f);
        fputs(other, f);
        assert_int_equal(fclose(f), 0);
      }
    }
    assert_int_equal(try_open(1, 0, 0, &s, &err), VG_ERR_IO);
    assert_non_null(strstr(err.text, "file system that all nodes share"));
    if (vg_comm_rank(job) == 1) {
      if (k == 2) assert_int_equal(unlink(run), 0);
      if (k) assert_int_equal(rmdir(dir), 0);
    }
    memcpy(dir, kept, sizeof dir);
    assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
    assert_int_equal(access(dir, F_OK), -1);
    assert_int_equal(vg_comm_agree(job, VG_OK, NULL), VG_OK);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(kept_by_one_found_by_all),
    cmocka_unit_test(all_ranks_are_refused),
    cmocka_unit_test(the_limit_applies_to_all_ranks_together),
    cmocka_unit_test(a_directory_of_one_node),
  };

  return cmocka_run_group_tests(tests, open_job_and_clean, close_job);
}
