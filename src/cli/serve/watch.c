/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Monitors runs: their end, the queue, and their progress. Declared in
 * cli/serve/runs.h. */
#define _GNU_SOURCE
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

#include "cli/common/process.h"
#include "cli/serve/runs.h"
#include "run/common/progress.h"

/* The exit status at the end of the log of a run; -1: unknown. */
static int logged_status(const struct vg_serve_run *run)
{
  char path[4096], text[4096];
  int64_t whole;
  size_t n = vg_file_tail(vg_run_path(run, "run.log", path), text, sizeof text,
                          &whole);

  return vg_tell_status(text, n);
}

/* Set the note to the reason of the failure from the output of the run. */
static void note_failure(struct vg_serve_run *run)
{
  char path[4096], text[VG_FAILURE_NOTE];

  vg_failure_note(vg_run_path(run, "output.log", path), text, sizeof text);
  if (!strncmp(text, "see /", 5)) snprintf(text, sizeof text, "(no output)");
  if (run->exit_status > 128)
    snprintf(run->note, sizeof run->note,
             "ended by signal %d (%s); last "
             "line: %s",
             run->exit_status - 128, strsignal(run->exit_status - 128), text);
  else if (run->exit_status < 0)
    snprintf(run->note, sizeof run->note,
             "ended without an exit status: "
             "killed, or the machine failed; last line: %s",
             text);
  else snprintf(run->note, sizeof run->note, "%s", text);
}

void vg_run_ended(struct vg_serve_run *run, int exit_status)
{
  struct vg_error err;

  run->exit_status = exit_status < 0 ? logged_status(run) : exit_status;
  run->pid = 0;
  run->is_child = 0;
  run->ended = time(NULL);
  run->note[0] = 0;
  run->tell = (struct vg_tell)VG_TELL_INIT; /* The last lines are a report. */
  if (run->exit_status == VG_EXIT_DONE) {
    run->state = VG_SERVE_DONE;
  } else if (run->exit_status == VG_EXIT_LIMIT) {
    run->state = VG_SERVE_LIMIT;
    snprintf(run->note, sizeof run->note, "%s",
             run->is_sweep
               ? "equal mesh options gave different files"
               : "a limit on the layers is not met; the mesh is complete");
  } else {
    note_failure(run);
    run->state = run->state == VG_SERVE_STOPPING ||
                     !strncmp(run->note, "interrupted", 11)
                 ? VG_SERVE_STOPPED
                 : VG_SERVE_FAILED;
    if (run->state == VG_SERVE_STOPPED && !run->is_sweep)
      snprintf(run->note, sizeof run->note, "%s",
               vg_run_has_kept(run) ? "finished tasks are stored"
                                    : "no task was finished");
  }
  vg_record_write(run, &err);
}

/* Exit status, or 128 + n if ended by signal n. */
static int status_of(int wait_status)
{
  return WIFEXITED(wait_status) ? WEXITSTATUS(wait_status)
                                : 128 + WTERMSIG(wait_status);
}

/* Whether the process of the run has ended, and its exit status (-1:
 * unknown). */
static int is_gone(struct vg_serve_run *run, int *exit_status)
{
  int status;
  pid_t got;

  *exit_status = -1;
  if (!run->is_child) return vg_process_start(run->pid) != run->pid_start;
  got = waitpid(run->pid, &status, WNOHANG);
  if (got == run->pid) *exit_status = status_of(status);
  return got == run->pid || (got < 0 && errno != EINTR);
}

static void watch_process(struct vg_serve_run *run)
{
  int exit_status;

  if (run->helper && waitpid(run->helper, NULL, WNOHANG)) run->helper = 0;
  if (!run->pid || !is_gone(run, &exit_status)) return;
  if (run->is_slurm) vg_slurm_submitted(run, exit_status);
  else vg_run_ended(run, exit_status);
}

/* Read the progress of a run if its output has grown. */
static void listen_to(struct vg_serve_run *run)
{
  char path[4096], text[4096];
  int64_t whole;
  size_t n = vg_file_tail(vg_run_path(run, "output.log", path), text,
                          sizeof text, &whole);

  if (whole == run->output_size) return;
  run->output_size = whole;
  vg_tell_tail(text, n, whole > (int64_t)n, &run->tell);
}

void vg_runs_watch(struct vg_serve_runs *r)
{
  int n_here = 0;

  for (size_t i = 0; i < r->n; i++) {
    struct vg_serve_run *run = r->item[i];

    watch_process(run);
    if (!vg_run_is_active(run)) continue;
    if (run->state == VG_SERVE_RUNNING || run->state == VG_SERVE_STOPPING) {
      n_here += !run->is_slurm;
      listen_to(run);
    }
  }
  for (size_t i = 0; i < r->n && n_here < r->o->jobs; i++)
    if (r->item[i]->state == VG_SERVE_QUEUED) {
      vg_run_launch(r, r->item[i]);
      n_here++;
    }
  vg_slurm_watch(r);
}
