/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* The process that runs a mesher: core/mesher/mesher_parts.h. */
#define _GNU_SOURCE
#include <assert.h>
#include <dlfcn.h>
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/child.h"
#include "base/memory.h"
#include "core/mesher/mesher_parts.h"

/* --- loading -------------------------------------------------------------- */

/* A library's own functions take precedence over ours of the same name,
 * because gmsh contains a TetGen of its own. Functions that sanitizers replace
 * must be replaced everywhere. */
void *vg_mesher_library(const char *path)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return dlopen(path, RTLD_NOW | RTLD_LOCAL);
#else
  return dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
#endif
}

typedef const struct vg_mesher *plugin(void);

static const struct vg_mesher *load_plugin(const char *path, char *why,
                                           size_t size)
{
  void *library = vg_mesher_library(path);
  const struct vg_mesher *m;
  plugin *get;

  if (!library) {
    snprintf(why, size, "it cannot be loaded: %s", dlerror());
    return NULL;
  }
  get = (plugin *)(uintptr_t)dlsym(library, VG_MESHER_SYMBOL);
  if (!get) {
    snprintf(why, size,
             "it does not export the function %s, which every "
             "mesher plug-in must define (vanguard/mesher.h)",
             VG_MESHER_SYMBOL);
    return NULL;
  }
  m = get();
  if (m && m->version == VG_MESHER_VERSION && m->fill) return m;
  if (m && m->version != VG_MESHER_VERSION)
    snprintf(why, size,
             "it was made for version %u of the plug-in interface, but "
             "this program has version %d; recompile it with this "
             "program's vanguard/mesher.h",
             (unsigned)m->version, VG_MESHER_VERSION);
  else snprintf(why, size, "its %s returns no mesher", VG_MESHER_SYMBOL);
  return NULL;
}

static const struct vg_mesher *load(const char *name, char *why, size_t size)
{
  /* Use one thread: more are no faster when other workers run at the same
   * time, and no other thread may exist when this process forks. */
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  setenv("OMP_NUM_THREADS", "1", 1);
  if (!strcmp(name, "hxt")) return vg_mesher_hxt(why, size);
  return load_plugin(name, why, size);
}

/* --- a void --------------------------------------------------------------- */

/* A limit of processor time, after which vg_child_answer_crashes ends meshers
 * that do not terminate. */
static void set_end(double seconds)
{
  struct itimerval t = { { 0, 0 }, { (time_t)seconds + 1, 0 } };

  setitimer(ITIMER_PROF, &t, NULL);
}

static int get_front(int fd, const struct vg_helper_message *job,
                     struct vg_mesher_front *f)
{
  double(*x)[3] = vg_alloc(job->n[0], sizeof *x);
  uint32_t(*face)[3] = vg_alloc(job->n[1], sizeof *face);
  double(*hole)[3] = vg_alloc(job->n[2], sizeof *hole);
  int good;

  *f = (struct vg_mesher_front){ job->n[0], job->n[1], (const double(*)[3])x,
                                 (const uint32_t(*)[3])face };
  good = x && face && hole && vg_child_get(fd, x, job->n[0] * sizeof *x) &&
         vg_child_get(fd, face, job->n[1] * sizeof *face) &&
         vg_child_get(fd, hole, job->n[2] * sizeof *hole);
  free(hole);
  return good;
}

static int put_cells(int fd, const struct vg_mesher_cells *c)
{
  const struct vg_helper_message w = { .what = VG_HELPER_CELLS,
                                       .n = { c->n_point, c->n_cell } };

  return vg_child_put(fd, &w, sizeof w) &&
         vg_child_put(fd, c->x, c->n_point * sizeof *c->x) &&
         vg_child_put(fd, c->cell, c->n_cell * sizeof *c->cell);
}

__attribute__((noreturn)) static void fill(int fd, const struct vg_mesher *m,
                                           const struct vg_helper_message *job)
{
  static const struct vg_helper_message crash = { .what = VG_HELPER_FAILED,
                                                  .option = VG_HELPER_CRASHED };
  static const struct vg_helper_message time = { .what = VG_HELPER_FAILED,
                                                 .option = VG_HELPER_TIME };
  static const struct vg_helper_message none = { .what = VG_HELPER_NONE };
  struct vg_mesher_cells cells = { 0, 0, NULL, NULL };
  struct vg_mesher_sizes sizes = { vg_child_sizes_at, NULL };
  struct vg_mesher_front front;

  vg_child_answer_crashes(fd, &crash, &time, sizeof crash);
  set_end(job->value[0]);
  if (!get_front(fd, job, &front)) _exit(1);
  sizes.user = vg_child_sizes_new(fd, fd, &front);
  if (!sizes.user) _exit(1);
  if (m->fill(&front, &sizes, &cells))
    _exit(!vg_child_put(fd, &none, sizeof none));
  _exit(!put_cells(fd, &cells)); /* process ends here, so nothing is released */
}

/* --- one process per void ------------------------------------------------- */

static void wake(int signal)
{
  (void)signal;
}

/* Returns 1 if the process has meshed its void. The process is killed if the
 * other end of the socket closes. */
static int wait_for(pid_t pid, int fd)
{
  struct pollfd p = { fd, POLLRDHUP, 0 };
  sigset_t child, open;
  int status;
  pid_t done;

  sigemptyset(&child);
  sigaddset(&child, SIGCHLD);
  sigprocmask(SIG_BLOCK, &child, &open);
  while (!(done = waitpid(pid, &status, WNOHANG)))
    if (ppoll(&p, 1, NULL, &open) > 0) {
      kill(pid, SIGKILL);
      p.fd = -1;
    }
  sigprocmask(SIG_SETMASK, &open, NULL);
  return done == pid && WIFEXITED(status) && !WEXITSTATUS(status);
}

void vg_mesher_serve(int fd)
{
  static struct vg_mesher_spec spec;
  static struct vg_mesher_hello hello;
  const struct vg_mesher *m;
  struct vg_helper_message job;
  pid_t self = getpid();

  assert(fd >= 0);
  if (!vg_child_get(fd, &spec, sizeof spec)) _exit(1);
  m = load(spec.name, hello.text, sizeof hello.text);
  hello.is_ready = m != NULL;
  if (!vg_child_put(fd, &hello, sizeof hello) || !m) _exit(1);
  signal(SIGCHLD, wake);
  while (vg_child_get(fd, &job, sizeof job)) {
    pid_t pid = fork();

    if (!pid) {
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      if (getppid() != self) _exit(1);
      signal(SIGCHLD, SIG_DFL);
      fill(fd, m, &job);
    }
    if (pid < 0 || !wait_for(pid, fd)) _exit(1);
  }
  _exit(0);
}
