/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The simulation of a timeline on other machines: graphs whose schedules are
 * known. Durations are sums of powers of two, so results are exact unless a
 * tolerance is given. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <math.h>
#include <string.h>
#include <cmocka.h>

#include "partition/model/model.h"

static void add(struct vg_spans *s, const char *path, const char *after,
                double cpu)
{
  struct vg_span one = { .cpu = cpu, .estimate = 1000 * cpu };
  size_t at = strcspn(path, "JPTLR");

  snprintf(one.path, sizeof one.path, "%s", path);
  snprintf(one.after, sizeof one.after, "%s", after);
  one.kind = path[at];
  one.n_cell = (uint64_t)(1000 * cpu);
  assert_int_equal(vg_spans_add(s, &one, NULL), VG_OK);
  s->n_rank = s->n_thread = 1;
}

/* Free messages, so that schedules equal those of textbooks. */
static struct vg_machine machine_of(int ranks, int threads)
{
  struct vg_machine m = VG_MACHINE_INIT;

  m.ranks = ranks;
  m.threads = threads;
  m.latency = 0;
  m.bandwidth = 1e300;
  return m;
}

static struct vg_model_result replay(const struct vg_spans *s,
                                     const struct vg_machine *m,
                                     struct vg_spans *timeline)
{
  struct vg_model_result f;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st = vg_model_replay(s, m, &f, timeline, &err);

  if (st < 0) fail_msg("%s", err.text);
  return f;
}

static struct vg_span *find(struct vg_spans *s, const char *path)
{
  for (size_t i = 0; i < s->n; i++)
    if (!strcmp(s->span[i].path, path)) return &s->span[i];
  fail_msg("no task %s", path);
  return NULL;
}

static void a_chain_takes_the_sum_of_its_tasks(void **state)
{
  struct vg_spans s = VG_SPANS_INIT;

  (void)state;
  add(&s, "0J1", "", 1);
  add(&s, "0P1", "0J1", 2);
  add(&s, "0J2", "0P1", 0.5);
  add(&s, "0L", "0J2", 4);
  for (int ranks = 1; ranks <= 8; ranks *= 2) {
    struct vg_machine m = machine_of(ranks, 2);
    struct vg_model_result f;

    m.serial = 0.25;
    f = replay(&s, &m, NULL);
    assert_true(f.wall == 7.75 && f.work == 7.75 && f.critical == 7.75);
    assert_true(f.speedup == 1 && f.efficiency == 1.0 / (2 * ranks));
    assert_true(f.cuts == 3.5 / 7.5 && f.cuts_wall == 3.5);
    assert_true(f.idle == 1 - 7.5 / (7.5 * 2 * ranks));
  }
  vg_spans_release(&s);
}

static void add_fork_join(struct vg_spans *s, int n)
{
  char path[16];

  add(s, "0J1", "", 1);
  for (int i = 0; i < n; i++) {
    snprintf(path, sizeof path, "0P%d", i);
    add(s, path, "0J1", 2);
  }
  /* The timeline names the pencil that happened to end last. */
  add(s, "0J2", "0P3", 1);
}

static void a_join_waits_for_its_whole_stage(void **state)
{
  static const double wall[] = { 18, 10, 8, 6, 6, 6, 6, 4, 4 };
  struct vg_spans s = VG_SPANS_INIT;

  (void)state;
  add_fork_join(&s, 8);
  for (int n = 1; n <= 9; n++) {
    struct vg_machine m = machine_of(1, n);
    struct vg_model_result f = replay(&s, &m, NULL);

    assert_true(f.wall == wall[n - 1]);
    assert_true(f.work == 18 && f.critical == 4);
    m = machine_of(n, 1);
    assert_true(replay(&s, &m, NULL).wall == wall[n - 1]);
  }
  vg_spans_release(&s);
}

/* Tasks of work 5, 4, 3, 2, 1 are assigned in turn to two workers: 5, 3, 1 and
 * 4, 2, although their times would give another order; and not before the other
 * cut has ended. */
static void leaves_are_assigned_statically(void **state)
{
  static const double cpu[] = { 1, 2, 4, 1, 8 };
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(1, 2);
  struct vg_error err = VG_ERROR_INIT;
  struct vg_model_result f;

  (void)state;
  add(&s, "0J1", "", 1);
  add(&s, "1J1", "", 3);
  for (int i = 0; i < 5; i++) {
    char path[16];

    snprintf(path, sizeof path, "0.%dL", i);
    add(&s, path, "0J1", cpu[i]);
  }
  m.cyclic = 1;
  assert_int_equal(vg_model_replay(&s, &m, &f, NULL, &err), VG_ERR_INPUT);
  assert_non_null(strstr(err.text, "of the trace has no 'work'"));
  for (int i = 0; i < 5; i++) s.span[2 + i].work = 5 - i;
  f = replay(&s, &m, &t);
  assert_true(f.wall == 3 + 1 + 4 + 8);
  assert_true(find(&t, "0.0L")->start == 3 && find(&t, "0.1L")->start == 3);
  assert_true(find(&t, "0.4L")->start == 8 && find(&t, "0.3L")->start == 5);
  assert_int_equal(find(&t, "0.0L")->thread, find(&t, "0.4L")->thread);
  m = machine_of(2, 1);
  m.cyclic = 1;
  assert_true(replay(&s, &m, NULL).wall == 16);
  m.cyclic = 0;
  assert_true(replay(&s, &m, NULL).wall < 16);
  vg_spans_release(&t);
  vg_spans_release(&s);
}

/* Two nodes with one stage each: neither's join waits for the other's pencils,
 * although one task made them all. */
static void stages_are_of_one_node(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(1, 2);

  (void)state;
  add(&s, "0J1", "", 1);
  add(&s, "0.1P1", "0J1", 1);
  add(&s, "0.2P1", "0J1", 8);
  add(&s, "0.1J1", "0.1P1", 1);
  add(&s, "0.2J1", "0.2P1", 1);
  replay(&s, &m, &t);
  assert_true(find(&t, "0.1J1")->start == 2);
  assert_true(find(&t, "0.2J1")->start == 9);
  vg_spans_release(&s);
  vg_spans_release(&t);
}

/* Repairs after a leaf wait for all leaves below their node, and for no
 * other. */
static void repairs_wait_for_the_leaves_below(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(1, 8);

  (void)state;
  add(&s, "0J1", "", 1);
  add(&s, "0.1L", "0J1", 1);
  add(&s, "0.2J1", "0J1", 1);
  add(&s, "0.2.1L", "0.2J1", 8);
  add(&s, "0.2.10L", "0.2J1", 4);
  add(&s, "0.3L", "0J1", 32);
  add(&s, "0.2R1", "0.2.10L", 1);
  add(&s, "0.2.1R1", "0.2.1L", 1);
  add(&s, "0R1", "0.1L", 1);
  add(&s, "0R2", "0R1", 1);
  replay(&s, &m, &t);
  assert_true(find(&t, "0.2R1")->start == 10);
  assert_true(find(&t, "0.2.1R1")->start == 10);
  assert_true(find(&t, "0R1")->start == 33);
  assert_true(find(&t, "0R2")->start == 34);
  vg_spans_release(&s);
  vg_spans_release(&t);
}

/* LPT of 5, 5, 4, 4, 3, 3, 3 on 3 workers: Graham's worst case, 11 where 9 is
 * best: 4/3 - 1/9. */
static void heavier_leaves_go_first(void **state)
{
  static const double cpu[] = { 3, 5, 4, 3, 5, 4, 3 };
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_machine m = machine_of(3, 1);
  struct vg_model_result f;
  char path[16];

  (void)state;
  for (int i = 0; i < 7; i++) {
    snprintf(path, sizeof path, "0.%dL", i);
    add(&s, path, "", cpu[i]);
  }
  f = replay(&s, &m, NULL);
  assert_true(f.wall == 11);
  assert_true(f.critical == 5 && f.work == 27);
  assert_true(f.imbalance == 11.0 / 9);
  m.ranks = 1;
  assert_true(replay(&s, &m, NULL).wall == 27);
  assert_true(replay(&s, &m, NULL).idle == 0);
  vg_spans_release(&s);
}

/* Random numbers without external state, the same everywhere. */
static double drawn(uint32_t *seed)
{
  *seed = *seed * 1664525u + 1013904223u;
  return 1 + (*seed >> 24) / 64.0;
}

/* List schedules: longest chain and mean load as lower bounds, Graham's upper
 * bound. */
static void schedules_keep_the_bounds(void **state)
{
  struct vg_spans s = VG_SPANS_INIT;
  uint32_t seed = 7;
  char path[32], after[32];

  (void)state;
  for (int i = 0; i < 60; i++) {
    snprintf(path, sizeof path, "0.%dJ", i);
    add(&s, path, "", drawn(&seed));
    for (int k = 0; k < 5; k++) {
      snprintf(path, sizeof path, "0.%d.%dL", i, k);
      snprintf(after, sizeof after, "0.%dJ", i);
      add(&s, path, after, drawn(&seed));
    }
  }
  for (int n = 1; n <= 512; n *= 2) {
    struct vg_machine m = machine_of(1, n);
    struct vg_model_result f = replay(&s, &m, NULL);

    assert_true(f.wall >= f.critical && f.wall >= f.work / n);
    assert_true(f.wall <= f.work / n + f.critical);
    assert_true(f.speedup <= n * (1 + 1e-12) && f.efficiency <= 1 + 1e-12);
    assert_true(f.idle >= 0 && f.idle < 1 && f.imbalance >= 1);
  }
  vg_spans_release(&s);
}

/* One tile at home, one away: 1 MB there and 2 MB back at 1 MB/s, a latency of
 * 1/4 s each; no cost within a node. */
static void messages_take_time(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(2, 1);
  struct vg_model_result f;

  (void)state;
  m.bandwidth = 1e6;
  m.latency = 0.25;
  add(&s, "0T1", "", 8);
  add(&s, "0T2", "", 4);
  s.span[1].bytes_in = 1000000;
  s.span[1].bytes_out = 2000000;
  f = replay(&s, &m, &t);
  assert_true(find(&t, "0T1")->rank == 0);
  assert_true(find(&t, "0T2")->rank == 1);
  assert_true(find(&t, "0T2")->start == 1.25);
  assert_true(find(&t, "0T2")->bytes_out == 2000000);
  assert_true(find(&t, "0T1")->bytes_in == 0);
  assert_true(f.wall == 8 && f.bytes == 3e6);
  vg_spans_release(&t);
  s.span[1].cpu = 7.5;
  assert_true(replay(&s, &m, NULL).wall == 1.25 + 7.5 + 2.25);
  m.ranks_per_node = 2;
  assert_true(replay(&s, &m, NULL).wall == 1 + 7.5 + 2);
  vg_spans_release(&s);
}

/* Four inputs leave one rank one after the other. */
static void a_link_is_taken_in_turn(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(5, 1);
  char path[16];

  (void)state;
  m.bandwidth = 1e6;
  add(&s, "0.0L", "", 64);
  for (int i = 1; i <= 4; i++) {
    snprintf(path, sizeof path, "0.%dL", i);
    add(&s, path, "", 16);
    s.span[i].bytes_in = 500000;
  }
  replay(&s, &m, &t);
  for (int i = 1; i <= 4; i++) {
    snprintf(path, sizeof path, "0.%dL", i);
    assert_true(find(&t, path)->start == 0.5 * i);
    assert_true(find(&t, path)->rank == i);
  }
  vg_spans_release(&s);
  vg_spans_release(&t);
}

/* The size of a task that did not travel in the timeline is extrapolated from
 * those that did. */
static void sizes_are_made_up_from_cells(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(3, 1);

  (void)state;
  add(&s, "0P1", "", 8);
  add(&s, "0P2", "", 8);
  add(&s, "0P3", "", 1);
  s.span[1].bytes_in = 40000;
  s.span[1].bytes_out = 400;
  replay(&s, &m, &t);
  assert_true(find(&t, "0P2")->bytes_in == 40000);
  assert_true(find(&t, "0P3")->bytes_in ==
              10000); /* 8 x the cells: 4 x the bytes */
  assert_true(find(&t, "0P3")->bytes_out == 100);
  vg_spans_release(&s);
  vg_spans_release(&t);
}

/* A node stays on the rank where it was started: its pencils return there, its
 * joins stay, and tasks that it creates start anywhere. */
static void nodes_move_and_joins_stay(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(2, 1);

  (void)state;
  add(&s, "0J0", "", 1);
  add(&s, "0.0J0", "0J0", 2);
  add(&s, "0.1J0", "0J0", 2);
  add(&s, "0.1P0", "0.1J0", 4);
  add(&s, "0.1P1", "0.1J0", 1);
  add(&s, "0.1J1", "0.1P1", 1);
  add(&s, "0.1.0L", "0.1J1", 8);
  add(&s, "0.1.1L", "0.1J1", 6);
  for (size_t i = 0; i < s.n; i++) s.span[i].bytes_in = 1;
  replay(&s, &m, &t);
  assert_int_equal(find(&t, "0.0J0")->rank, 0);
  assert_int_equal(find(&t, "0.1J0")->rank, 1);
  assert_int_equal(find(&t, "0.1J0")->home, 0);
  assert_int_equal(find(&t, "0.1P0")->rank, 1);
  assert_int_equal(find(&t, "0.1P1")->rank, 0);
  assert_int_equal(find(&t, "0.1P1")->home, 1);
  assert_int_equal(find(&t, "0.1J1")->rank, 1);
  assert_true(find(&t, "0.1J1")->start == 7);
  assert_int_equal(find(&t, "0.1.0L")->rank, 1);
  assert_int_equal(find(&t, "0.1.1L")->rank, 0);
  vg_spans_release(&t);
  vg_spans_release(&s);
}

/* Joins that wait for one rank are done by priority, while other ranks idle. */
static void joins_wait_for_their_rank(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(4, 1);
  char path[16], maker[16];
  double last = 1e9;

  (void)state;
  add(&s, "0J0", "", 1);
  add(&s, "0T0", "0J0", 8);
  for (int i = 0; i < 8; i++) {
    snprintf(path, sizeof path, "0J%d", i + 1);
    add(&s, path, "0J0", 1);
    s.span[s.n - 1].estimate = 10 * ((i * 3) % 8);
  }
  assert_true(replay(&s, &m, &t).wall == 9);
  for (int e = 0; e < 8; e++)
    for (int i = 0; i < 8; i++) {
      struct vg_span *one;

      snprintf(maker, sizeof maker, "0J%d", i + 1);
      one = find(&t, maker);
      assert_int_equal(one->rank, 0);
      if ((i * 3) % 8 != e) continue;
      assert_true(one->start < last);
      last = one->start;
    }
  vg_spans_release(&t);
  m.joins_roam = 1; /* four at a time, then the tile */
  assert_true(replay(&s, &m, NULL).wall == 11);
  s.span[1].cpu = 1;
  assert_true(replay(&s, &m, NULL).wall == 4);
  vg_spans_release(&s);
}

static void a_faster_core_takes_less(void **state)
{
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_machine m = machine_of(1, 1);
  struct vg_model_result f;

  (void)state;
  add(&s, "0J", "", 2);
  add(&s, "0.1L", "0J", 6);
  m.serial = 2;
  m.rate = 2;
  f = replay(&s, &m, NULL);
  assert_true(f.wall == 5 && f.work == 5 && f.critical == 5);
  assert_true(f.cuts_wall == 1 && f.cuts == 0.25);
  vg_spans_release(&s);
}

/* Of 1 + 8 + 32 s outside the tasks, nodes of two ranks share 8 s and all ranks
 * 32 s. */
static void time_outside_tasks_is_divided(void **state)
{
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_machine m = machine_of(4, 2);
  struct vg_model_result f;

  (void)state;
  add(&s, "0.1L", "", 6);
  m.ranks_per_node = 2;
  m.serial = 1;
  m.by_node = 8;
  m.by_all = 32;
  assert_true(vg_model_outside(&m) == 1 + 2 + 4);
  f = replay(&s, &m, NULL);
  assert_true(f.wall == 13 && f.critical == 13 && f.work == 47);
  m.ranks = m.threads = 1; /* a node has one rank of the two */
  assert_true(vg_model_outside(&m) == 41);
  m.rate = 2;
  assert_true(vg_model_outside(&m) == 20.5);
  vg_spans_release(&s);
}

/* One task of 10 s, 8 of them in loops. */
static void idle_workers_help(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(1, 4);
  struct vg_model_result f;

  (void)state;
  add(&s, "0J0", "", 10);
  s.span[0].loops = 8;
  f = replay(&s, &m, &t); /* 2 + 8 / 4 */
  assert_true(f.wall == 4 && f.critical == 4 && f.cuts_wall == 4);
  assert_true(f.work == 10 && f.speedup == 2.5 && f.cuts == 1);
  assert_true(f.idle == 1 - 10.0 / 16 && f.imbalance == 4 / 2.5);
  assert_true(t.span[0].end == 4 && t.span[0].cpu == 10);
  assert_int_equal(t.n_help, 3);
  for (int i = 0; i < 3; i++) {
    assert_int_equal(t.help[i].thread, i + 1);
    assert_string_equal(t.help[i].path, "0J0");
    assert_true(t.help[i].start == 0 && t.help[i].end == 2);
  }
  assert_true(vg_spans_busy(&t) == 10.0 / 16);
  vg_spans_release(&t);
  m.loop_threads = 2; /* 2 + 8 / 2 */
  f = replay(&s, &m, NULL);
  assert_true(f.wall == 6 && f.critical == 6 && f.imbalance == 6 / 2.5);
  m = machine_of(4, 1); /* other ranks cannot help */
  f = replay(&s, &m, NULL);
  assert_true(f.wall == 10 && f.critical == 10);
  m = machine_of(1, 4);
  m.rate = 2;
  f = replay(&s, &m, NULL);
  assert_true(f.wall == 2 && f.work == 5 && f.critical == 2);
  vg_spans_release(&s);
}

/* Tasks that begin together share the idle workers; tasks in progress count. */
static void help_is_shared(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(1, 6);

  (void)state;
  add(&s, "0J0", "", 1);
  add(&s, "0.0J0", "0J0", 8);
  add(&s, "0.1J0", "0J0", 4);
  add(&s, "0.2J0", "0J0", 1);
  add(&s, "0.2.0J0", "0.2J0", 2);
  add(&s, "0.2.1L", "0.2J0", 16);
  for (size_t i = 0; i < s.n; i++)
    if (s.span[i].kind == 'J') s.span[i].loops = s.span[i].cpu;
  s.span[0].loops = s.span[3].loops = 0;
  s.span[2].loops = 3;
  replay(&s, &m, &t);
  /* at 1: three tasks, two with loops, three idle workers: k = 1 + 3/2 */
  assert_true(find(&t, "0.0J0")->start == 1);
  assert_true(fabs(find(&t, "0.0J0")->end - (1 + 8 / 2.5)) < 1e-12);
  assert_true(fabs(find(&t, "0.1J0")->end - (1 + 1 + 3 / 2.5)) < 1e-12);
  /* at 2: four tasks, three with loops, two idle workers: k = 1 + 2/3 */
  assert_true(find(&t, "0.2.0J0")->start == 2);
  assert_true(fabs(find(&t, "0.2.0J0")->end - (2 + 2 * 3 / 5.)) < 1e-12);
  assert_true(find(&t, "0.2.1L")->end == 18);
  vg_spans_release(&t);
  vg_spans_release(&s);
}

/* A join, a zone of 500 cells in 2 s, two leaves of 4000 cells in 4 s each: in
 * leaves the zone's cells would have taken 0.5 s. */
static void zones_make_cells_too(void **state)
{
  struct vg_spans s = VG_SPANS_INIT;
  struct vg_machine m = machine_of(3, 1);
  struct vg_model_result f;

  (void)state;
  add(&s, "0J0", "", 1);
  add(&s, "0T0", "0J0", 2);
  add(&s, "0J1", "0T0", 1);
  add(&s, "0.0L", "0J1", 4);
  add(&s, "0.1L", "0J1", 4);
  s.span[0].n_cell = s.span[2].n_cell = 0;
  s.span[1].n_cell = 500;
  f = replay(&s, &m, NULL);
  assert_true(fabs(f.cuts - 4. / 12) < 1e-12);
  assert_true(fabs(f.cuts_extra - 3.5 / 12) < 1e-12);
  assert_true(fabs(f.cuts_wall - 4) < 1e-12);
  vg_spans_release(&s);
}

static void an_empty_timeline_takes_no_time(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, t = VG_SPANS_INIT;
  struct vg_machine m = machine_of(2, 2);
  struct vg_model_result f = replay(&s, &m, &t);

  (void)state;
  assert_true(f.wall == 0 && f.speedup == 1 && f.imbalance == 1);
  assert_int_equal(t.n, 0);
  vg_spans_release(&t);
}

/* The order of the timeline does not matter, nor does that of the run. */
static void the_same_record_gives_the_same(void **state)
{
  struct vg_spans s = VG_SPANS_INIT, r = VG_SPANS_INIT;
  struct vg_spans t = VG_SPANS_INIT, u = VG_SPANS_INIT;
  struct vg_machine m = VG_MACHINE_INIT;
  struct vg_model_result f, g;

  (void)state;
  m.ranks = 3;
  m.threads = 2;
  add_fork_join(&s, 50);
  for (size_t i = s.n; i-- > 0;) {
    struct vg_span one = s.span[i];

    one.rank = one.thread = 7;
    one.start = (double)i;
    assert_int_equal(vg_spans_add(&r, &one, NULL), VG_OK);
  }
  f = replay(&s, &m, &t);
  g = replay(&r, &m, &u);
  assert_memory_equal(&f, &g, sizeof f);
  assert_int_equal(t.n, u.n);
  for (size_t i = 0; i < t.n; i++) {
    assert_string_equal(t.span[i].path, u.span[i].path);
    assert_true(t.span[i].start == u.span[i].start);
    assert_int_equal(t.span[i].rank, u.span[i].rank);
    assert_int_equal(t.span[i].thread, u.span[i].thread);
  }
  vg_spans_release(&s);
  vg_spans_release(&r);
  vg_spans_release(&t);
  vg_spans_release(&u);
}

static void refuses(struct vg_spans *s, const struct vg_machine *m,
                    const char *text)
{
  struct vg_model_result f, before;
  struct vg_spans t = VG_SPANS_INIT;
  struct vg_error err = VG_ERROR_INIT;

  memset(&f, 1, sizeof f);
  before = f;
  assert_int_equal(vg_model_replay(s, m, &f, &t, &err), VG_ERR_INPUT);
  if (!strstr(err.text, text)) fail_msg("'%s' lacks '%s'", err.text, text);
  assert_memory_equal(&f, &before, sizeof f);
  assert_null(t.span);
  vg_spans_release(s);
}

static void contradictions_are_named(void **state)
{
  struct vg_machine m = VG_MACHINE_INIT;
  struct vg_spans s = VG_SPANS_INIT;

  (void)state;
  add(&s, "0L", "0J", 1);
  refuses(&s, &m, "'0L' of the trace was created by '0J'");
  add(&s, "0L", "", 1);
  add(&s, "0L", "", 1);
  refuses(&s, &m, "'0L' is in the trace more than once");
  add(&s, "0J", "", 1);
  add(&s, "0.1J", "0.2J", 1);
  add(&s, "0.2J", "0.1J", 1);
  refuses(&s, &m, "comes after itself");
  add(&s, "0L", "0L", 1);
  refuses(&s, &m, "comes after itself");
  /* 0R waits for all leaves below 0, one of which came after it. */
  add(&s, "0.1L", "", 1);
  add(&s, "0R", "0.1L", 1);
  add(&s, "0.2L", "0R", 1);
  refuses(&s, &m, "waits for tasks that wait for it");
  add(&s, "0L", "", -1);
  refuses(&s, &m, "'0L' of the trace took -1 seconds");
  add(&s, "0J", "", 1);
  s.span[0].loops = 1.5;
  refuses(&s, &m, "took 1 seconds, of which 1.5 in loops");
  m.loop_threads = 0;
  refuses(&s, &m, "loops in 0 threads");
  m.loop_threads = 16;
  m.ranks = 0;
  refuses(&s, &m, "0 ranks");
  m.ranks = m.threads = 1 << 16;
  refuses(&s, &m, "cannot be simulated");
  m.ranks = m.threads = 1;
  m.bandwidth = 0;
  refuses(&s, &m, "bandwidth 0");
}

static void cuts_come_before_fills(void **state)
{
  static const char order[] = "JPTLRX";

  (void)state;
  for (int i = 0; i + 1 < 6; i++) {
    assert_true(vg_model_priority(order[i], 0) >
                vg_model_priority(order[i + 1], 1e11));
    assert_true(vg_model_priority(order[i], 10) >
                vg_model_priority(order[i], 9));
    assert_true(vg_model_priority(order[i], -1) ==
                vg_model_priority(order[i], 0));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(a_chain_takes_the_sum_of_its_tasks),
    cmocka_unit_test(a_join_waits_for_its_whole_stage),
    cmocka_unit_test(stages_are_of_one_node),
    cmocka_unit_test(repairs_wait_for_the_leaves_below),
    cmocka_unit_test(heavier_leaves_go_first),
    cmocka_unit_test(schedules_keep_the_bounds),
    cmocka_unit_test(messages_take_time),
    cmocka_unit_test(a_link_is_taken_in_turn),
    cmocka_unit_test(sizes_are_made_up_from_cells),
    cmocka_unit_test(nodes_move_and_joins_stay),
    cmocka_unit_test(joins_wait_for_their_rank),
    cmocka_unit_test(a_faster_core_takes_less),
    cmocka_unit_test(time_outside_tasks_is_divided),
    cmocka_unit_test(idle_workers_help),
    cmocka_unit_test(help_is_shared),
    cmocka_unit_test(zones_make_cells_too),
    cmocka_unit_test(an_empty_timeline_takes_no_time),
    cmocka_unit_test(the_same_record_gives_the_same),
    cmocka_unit_test(contradictions_are_named),
    cmocka_unit_test(leaves_are_assigned_statically),
    cmocka_unit_test(cuts_come_before_fills),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
