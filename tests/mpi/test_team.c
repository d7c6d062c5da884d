/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Loops over several nodes: every member has all results in the end, for any
 * shape of the arrays. If one member fails, all fail, and none waits forever.
 * Ranks are taken for separate nodes. */
#include "mpi_support.h"

#include "../unit/metric_support.h"

#include "base/comm_parts.h"
#include "base/team.h"
#include "core/sizing/sizing.h"

enum { N = 1000, GRAIN = 8 };

struct all {
  uint32_t begin[N + 1];
  uint16_t item[N];
  uint64_t chunk[N / GRAIN + 1];
  double list[4 * N]; /* item i has i % 4 elements */
  size_t n_done;
};

static int open_nodes(void **state)
{
  return open_job(state) || vg_comm_take_for_nodes(job, 1, NULL) < 0 ? -1 : 0;
}

static void body(void *context, size_t first, size_t end, int worker)
{
  struct all *a = context;

  (void)worker;
  a->chunk[first / GRAIN] = 7 * first + end;
  for (size_t i = first; i < end; i++) {
    a->item[i] = (uint16_t)(3 * i + 1);
    for (uint32_t j = a->begin[i]; j < a->begin[i + 1]; j++)
      a->list[j] = (double)i + 0.25 * (j - a->begin[i]);
    a->n_done++;
  }
}

static struct all *fresh(void)
{
  struct all *a = calloc(1, sizeof *a);

  for (uint32_t i = 0; i < N; i++) a->begin[i + 1] = a->begin[i] + i % 4;
  return a;
}

static vg_status run(struct vg_team *t, struct all *a, size_t n,
                     struct vg_error *err)
{
  const struct vg_team_out out[] = {
    { a->item, sizeof *a->item, 0, NULL },
    { a->chunk, sizeof *a->chunk, GRAIN, NULL },
    { a->list, sizeof *a->list, 0, a->begin }
  };

  return vg_team_for(t, 1, n, GRAIN, body, a, 3, out, err);
}

static void check(const struct all *a, size_t n)
{
  for (size_t i = 0; i < n; i++) {
    size_t end = i / GRAIN * GRAIN + GRAIN;

    assert_int_equal(a->item[i], 3 * i + 1);
    assert_int_equal(a->chunk[i / GRAIN],
                     7 * (i / GRAIN * GRAIN) + (end < n ? end : n));
    for (uint32_t j = a->begin[i]; j < a->begin[i + 1]; j++)
      assert_true(a->list[j] == (double)i + 0.25 * (j - a->begin[i]));
  }
  for (size_t i = n; i < N; i++) assert_int_equal(a->item[i], 0);
}

static void all_members_get_all_results(void **state)
{
  static const size_t n[] = { 0, 1, GRAIN, 259, N - 3, N };
  static const size_t chunk[] = { 1, 100, (size_t)1 << 28 };
  size_t whole = job->chunk;
  struct vg_team *t;

  (void)state;
  assert_int_equal(vg_team_open(job, &t, NULL), VG_OK);
  assert_true((t != NULL) == (vg_comm_size(job) > 1));
  for (size_t c = 0; c < sizeof chunk / sizeof *chunk; c++) {
    job->chunk = chunk[c];
    for (size_t k = 0; k < sizeof n / sizeof *n; k++) {
      struct all *a = fresh();

      assert_int_equal(run(t, a, n[k], NULL), VG_OK);
      check(a, n[k]);
      /* long loops are divided: no member does much more than its share */
      if (n[k] >= N - 3)
        assert_true(a->n_done <= n[k] / (size_t)vg_comm_size(job) + GRAIN);
      free(a);
    }
  }
  job->chunk = whole;
  assert_int_equal(vg_team_close(t, VG_OK, NULL), VG_OK);
}

static struct field_digest field(struct vg_team *t, int threads)
{
  struct vg_sizing_options o = VG_SIZING_OPTIONS_INIT;
  const struct vg_source source[2] = {
    { .kind = VG_SOURCE_LINE,
      .h0 = 0.02,
      .h1 = 0.02,
      .p1 = { 1, 1, 0 },
      .stretch = 8,
      .u = { 1, 1, 0 } },
    { .kind = VG_SOURCE_SPHERE, .h0 = 0.1, .r0 = 0.5, .p0 = { 1, 0, 0 } }
  };
  struct field_digest d;
  struct vg_sizing *s = NULL;

  o.team = t;
  o.threads = threads;
  assert_int_equal(vg_sizing_new(&o, 2, source, NULL, &s, NULL), VG_OK);
  assert_true(vg_sizing_is_stretched(s));
  d = field_digest(s);
  vg_sizing_free(s);
  return d;
}

/* All members build the field of size tensors that one process builds. */
static void a_field_of_tensors_is_the_same(void **state)
{
  struct field_digest own = field(NULL, 1), joint;
  struct vg_team *t;

  (void)state;
  assert_int_equal(vg_team_open(job, &t, NULL), VG_OK);
  joint = field(t, 2);
  assert_int_equal(vg_team_close(t, VG_OK, NULL), VG_OK);
  assert_true(own.n > 100000);
  assert_true(own.n == joint.n && own.sum == joint.sum);
}

static void one_flag_sets_all(void **state)
{
  int last = vg_comm_size(job) - 1, flag = vg_comm_rank(job) == last;
  struct vg_team *t;

  (void)state;
  assert_int_equal(vg_team_open(job, &t, NULL), VG_OK);
  assert_int_equal(vg_team_any(t, &flag, NULL), VG_OK);
  assert_int_equal(flag, 1);
  flag = 0;
  assert_int_equal(vg_team_any(t, &flag, NULL), VG_OK);
  assert_int_equal(flag, 0);
  assert_int_equal(vg_team_close(t, VG_OK, NULL), VG_OK);
}

/* The last member leaves before the loops of the others. */
static void one_failure_fails_the_whole_team(void **state)
{
  struct vg_error err = VG_ERROR_INIT;
  int last = vg_comm_size(job) - 1;
  struct vg_team *t;
  vg_status st;

  (void)state;
  assert_int_equal(vg_team_open(job, &t, NULL), VG_OK);
  if (vg_comm_rank(job) == last) {
    st = vg_fail(&err, VG_ERR_MEMORY, "no room");
  } else {
    struct all *a = fresh();

    st = run(t, a, N, &err);
    assert_int_equal(st, VG_ERR_MEMORY);
    /* and no member waits from then on */
    assert_int_equal(run(t, a, N, NULL), VG_ERR_REMOTE);
    free(a);
  }
  assert_int_equal(vg_team_close(t, st, &err), VG_ERR_MEMORY);
  assert_non_null(strstr(err.text, "no room"));
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(all_members_get_all_results),
    cmocka_unit_test(a_field_of_tensors_is_the_same),
    cmocka_unit_test(one_flag_sets_all),
    cmocka_unit_test(one_failure_fails_the_whole_team),
  };

  return cmocka_run_group_tests(tests, open_nodes, close_job);
}
