/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Runs as Slurm jobs, by a copy of share/slurm/vanguard.sbatch in the folder of
 * the run. sbatch, scancel and squeue may take long, so the portal does not
 * wait for them. Declared in cli/serve/runs.h. */
#define _GNU_SOURCE
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/common/process.h"
#include "cli/serve/assets.h"
#include "cli/serve/runs.h"
#include "io/stream/stream.h"
#include "run/common/progress.h"

#define ASK_EVERY_S 3.0
#define SQUEUE_FILE "squeue.txt"
#define SQUEUE_MAX (1 << 20)

static vg_status write_script(const struct vg_serve_run *run,
                              struct vg_error *err)
{
  struct vg_output out = VG_OUTPUT_INIT;
  char path[4096];
  vg_status st;

  VG_TRY(vg_output_open(vg_run_path(run, "vanguard.sbatch", path), &out, err));
  vg_output_bytes(&out, vg_asset_vanguard_sbatch,
                  vg_asset_vanguard_sbatch_size);
  st = vg_output_commit(&out, err);
done:
  vg_output_release(&out);
  return st;
}

static vg_status sbatch_line(const struct vg_serve_run *run, struct vg_words *w,
                             struct vg_error *err)
{
  const struct {
    const char *option, *value;
  } texts[] = { { "--time", run->time }, { "--partition", run->partition } };
  const struct {
    const char *option;
    int value;
  } numbers[] = { { "--nodes", run->nodes },
                  { "--ntasks-per-node", run->ranks },
                  { "--cpus-per-task", run->cpus } };
  char *word;
  vg_status st;

  VG_TRY(vg_words_add(w, "sbatch", err));
  VG_TRY(vg_words_add(w, "--parsable", err));
  VG_TRY(vg_words_add(w, "--export=ALL", err));
  VG_TRY(vg_words_add(w, "--output=output.log", err));
  if (asprintf(&word, "--job-name=vanguard-%04d", run->id) < 0) word = NULL;
  VG_TRY(vg_words_take(w, word, err));
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    VG_TRY(vg_words_pair(w, numbers[i].option, numbers[i].value, err));
  for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
    if (!*texts[i].value) continue;
    if (asprintf(&word, "%s=%s", texts[i].option, texts[i].value) < 0)
      word = NULL;
    VG_TRY(vg_words_take(w, word, err));
  }
  st = vg_words_add(w, "vanguard.sbatch", err);
done:
  return st;
}

/* Environment variables of the script; a job runs in the folder of its run. */
static vg_status environment(const struct vg_serve_runs *r,
                             const struct vg_serve_run *run, struct vg_words *w,
                             struct vg_error *err)
{
  static const char *const fixed[] = {
    "OUT=mesh", "RUN_DIR=kept",
    "OPTIONS=--deck run.deck --log run.log --progress 1"
  };
  size_t n = strlen(run->project);
  char *word;
  vg_status st;

  if (n > 4 && !strcmp(run->project + n - 4, ".d3m")) n -= 4;
  if (asprintf(&word, "PROJECT=%s/%.*s", r->root, (int)n, run->project) < 0)
    word = NULL;
  VG_TRY(vg_words_take(w, word, err));
  if (asprintf(&word, "VANGUARD=%s", r->program) < 0) word = NULL;
  VG_TRY(vg_words_take(w, word, err));
  for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++)
    VG_TRY(vg_words_add(w, fixed[i], err));
done:
  return st;
}

vg_status vg_slurm_submit(struct vg_serve_runs *r, struct vg_serve_run *run,
                          struct vg_error *err)
{
  struct vg_words line = VG_WORDS_INIT, env = VG_WORDS_INIT;
  char path[4096];
  vg_status st;

  unlink(vg_run_path(run, "sbatch.txt", path));
  run->job[0] = 0;
  VG_TRY(write_script(run, err));
  VG_TRY(sbatch_line(run, &line, err));
  VG_TRY(environment(r, run, &env, err));
  st = vg_run_start(run, line.word, "sbatch.txt", env.word, VG_SERVE_SUBMITTED,
                    err);
done:
  vg_words_release(&line);
  vg_words_release(&env);
  return st;
}

/* Find the job number: a line of sbatch's output that is a number only, or
 * "12;cluster". */
static void find_job(char *text, char *job, size_t size)
{
  char *save = NULL;

  for (char *line = strtok_r(text, "\n", &save); line;
       line = strtok_r(NULL, "\n", &save)) {
    size_t n = strspn(line, "0123456789");

    if (n && n < size && (!line[n] || line[n] == ';'))
      snprintf(job, size, "%.*s", (int)n, line);
  }
}

void vg_slurm_submitted(struct vg_serve_run *run, int exit_status)
{
  struct vg_error err;
  char path[4096], text[1024];
  int64_t whole;
  int was_stopping = run->state == VG_SERVE_STOPPING;

  vg_file_tail(vg_run_path(run, "sbatch.txt", path), text, sizeof text, &whole);
  run->pid = 0;
  run->is_child = 0;
  run->submitted = vg_display_now();
  if (exit_status == 0) find_job(text, run->job, sizeof run->job);
  if (*run->job) {
    run->state = VG_SERVE_PENDING;
    if (was_stopping) vg_slurm_stop(run, 1), run->state = VG_SERVE_STOPPING;
  } else {
    run->state = VG_SERVE_FAILED;
    text[strcspn(text, "\n")] = 0;
    snprintf(run->note, sizeof run->note, "sbatch: %.240s",
             *text ? text : "no job number in its output");
  }
  vg_record_write(run, &err);
}

/* A pending job is cancelled; the script of a running job forwards SIGTERM as a
 * request to stop. */
void vg_slurm_stop(struct vg_serve_run *run, int hard)
{
  char *soft[] = { "scancel", "--batch", "--signal=TERM", run->job, NULL };
  char *end[] = { "scancel", run->job, NULL };
  pid_t child;

  if (run->helper) return; /* scancel is still running */
  if (run->state == VG_SERVE_PENDING) hard = 1;
  child = vg_run_spawn(run->dir, hard ? end : soft, "sbatch.txt", NULL);
  if (child > 0) run->helper = child;
}

/* --- states of jobs ------------------------------------------------------ */

/* State of a job in lines of the form "JOB STATE"; NULL: it is not listed. */
static const char *find_state(const char *data, size_t size, const char *job,
                              size_t *len)
{
  size_t n = strlen(job);

  for (const char *at = data, *end = data + size; at < end;) {
    const char *eol = memchr(at, '\n', (size_t)(end - at));

    if (!eol) eol = end;
    if ((size_t)(eol - at) > n + 1 && !strncmp(at, job, n) && at[n] == ' ') {
      *len = (size_t)(eol - at) - n - 1;
      return at + n + 1;
    }
    at = eol + 1;
  }
  return NULL;
}

static int is_word(const char *text, size_t len, const char *word)
{
  return len == strlen(word) && !strncmp(text, word, len);
}

void vg_runs_take_squeue(struct vg_serve_runs *r, const char *data, size_t size)
{
  for (size_t i = 0; i < r->n; i++) {
    struct vg_serve_run *run = r->item[i];
    struct vg_error err;
    enum vg_serve_state now;
    const char *word;
    size_t len;

    if (!run->is_slurm || !*run->job || !vg_run_is_active(run) ||
        run->submitted > r->squeue_start)
      continue;
    word = find_state(data, size, run->job, &len);
    if (!word) {
      vg_run_ended(run, -1);
      continue;
    }
    now = is_word(word, len, "RUNNING") || is_word(word, len, "COMPLETING")
          ? VG_SERVE_RUNNING
          : VG_SERVE_PENDING;
    if (run->state == now || run->state == VG_SERVE_STOPPING) continue;
    run->state = now;
    vg_record_write(run, &err);
  }
}

/* Read the output of squeue; if squeue failed, it is run again later. */
static void take_answer(struct vg_serve_runs *r)
{
  char path[4096], *text;
  int64_t whole;
  int status;
  size_t n;
  pid_t got = waitpid(r->squeue, &status, WNOHANG);

  if (!got || (got < 0 && errno == EINTR)) return;
  r->squeue = 0;
  if (got < 0 || !WIFEXITED(status) || WEXITSTATUS(status)) return;
  text = malloc(SQUEUE_MAX);
  if (!text) return;
  snprintf(path, sizeof path, "%s/" SQUEUE_FILE, r->dir);
  n = vg_file_tail(path, text, SQUEUE_MAX, &whole);
  if (whole == (int64_t)n) vg_runs_take_squeue(r, text, n);
  free(text);
}

void vg_slurm_watch(struct vg_serve_runs *r)
{
  char user[32], path[4096];
  char *line[] = { "squeue", "--noheader", "--format=%i %T", user, NULL };
  int n = 0;

  if (r->squeue) take_answer(r);
  for (size_t i = 0; i < r->n; i++)
    n += r->item[i]->is_slurm && *r->item[i]->job &&
         vg_run_is_active(r->item[i]);
  if (!n || r->squeue || vg_display_now() - r->squeue_start < ASK_EVERY_S)
    return;
  snprintf(user, sizeof user, "--user=%lu", (unsigned long)getuid());
  snprintf(path, sizeof path, "%s/" SQUEUE_FILE, r->dir);
  unlink(path);
  r->squeue_start = vg_display_now();
  r->squeue = vg_run_spawn(r->dir, line, SQUEUE_FILE, NULL);
  if (r->squeue < 0) r->squeue = 0;
}
