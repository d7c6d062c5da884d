/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Repairs on any number of ranks and threads make the same cells. */
#include "mpi_support.h"

#include "../unit/repair_support.h"

static struct vg_digest repaired(struct vg_comm *comm, int threads, int zones,
                                 int stretch,
                                 struct vg_partition_report *report)
{
  struct vg_digest d;
  struct scene s;

  scene_new(&s, 16, 6, 6);
  scene_shake(&s, 0.45, 7);
  if (stretch > 1) scene_stretch(&s, stretch);
  scene_cut(&s, comm, threads);
  if (zones) scene_zones(&s);
  assert_int_equal(vg_partition_repair(&s.p, comm, NULL, NULL), VG_OK);
  d = scene_digest(&s, comm);
  *report = s.p.report;
  scene_end(&s);
  return d;
}

static void same_as_alone(int zones, int stretch)
{
  struct vg_partition_report one, all;
  struct vg_digest want = repaired(NULL, 1, zones, stretch, &one);

  assert_true(one.n_repaired > 0);
  assert_int_equal(one.n_repair_moved > 0, zones);
  for (int threads = 1; threads <= 3; threads += 2) {
    struct vg_digest got = repaired(job, threads, zones, stretch, &all);

    assert_memory_equal(&got, &want, sizeof want);
    assert_int_equal(all.n_repair_moved, one.n_repair_moved);
    assert_int_equal(all.n_repair, one.n_repair);
    assert_int_equal(all.n_repaired, one.n_repaired);
    assert_int_equal(all.n_repair_cell, one.n_repair_cell);
    assert_int_equal(all.n_repair_bad, one.n_repair_bad);
    assert_int_equal(all.n_repair_bad_left, one.n_repair_bad_left);
    assert_true(all.repair_worst == one.repair_worst);
    assert_true(all.repair_worst_left == one.repair_worst_left);
  }
}

static void test_same_as_alone(void **state)
{
  (void)state;
  same_as_alone(0, 1);
}

static void test_zones_as_alone(void **state)
{
  (void)state;
  same_as_alone(1, 1);
}

static void test_metric_as_alone(void **state)
{
  (void)state;
  same_as_alone(0, 12);
  same_as_alone(1, 12);
}

/* In the timeline each task belongs to the rank that ran it, and follows the
 * earlier entries. */
static void test_recorded(void **state)
{
  struct vg_spans spans = { .n_rank = vg_comm_size(job),
                            .n_thread = 1,
                            .wall = 3 };
  int done[64] = { 0 };
  struct scene s;

  (void)state;
  scene_new(&s, 16, 6, 6);
  scene_shake(&s, 0.45, 7);
  scene_cut(&s, job, 1);
  scene_zones(&s);
  assert_int_equal(vg_partition_repair(&s.p, job, &spans, NULL), VG_OK);
  for (size_t i = 0; i < spans.n; i++) {
    const struct vg_span *t = &spans.span[i];

    assert_in_range(t->rank, 0, spans.n_rank - 1);
    assert_int_equal(t->home, t->rank);
    assert_true(t->start >= 3 && t->start <= t->end && t->end <= spans.wall);
    done[t->rank]++;
  }
  for (int r = 0; r < spans.n_rank && r < s.p.size && r < 64; r++)
    assert_int_equal(done[r] > 0, r == s.p.rank || !s.p.rank);
  vg_spans_release(&spans);
  scene_end(&s);
}

/* Ranks without any piece take part. */
static void test_empty(void **state)
{
  struct scene s;

  (void)state;
  scene_new(&s, 4, 2, 2);
  s.p.rank = vg_comm_rank(job);
  s.p.size = vg_comm_size(job);
  s.p.sizing = s.sizing;
  s.p.options.threads = 1;
  pthread_mutex_init(&s.p.lock, NULL);
  assert_int_equal(vg_partition_repair(&s.p, job, NULL, NULL), VG_OK);
  assert_int_equal(s.p.report.n_repair, 0);
  scene_end(&s);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_same_as_alone),
    cmocka_unit_test(test_zones_as_alone),
    cmocka_unit_test(test_metric_as_alone),
    cmocka_unit_test(test_recorded),
    cmocka_unit_test(test_empty),
  };

  return RUN_IN_JOB(tests);
}
