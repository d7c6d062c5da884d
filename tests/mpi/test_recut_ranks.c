/* Voids that are cut elsewhere: on any number of ranks as on one. */
#define _GNU_SOURCE
#include "mpi_support.h"

#include "../unit/advance_support.h"
#include "../unit/refuse_support.h"
#include "core/recover/cdt_server.h"

static struct mesh_digest tell(const struct mesh_digest *d)
{
  struct vg_bytes b = { sizeof *d, NULL };
  struct mesh_digest out;

  b.data = vg_calloc(1, sizeof *d);
  assert_non_null(b.data);
  if (vg_comm_rank(job) == 0) memcpy(b.data, d, sizeof *d);
  assert_int_equal(vg_comm_bcast(job, 0, &b, NULL), VG_OK);
  memcpy(&out, b.data, sizeof out);
  free(b.data);
  return out;
}

/* Voids cut elsewhere, and attempts to cut the whole, on all ranks. */
static void as_on_one(const struct scene *s, uint64_t n_void, int attempts)
{
  struct vg_partition_options o = options_of(2000, 1, 0);
  struct vg_partition_report r;
  struct mesh_digest expect = {0}, d;

  if (vg_comm_rank(job) == 0) expect = run_of(NULL, s, &o, 0, &r);
  expect = tell(&expect);
  for (o.shuffle = 0; o.shuffle < 3; o.shuffle++) {
    o.threads = 1 + (int)o.shuffle % 2;
    d = run_of(job, s, &o, o.shuffle == 2, &r);
    same_digest(&expect, &d);
    assert_int_equal(r.cuts_elsewhere, attempts);
    if (!attempts) assert_int_equal(r.n_elsewhere, n_void);
    if (!attempts) assert_true(r.n_elsewhere_cell > 1000);
  }
}

static void as_one_rank_makes_it(void **state)
{
  struct scene s;

  (void)state;
  scene_demo(&s, "box", 40000);
  n_refusal = 1;
  refusal[0] = refuse_twice;
  as_on_one(&s, 2, 0);
  refusal[0] = refuse_often;
  as_on_one(&s, 0, 1);
  n_refusal = 2;
  refusal[0] = refuse_once;
  refusal[1] = refuse_once_too;
  as_on_one(&s, 2, 0);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = { cmocka_unit_test(as_one_rank_makes_it) };

  if (vg_cdt_server_start(NULL) != VG_OK) return 1;
  return cmocka_run_group_tests(tests, open_job, close_job);
}
