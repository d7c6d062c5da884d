/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* A rank that fails, for faults.sh: `fault abort` ends the job with status 7,
 * `fault kill` dies at once, `fault stop` is silent, `fault leave` closes while
 * messages are under way, `fault jump` computes for longer than a rank may be
 * silent while its clock is set back; the other ranks wait in a collective, or
 * close too. */
#define _GNU_SOURCE
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include "base/comm.h"
#include "base/memory.h"

static int is_set_back; /* The clock of the day, after each call. */

/* Replaces that of the C library. */
int clock_gettime(clockid_t clock, struct timespec *t)
{
  int failed = (int)syscall(SYS_clock_gettime, clock, t);

  if (is_set_back && clock == CLOCK_REALTIME) t->tv_sec += 3600;
  return failed;
}

static int leave(struct vg_comm *c)
{
  int size = vg_comm_size(c);

  /* short, of the size that MPI sends eagerly, and long */
  for (int i = 0; i < 3 * size; i++) {
    const size_t n[] = { 10, 3000, 20000000 };
    struct vg_bytes b = { n[i / size], vg_calloc(n[i / size], 1) };

    if (vg_comm_post(c, i % size, i / size, &b, NULL)) return 1;
  }
  vg_comm_close(c);
  return 0;
}

int main(int argc, char **argv)
{
  struct vg_error err = VG_ERROR_INIT;
  struct vg_comm *c;
  uint64_t v = 0;
  int is_last, is_jump;

  if (argc != 2 || vg_comm_open(&c, &err)) {
    fprintf(stderr, "fault: %s\n", err.text);
    return 1;
  }
  if (!strcmp(argv[1], "leave")) return leave(c);
  is_last = vg_comm_rank(c) == vg_comm_size(c) - 1;
  is_jump = !strcmp(argv[1], "jump");
  is_set_back = is_jump && is_last;
  if ((is_jump || !strcmp(argv[1], "stop")) && vg_comm_watch(c, 3, &err))
    return 1;
  if (is_jump && is_last) sleep(8);
  if (!is_jump && is_last) {
    if (!strcmp(argv[1], "stop")) raise(SIGSTOP);
    if (!strcmp(argv[1], "abort")) vg_comm_abort(c, 7, "out of luck");
    raise(SIGKILL);
  }
  vg_comm_sum(c, 1, &v, &err);
  vg_comm_close(c);
  return 0;
}
