/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Starts and stops runs as processes. Declared in cli/serve/runs.h. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "cli/common/process.h"
#include "cli/serve/runs.h"
#include "run/common/progress.h"

/* Execute the command in the child process; never returns. The portal ignores
 * SIGPIPE, and its display ignores SIGXFSZ and handles the signals that stop
 * it; the child gets the default actions, and no sockets of the portal. */
static void become(const char *dir, char *const *word, const char *output,
                   char *const *env)
{
  static const int ours[] = { SIGPIPE, SIGXFSZ, SIGINT, SIGTERM,
                              SIGHUP,  SIGUSR1, SIGCHLD };
  sigset_t none;
  int in, out;

  setsid();
  for (size_t i = 0; i < sizeof ours / sizeof *ours; i++)
    signal(ours[i], SIG_DFL);
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, NULL);
  if (chdir(dir)) _exit(127);
  in = open("/dev/null", O_RDONLY);
  out = open(output, O_WRONLY | O_CREAT | O_APPEND | O_NOFOLLOW, 0666);
  if (in < 0 || out < 0) _exit(127);
  dup2(in, STDIN_FILENO);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  close_range(3, ~0U, 0);
  for (size_t i = 0; env && env[i]; i++) putenv(env[i]);
  execvp(word[0], word);
  dprintf(STDERR_FILENO, "vanguard: cannot start %s: %s\n", word[0],
          strerror(errno));
  _exit(127);
}

pid_t vg_run_spawn(const char *dir, char *const *word, const char *output,
                   char *const *env)
{
  pid_t child;

  fflush(NULL);
  child = fork();
  if (child == 0) become(dir, word, output, env);
  return child;
}

vg_status vg_run_start(struct vg_serve_run *run, char *const *word,
                       const char *output, char *const *env,
                       enum vg_serve_state state, struct vg_error *err)
{
  pid_t child = vg_run_spawn(run->dir, word, output, env);

  run->pid = child > 0 ? child : 0;
  if (child < 0)
    return vg_fail(err, VG_ERR_IO, "cannot start another process: %s",
                   strerror(errno));
  run->is_child = 1;
  run->pid_start = vg_process_start(child);
  run->state = state;
  return VG_OK;
}

unsigned long long vg_process_start(pid_t pid)
{
  char path[64], text[1024], state;
  const char *at;
  unsigned long long start;
  int64_t whole;

  snprintf(path, sizeof path, "/proc/%ld/stat", (long)pid);
  if (!vg_file_tail(path, text, sizeof text, &whole)) return 0;
  /* After the name, which may contain blanks and parentheses: the state is the
   * third value, the start time the 22nd. */
  at = strrchr(text, ')');
  if (!at || sscanf(at + 1,
                    " %c %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s "
                    "%*s %*s %*s %*s %*s %*s %*s %llu",
                    &state, &start) != 2)
    return 0;
  return state == 'Z' || state == 'X' ? 0 : start;
}

/* --- command lines ------------------------------------------------------- */

/* Add the path of the project; of a VGRID project, its stem. */
static vg_status add_project(const struct vg_serve_runs *r,
                             const struct vg_serve_run *run, struct vg_words *w,
                             struct vg_error *err)
{
  size_t n = strlen(run->project);
  char *path;

  if (n > 4 && !strcmp(run->project + n - 4, ".d3m")) n -= 4;
  if (asprintf(&path, "%s/%.*s", r->root, (int)n, run->project) < 0)
    path = NULL;
  return vg_words_take(w, path, err);
}

static vg_status mesh_line(const struct vg_serve_runs *r,
                           const struct vg_serve_run *run, struct vg_words *w,
                           struct vg_error *err)
{
  static const char *const words[] = { "-d",         "run.deck", "-o",
                                       "mesh",       "--log",    "run.log",
                                       "--progress", "1",        "--run-dir",
                                       "kept" };
  vg_status st;

  VG_TRY(vg_words_launcher(w, r->o->launcher, run->ranks, run->cpus, err));
  VG_TRY(vg_words_add(w, r->program, err));
  VG_TRY(vg_words_add(w, "mesh", err));
  VG_TRY(vg_words_add(w, "-p", err));
  VG_TRY(add_project(r, run, w, err));
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    VG_TRY(vg_words_add(w, words[i], err));
  if (vg_run_has_kept(run)) VG_TRY(vg_words_add(w, "--resume", err));
done:
  return st;
}

static vg_status sweep_line(const struct vg_serve_runs *r,
                            const struct vg_serve_run *run, struct vg_words *w,
                            struct vg_error *err)
{
  static const char *const words[] = { "-d", "run.deck", "-o", "sweep" };
  vg_status st;

  VG_TRY(vg_words_add(w, r->program, err));
  VG_TRY(vg_words_add(w, "sweep", err));
  VG_TRY(vg_words_add(w, "-p", err));
  VG_TRY(add_project(r, run, w, err));
  for (size_t i = 0; i < sizeof words / sizeof *words; i++)
    VG_TRY(vg_words_add(w, words[i], err));
  if (r->o->launcher) {
    VG_TRY(vg_words_add(w, "--launcher", err));
    VG_TRY(vg_words_add(w, r->o->launcher, err));
  }
done:
  return st;
}

/* Rename the logs of an earlier start, so that they are not read as those of
 * this one. */
static void put_logs_aside(const struct vg_serve_run *run)
{
  char from[4096], to[4096];

  rename(vg_run_path(run, "run.log", from),
         vg_run_path(run, "run.before.log", to));
  rename(vg_run_path(run, "output.log", from),
         vg_run_path(run, "output.before.log", to));
}

static vg_status start_here(struct vg_serve_runs *r, struct vg_serve_run *run,
                            struct vg_error *err)
{
  struct vg_words w = VG_WORDS_INIT;
  vg_status st;

  VG_TRY((run->is_sweep ? sweep_line : mesh_line)(r, run, &w, err));
  st = vg_run_start(run, w.word, "output.log", NULL, VG_SERVE_RUNNING, err);
done:
  vg_words_release(&w);
  return st;
}

void vg_run_launch(struct vg_serve_runs *r, struct vg_serve_run *run)
{
  const struct vg_tell nothing = VG_TELL_INIT;
  struct vg_error err = VG_ERROR_INIT;
  vg_status st;

  put_logs_aside(run);
  run->started = time(NULL);
  run->ended = 0;
  run->exit_status = run->output_size = -1;
  run->stop_time = 0;
  run->tell = nothing;
  run->figures.is_read = 0;
  run->note[0] = 0;
  st = run->is_slurm ? vg_slurm_submit(r, run, &err) : start_here(r, run, &err);
  if (st < 0) {
    run->state = VG_SERVE_FAILED;
    snprintf(run->note, sizeof run->note, "%.250s", err.text);
  }
  if (vg_record_write(run, &err) < 0 && !*run->note)
    snprintf(run->note, sizeof run->note, "%.250s", err.text);
}

/* --- stopping ------------------------------------------------------------ */

/* mpirun forwards SIGUSR1 to its ranks; on SIGTERM it would kill them soon
 * after. */
void vg_run_stop(struct vg_serve_runs *r, struct vg_serve_run *run, int hard)
{
  struct vg_error err;
  int is_alive = run->pid > 1 && (run->is_child ||
                                  vg_process_start(run->pid) == run->pid_start);
  int with_ranks = !run->is_sweep && (run->ranks > 1 || r->o->launcher);

  if (!vg_run_is_active(run)) return;
  if (run->state == VG_SERVE_QUEUED) {
    run->state = VG_SERVE_STOPPED;
    snprintf(run->note, sizeof run->note, "removed from the queue");
  } else {
    if (run->is_slurm && *run->job) vg_slurm_stop(run, hard);
    else if (is_alive && hard) kill(-run->pid, SIGKILL);
    else if (is_alive)
      kill(run->pid, with_ranks && !run->is_slurm ? SIGUSR1 : SIGTERM);
    run->state = VG_SERVE_STOPPING;
    run->stop_time = vg_display_now();
  }
  vg_record_write(run, &err);
}
