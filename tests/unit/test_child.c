/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Child processes that are forked from this process, without a server: they
 * outlive the thread that started them, and end with the process. */
#define _GNU_SOURCE
#include <errno.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/child.h"

/* Child bodies: one that answers, and one that never reads its socket. */

static void echo(int fd)
{
  char c;

  while (vg_child_get(fd, &c, 1) && vg_child_put(fd, &c, 1)) {
  }
  _exit(0);
}

static void compute(int fd)
{
  volatile unsigned n = 0;

  vg_child_put(fd, "", 1);
  while (1) n++;
}

static void *open_child(void *out)
{
  assert_int_equal(vg_child_open(echo, out), 0);
  return NULL;
}

static void open_in_thread(struct vg_child *c)
{
  pthread_t thread;

  assert_int_equal(pthread_create(&thread, NULL, open_child, c), 0);
  assert_int_equal(pthread_join(thread, NULL), 0);
}

static void it_outlives_the_thread(void **state)
{
  struct vg_child c[3];
  char answer = 0;

  (void)state;
  for (int k = 0; k < 3; k++) open_in_thread(&c[k]);
  for (int k = 0; k < 3; k++) {
    assert_true(c[k].pid > 0);
    assert_true(vg_child_put(c[k].fd, "x", 1));
    assert_true(vg_child_get(c[k].fd, &answer, 1));
    assert_int_equal(answer, 'x');
    vg_child_close(&c[k]);
  }
  assert_int_equal(waitpid(-1, NULL, WNOHANG), -1);
  assert_int_equal(errno, ECHILD);
}

/* The process is killed. Its child is reparented to us. */
static void it_ends_with_the_process(void **state)
{
  struct vg_child c;
  int ends[2], status;
  pid_t pid;
  char hello;

  (void)state;
  assert_int_equal(prctl(PR_SET_CHILD_SUBREAPER, 1), 0);
  assert_int_equal(pipe(ends), 0);
  pid = fork();
  assert_true(pid >= 0); /* kill would take -1 for all processes */
  if (!pid) {
    if (vg_child_open(compute, &c) || !vg_child_get(c.fd, &hello, 1)) _exit(1);
    if (write(ends[1], &c.pid, sizeof c.pid) != sizeof c.pid) _exit(1);
    pause();
    _exit(0);
  }
  assert_int_equal(read(ends[0], &c.pid, sizeof c.pid), sizeof c.pid);
  assert_true(c.pid > 0);
  kill(pid, SIGKILL);
  assert_int_equal(waitpid(pid, &status, 0), pid);
  assert_int_equal(waitpid(c.pid, &status, 0), c.pid);
  assert_true(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
  close(ends[0]);
  close(ends[1]);
}

int main(void)
{
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(it_outlives_the_thread),
    cmocka_unit_test(it_ends_with_the_process),
  };

  return cmocka_run_group_tests(tests, NULL, NULL);
}
