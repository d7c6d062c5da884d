/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Bytes over a child's socket, from either end: base/child.h. Helper programs
 * contain this file, and may use pipes instead of the socket. */
#define _GNU_SOURCE
#include <assert.h>
#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/child.h"

int vg_child_put(int fd, const void *data, size_t size)
{
  const char *at = data;

  assert(data || !size);
  while (size) {
    ssize_t n = send(fd, at, size, MSG_NOSIGNAL);

    if (n < 0 && errno == ENOTSOCK) n = write(fd, at, size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return 0;
    at += n;
    size -= (size_t)n;
  }
  return 1;
}

int vg_child_get(int fd, void *data, size_t size)
{
  char *at = data;

  assert(data || !size);
  while (size) {
    ssize_t n = read(fd, at, size);

    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return 0;
    at += n;
    size -= (size_t)n;
  }
  return 1;
}

static struct {
  int fd;
  size_t size;
  char crash[64], time[64];
} last;

static void answer(int signal)
{
  vg_child_put(last.fd, signal == SIGPROF ? last.time : last.crash, last.size);
  _exit(1);
}

void vg_child_answer_crashes(int fd, const void *crash, const void *time,
                             size_t size)
{
  static const int signals[] = { SIGSEGV, SIGBUS,  SIGFPE,
                                 SIGILL,  SIGABRT, SIGPROF };
  static char room[65536]; /* for a crash that has used up the stack */
  const stack_t stack = { .ss_sp = room, .ss_size = sizeof room };
  const size_t n = sizeof signals / sizeof *signals - !time;
  struct sigaction a;

  assert(size <= sizeof last.crash);
  last.fd = fd;
  last.size = size;
  memcpy(last.crash, crash, size);
  if (time) memcpy(last.time, time, size);
  sigaltstack(&stack, NULL);
  memset(&a, 0, sizeof a);
  a.sa_handler = answer;
  a.sa_flags = SA_ONSTACK;
  for (size_t i = 0; i < n; i++) sigaction(signals[i], &a, NULL);
}
