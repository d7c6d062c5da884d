/* SPDX-License-Identifier: LGPL-3.0-or-later */
#define _GNU_SOURCE
#include "common/serve.h"

#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

#include "base/child.h"

#define N_MAX (1ull << 31) /* of points, triangles and holes */
#define FIRST_BYTES 65536  /* of an array before any of it has arrived */
#define WATCH_US 200000    /* microseconds between checks of the other end */

/* --- the other end -------------------------------------------------------- */

/* Runs as a signal handler. */
static void look(int signal)
{
  struct pollfd p = { STDOUT_FILENO, 0, 0 };

  (void)signal;
  if (poll(&p, 1, 0) > 0 && p.revents & (POLLERR | POLLHUP)) _exit(1);
}

static void watch(void)
{
  struct sigaction a;
  struct itimerval t = { { 0, WATCH_US }, { 0, WATCH_US } };

  memset(&a, 0, sizeof a);
  a.sa_handler = look;
  a.sa_flags = SA_RESTART;
  sigaction(SIGALRM, &a, NULL);
  setitimer(ITIMER_REAL, &t, NULL);
  signal(SIGPIPE, SIG_IGN);
}

/* Faults that a sanitizer detects are crashes, too. */
__attribute__((visibility("default"))) const char *__asan_default_options(void);
const char *__asan_default_options(void)
{
  return "abort_on_error=1:detect_leaks=0";
}

static void introduce(const char *name, const char *library, const char *source)
{
  struct vg_helper_hello h;

  memset(&h, 0, sizeof h);
  memcpy(h.magic, VG_HELPER_MAGIC, sizeof h.magic);
  h.order = VG_HELPER_ORDER;
  h.format = VG_HELPER_FORMAT;
  snprintf(h.name, sizeof h.name, "%s", name);
  snprintf(h.library, sizeof h.library, "%s", library);
  snprintf(h.source, sizeof h.source, "%s", source);
  vg_serve_put_array(&h, sizeof h);
}

void vg_serve_start(int argc, char **argv, const char *name,
                    const char *library, const char *source)
{
  static const struct vg_helper_message crash = { .what = VG_HELPER_FAILED,
                                                  .option = VG_HELPER_CRASHED };
  static const struct vg_helper_message time = { .what = VG_HELPER_FAILED,
                                                 .option = VG_HELPER_TIME };
  const char *first = argc > 1 ? argv[1] : "";

  if (!strcmp(first, "--version")) {
    printf("%s with %s\nmessage format %d, source %.16s\n", name, library,
           VG_HELPER_FORMAT, source);
    exit(fflush(stdout) ? 1 : 0);
  }
  if (!strcmp(first, "--help") || (*first && strcmp(first, "--serve") != 0) ||
      isatty(STDIN_FILENO)) {
    int is_asked = !strcmp(first, "--help");

    fprintf(is_asked ? stdout : stderr,
            "%s is a helper program of Vanguard with %s. The program "
            "vanguard\nstarts it when it needs it, sends requests to its "
            "standard input and reads\nreplies from its standard output. "
            "--version shows its version.\n",
            name, library);
    exit(is_asked ? 0 : 2);
  }
  vg_child_answer_crashes(STDOUT_FILENO, &crash, &time, sizeof crash);
  watch();
  introduce(name, library, source);
}

/* --- requests ------------------------------------------------------------- */

int vg_serve_next(int fd, struct vg_helper_message *m)
{
  return vg_child_get(fd, m, sizeof *m);
}

/* Read n items of `size` bytes into a new array. */
static void *get_array(int fd, uint64_t n, size_t size)
{
  uint64_t have = 0, room = FIRST_BYTES / size + 1;
  char *all;

  if (room > n) room = n;
  all = malloc(room * size + 1);
  while (all) {
    char *more;

    if (!vg_child_get(fd, all + have * size, (room - have) * size)) break;
    if (room == n) return all;
    have = room;
    room = n / 2 > room ? 2 * room : n;
    more = realloc(all, room * size + 1);
    if (!more) break;
    all = more;
  }
  free(all);
  return NULL;
}

static int are_finite(size_t n, const double (*x)[3])
{
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++)
      if (!isfinite(x[i][k])) return 0;
  return 1;
}

static int are_in_range(const struct vg_serve_surface *s)
{
  for (size_t i = 0; i < s->n_tri; i++)
    for (int k = 0; k < 3; k++)
      if (s->tri[i][k] >= s->n_point) return 0;
  return 1;
}

int vg_serve_surface_read(int fd, const struct vg_helper_message *m,
                          struct vg_serve_surface *s)
{
  size_t n_more = m->what == VG_HELPER_CROSSINGS ? 2 : 1;

  memset(s, 0, sizeof *s);
  if (m->n[0] > N_MAX || m->n[1] > N_MAX || m->n[2] > N_MAX) return 0;
  s->n_point = m->n[0];
  s->n_tri = m->n[1];
  s->n_more = m->what == VG_HELPER_RECOVER || m->what == VG_HELPER_WRAP ||
                  m->what == VG_HELPER_UNITE
              ? 0
              : m->n[2];
  n_more *= s->n_more;
  s->x = get_array(fd, s->n_point, sizeof *s->x);
  if (s->x) s->tri = get_array(fd, s->n_tri, sizeof *s->tri);
  if (s->tri) s->more = get_array(fd, n_more, sizeof *s->more);
  if (s->more && are_finite(s->n_point, (const double(*)[3])s->x) &&
      are_finite(n_more, (const double(*)[3])s->more) && are_in_range(s))
    return 1;
  vg_serve_surface_release(s);
  return 0;
}

void vg_serve_surface_release(struct vg_serve_surface *s)
{
  free(s->x);
  free(s->tri);
  free(s->more);
  memset(s, 0, sizeof *s);
}

/* --- replies -------------------------------------------------------------- */

void vg_serve_put_array(const void *data, size_t size)
{
  if (!vg_child_put(STDOUT_FILENO, data, size)) _exit(1);
}

void vg_serve_put(uint32_t what, uint32_t option, uint64_t n0, uint64_t n1)
{
  const struct vg_helper_message m = { what, option, { n0, n1, 0 }, { 0, 0 } };

  vg_serve_put_array(&m, sizeof m);
}

void vg_serve_fail(uint32_t cause, const char *text)
{
  vg_serve_put(VG_HELPER_FAILED, cause, strlen(text), 0);
  vg_serve_put_array(text, strlen(text));
}
