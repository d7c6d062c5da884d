/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Helper programs contain this file. */
#define _GNU_SOURCE
#include "base/helper/crash.h"

#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "base/child.h"
#include "base/helper/helper_format.h"

static int to = -1;

static void answer(int signal)
{
  const struct vg_helper_message m = { .what = VG_HELPER_FAILED,
                                       .option = signal == SIGPROF
                                                 ? VG_HELPER_TIME
                                                 : VG_HELPER_CRASHED };

  vg_child_put(to, &m, sizeof m);
  _exit(1);
}

void vg_helper_answer_crashes(int fd)
{
  static const int signals[] = { SIGSEGV, SIGBUS,  SIGFPE,
                                 SIGILL,  SIGABRT, SIGPROF };
  static char room[65536]; /* for a crash that has used up the stack */
  const stack_t stack = { .ss_sp = room, .ss_size = sizeof room };
  struct sigaction a;

  to = fd;
  sigaltstack(&stack, NULL);
  memset(&a, 0, sizeof a);
  a.sa_handler = answer;
  a.sa_flags = SA_ONSTACK;
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
    sigaction(signals[i], &a, NULL);
}
