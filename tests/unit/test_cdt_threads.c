/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* TetGen's child processes come from a server: the answers equal those in
 * place, from several threads at once, and even if the server is killed. */
#define _GNU_SOURCE
#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/parallel.h"
#include "base/child.h"
#include "base/helper/helper.h"
#include "core/recover/cdt_tetgen.h"

#define N_JOB 3
#define N_MAX 4000

/* --- jobs ---------------------------------------------------------------- */

struct batch {
  struct vg_cdt_job job[N_JOB];
  double x[N_JOB][N_MAX][3];
};

/* Points in a cube and one triangle; the second job has another triangle that
 * intersects it, which makes TetGen fail. */
static struct batch *batch_new(uint64_t seed, size_t n)
{
  static const double at[6][3] = { { 0, 0, 0 },     { 1, 0, 0 },
                                   { 0, 1, 0 },     { 0.2, 0.2, -1 },
                                   { 0.3, 0.3, 1 }, { 2, 2, 0.5 } };
  static const uint32_t tri[2][3] = { { 0, 1, 2 }, { 3, 4, 5 } };
  struct batch *b = calloc(1, sizeof *b);

  assert_non_null(b);
  for (int k = 0; k < N_JOB; k++) {
    memcpy(b->x[k], at, sizeof at);
    for (size_t i = 6; i < n; i++)
      for (int axis = 0; axis < 3; axis++) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        b->x[k][i][axis] = 2 + (double)(seed >> 40) / (1 << 24);
      }
    b->job[k] = (struct vg_cdt_job){ .n = n,
                                     .n_tri = 1 + (k == 1),
                                     .tri = tri,
                                     .x = (const double(*)[3])b->x[k] };
  }
  return b;
}

static void batch_free(struct batch *b)
{
  for (int k = 0; k < N_JOB; k++) {
    free(b->job[k].all);
    free(b->job[k].tet);
  }
  free(b);
}

static int batches_differ(const struct batch *a, const struct batch *b)
{
  for (int k = 0; k < N_JOB; k++) {
    const struct vg_cdt_job *p = &a->job[k], *q = &b->job[k];

    if (p->st != q->st || p->n_all != q->n_all || p->n_tet != q->n_tet)
      return 1;
    if (p->st != VG_OK) continue;
    if (memcmp(p->all, q->all, p->n_all * sizeof *p->all) ||
        memcmp(p->tet, q->tet, p->n_tet * sizeof *p->tet))
      return 1;
  }
  return 0;
}

/* In place if there is no server, which the callers ensure. */
static struct batch *answered(uint64_t seed, size_t n)
{
  struct batch *b = batch_new(seed, n);

  assert_int_equal(vg_cdt_tetgen(N_JOB, b->job, NULL), VG_OK);
  for (int k = 0; k < N_JOB; k++)
    assert_int_equal(b->job[k].st, k == 1 ? VG_ERR_GEOMETRY : VG_OK);
  return b;
}

/* --- processes ----------------------------------------------------------- */

static pid_t parent_of(const char *pid)
{
  char path[300], text[512];
  const char *after;
  FILE *f;
  size_t n;

  snprintf(path, sizeof path, "/proc/%s/stat", pid);
  f = fopen(path, "r");
  if (!f) return -1;
  n = fread(text, 1, sizeof text - 1, f);
  text[n] = 0;
  fclose(f);
  after = strrchr(text, ')');
  return after ? (pid_t)strtol(after + 3, NULL, 10) : -1;
}

static pid_t child_of(pid_t parent)
{
  DIR *d = opendir("/proc");
  struct dirent *e;
  pid_t found = 0;

  assert_non_null(d);
  while (!found && (e = readdir(d)))
    if (e->d_name[0] >= '1' && e->d_name[0] <= '9' &&
        parent_of(e->d_name) == parent)
      found = (pid_t)strtol(e->d_name, NULL, 10);
  closedir(d);
  return found;
}

static void no_child_is_left(void)
{
  assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
  assert_int_equal(errno, ECHILD);
}

/* --- tests --------------------------------------------------------------- */

static void the_same_as_in_place(void **state)
{
  struct batch *a = answered(1, 200), *b;

  (void)state;
  assert_int_equal(vg_child_server_is_alive(), 0);
  assert_int_equal(vg_child_server_start(NULL), VG_OK);
  assert_int_equal(vg_child_server_start(NULL), VG_OK);
  assert_int_equal(vg_child_server_is_alive(), 1);
  b = answered(1, 200);
  assert_int_equal(batches_differ(a, b), 0);
  batch_free(b);
  vg_child_server_stop();
  vg_child_server_stop();
  assert_int_equal(vg_child_server_is_alive(), 0);
  no_child_is_left();
  b = answered(1, 200);
  assert_int_equal(batches_differ(a, b), 0);
  batch_free(a);
  batch_free(b);
}

#define N_CALL 40

struct crowd {
  struct batch *b[N_CALL];
  vg_status st[N_CALL];
};

static void call(void *context, size_t first, size_t end, int worker)
{
  struct crowd *c = context;

  (void)worker;
  for (size_t i = first; i < end; i++)
    c->st[i] = vg_cdt_tetgen(N_JOB, c->b[i]->job, NULL);
}

static void several_threads_at_once(void **state)
{
  struct crowd c;
  struct batch *a[4];

  (void)state;
  for (int k = 0; k < 4; k++) a[k] = answered((uint64_t)k, 100);
  for (size_t i = 0; i < N_CALL; i++) c.b[i] = batch_new(i % 4, 100);
  assert_int_equal(vg_child_server_start(NULL), VG_OK);
  vg_parallel_for(4, N_CALL, 1, call, &c);
  assert_int_equal(vg_child_server_is_alive(), 1);
  vg_child_server_stop();
  for (size_t i = 0; i < N_CALL; i++) {
    assert_int_equal(c.st[i], VG_OK);
    assert_int_equal(batches_differ(c.b[i], a[i % 4]), 0);
    batch_free(c.b[i]);
  }
  for (int k = 0; k < 4; k++) batch_free(a[k]);
  no_child_is_left();
}

struct blow {
  pid_t pid;
  useconds_t after_us;
};

static void *strike(void *argument)
{
  struct blow *b = argument;

  usleep(b->after_us);
  kill(b->pid, SIGKILL);
  return NULL;
}

/* Killed before a call, between its jobs, and in the middle of a job (a batch
 * of this size takes about 100 ms). */
static void a_server_killed_at_any_time(void **state)
{
  struct batch *a = answered(7, N_MAX), *b;

  (void)state;
  for (useconds_t us = 0; us < 120000; us += 12000) {
    struct blow blow = { .after_us = us };
    pthread_t thread;

    assert_int_equal(vg_child_server_start(NULL), VG_OK);
    blow.pid = child_of(getpid());
    assert_true(blow.pid > 0);
    assert_int_equal(pthread_create(&thread, NULL, strike, &blow), 0);
    if (!us) pthread_join(thread, NULL);
    b = answered(7, N_MAX);
    if (us) pthread_join(thread, NULL);
    assert_int_equal(batches_differ(a, b), 0);
    batch_free(b);
    for (int k = 0; k < 1000 && vg_child_server_is_alive(); k++) usleep(1000);
    assert_int_equal(vg_child_server_is_alive(), 0);
    vg_child_server_stop();
    no_child_is_left();
  }
  batch_free(a);
}

static void signals_are_left_to_the_parent(void **state)
{
  static const int number[] = { SIGINT,  SIGTERM, SIGHUP,
                                SIGQUIT, SIGUSR1, SIGUSR2 };
  pid_t pid;

  (void)state;
  assert_int_equal(vg_child_server_start(NULL), VG_OK);
  batch_free(answered(1, 50)); /* so it has started */
  pid = child_of(getpid());
  assert_true(pid > 0); /* kill would take 0 for our process group */
  for (size_t k = 0; k < sizeof number / sizeof *number; k++)
    assert_int_equal(kill(pid, number[k]), 0);
  batch_free(answered(1, 50));
  assert_int_equal(vg_child_server_is_alive(), 1);
  vg_child_server_stop();
  no_child_is_left();
}

/* A process that reads our output must not wait for the server's end. */
static void the_server_holds_no_files_open(void **state)
{
  int ends[2];
  char c;

  (void)state;
  assert_int_equal(pipe(ends), 0);
  assert_int_equal(vg_child_server_start(NULL), VG_OK);
  close(ends[1]);
  assert_int_equal(read(ends[0], &c, 1), 0);
  close(ends[0]);
  assert_int_equal(vg_child_server_is_alive(), 1);
  vg_child_server_stop();
}

/* The parent is killed; its server is reparented to us and ends by itself. */
static void it_ends_with_its_parent(void **state)
{
  int ends[2], status;
  pid_t pid, server = 0;

  (void)state;
  assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  assert_int_equal(pipe(ends), 0);
  pid = fork();
  assert_true(pid >= 0); /* kill would take -1 for all processes */
  if (pid == 0) {
    vg_child_server_start(NULL);
    server = child_of(getpid());
    if (write(ends[1], &server, sizeof server) != sizeof server) _exit(1);
    pause();
    _exit(0);
  }
  assert_int_equal(read(ends[0], &server, sizeof server), sizeof server);
  assert_true(server > 0);
  kill(pid, SIGKILL);
  assert_int_equal(waitpid(pid, &status, 0), pid);
  assert_int_equal(waitpid(server, &status, 0), server);
  assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  no_child_is_left();
  close(ends[0]);
  close(ends[1]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(the_same_as_in_place),
    cmocka_unit_test(several_threads_at_once),
    cmocka_unit_test(a_server_killed_at_any_time),
    cmocka_unit_test(signals_are_left_to_the_parent),
    cmocka_unit_test(the_server_holds_no_files_open),
    cmocka_unit_test(it_ends_with_its_parent),
  };

  struct vg_helper h;

  vg_helper_find(VG_HELPER_TETGEN, &h);
  if (!h.is_found) {
    print_message("%s: skipped\n", h.why);
    return 77;
  }
  return cmocka_run_group_tests(tests, NULL, NULL);
}
