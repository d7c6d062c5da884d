/* SPDX-License-Identifier: LGPL-3.0-or-later */
/* Private to cli/serve: the runs of a portal. Each has a folder with all its
 * files:
 *
 *   run.json     record with parameters and state, for the next portal
 *   run.deck     settings
 *   output.log   output of the process
 *   run.log      log (--log)
 *   mesh/        results; of a sweep: sweep/
 *   kept/        finished tasks (--run-dir)
 *
 * A run is a process in its own session, or a Slurm job. */
#ifndef VG_CLI_SERVE_RUNS_H
#define VG_CLI_SERVE_RUNS_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

#include "cli/common/process.h"
#include "cli/serve/portal.h"
#include "cli/serve/tell.h"

enum vg_serve_state {
  VG_SERVE_QUEUED,    /* in the queue of this machine */
  VG_SERVE_SUBMITTED, /* sbatch is running */
  VG_SERVE_PENDING,   /* in the queue of Slurm */
  VG_SERVE_RUNNING,
  VG_SERVE_STOPPING, /* has been asked to stop */
  VG_SERVE_STOPPED,
  VG_SERVE_DONE,
  VG_SERVE_LIMIT, /* finished with exit status 4 */
  VG_SERVE_FAILED,
  VG_SERVE_STATES
};

/* Results of a mesh, from its report. */
struct vg_serve_figures {
  int is_read, is_known; /* is_known: there is a report. */
  int is_valid;
  double cells, points;
  double angle; /* Smallest dihedral angle outside the layers, degrees;
                   NAN: unknown. */
  double seconds, memory; /* Time; peak memory of all ranks, bytes. */
};

struct vg_serve_run {
  int id;
  char *dir, *project; /* folder of the run; project, relative to the root */
  char title[84];
  int is_sweep, is_slurm;
  int ranks, nodes, cpus; /* nodes, cpus and the next line: for Slurm */
  char time[24], partition[64], job[24];
  enum vg_serve_state state;
  pid_t pid;                       /* of the process, or of sbatch; 0: none */
  unsigned long long pid_start;    /* start time, clock ticks since boot */
  int is_child;                    /* 1: child of this process (waitpid) */
  int exit_status;                 /* 128 + n: ended by signal n; -1: none */
  int64_t created, started, ended; /* seconds since 1970; 0: not yet */
  char note[VG_FAILURE_NOTE + 100];
  /* Not in the record: */
  struct vg_tell tell;
  int64_t output_size; /* size of output.log when `tell` was read */
  double stop_time;    /* time of the request, by vg_display_now */
  double submitted;
  pid_t helper; /* scancel while it is running; 0: none */
  struct vg_serve_figures figures;
};

struct vg_serve_runs {
  const struct vg_portal_options *o;
  const char *root; /* real paths */
  char *dir, *program;
  size_t n, cap;
  struct vg_serve_run **item; /* [n] owned, sorted by id */
  int last; /* Largest number of a run so far; numbers of removed runs are not
               given again by this portal. */
  pid_t squeue; /* squeue while it is running; 0: none */
  double squeue_start;
};

/* Largest numbers of runs, and of active runs, of one portal. */
enum { VG_SERVE_RUNS_MAX = 9999, VG_SERVE_ACTIVE_MAX = 200 };

/** Find the runs in r->dir. Runs that were active when the last portal closed
 * are still active, or their logs contain their exit status. */
vg_status vg_runs_open(struct vg_serve_runs *r, struct vg_error *err);
void vg_runs_release(struct vg_serve_runs *r);

/** Create a run with its folder, in the state VG_SERVE_QUEUED. VG_ERR_INPUT:
 * there are too many runs. */
vg_status vg_runs_new(struct vg_serve_runs *r, struct vg_serve_run **out,
                      struct vg_error *err);

/** The run with this id, or NULL. */
struct vg_serve_run *vg_runs_find(const struct vg_serve_runs *r, int id);

/** Remove a run that is not active, with its folder. VG_ERR_INPUT: it is
 * active; VG_ERR_IO: the folder cannot be removed, or only in part. */
vg_status vg_runs_remove(struct vg_serve_runs *r, struct vg_serve_run *run,
                         struct vg_error *err);

/** Whether the run is waiting or running; whether it can be restarted; whether
 * it has stored tasks from which it resumes. */
int vg_run_is_active(const struct vg_serve_run *run);
int vg_run_can_resume(const struct vg_serve_run *run);
int vg_run_has_kept(const struct vg_serve_run *run);

/** Name of a state, such as "running". */
const char *vg_run_state_word(enum vg_serve_state state);

/** Store the path of a file of a run in path[4096]; returns path. */
char *vg_run_path(const struct vg_serve_run *run, const char *name, char *path);

/** record.c: write and read run.json. vg_record_parse sets all members in the
 * record but not dir; *run is unchanged on failure. The message of
 * VG_ERR_FORMAT begins with `name`. */
vg_status vg_record_write(const struct vg_serve_run *run, struct vg_error *err);
vg_status vg_record_parse(const char *name, const char *data, size_t size,
                          struct vg_serve_run *run, struct vg_error *err);
vg_status vg_record_read(struct vg_serve_run *run, struct vg_error *err);

/** launch.c: start a run, or submit it to Slurm; it resumes from stored tasks
 * if there are any. On failure its state is VG_SERVE_FAILED. */
void vg_run_launch(struct vg_serve_runs *r, struct vg_serve_run *run);

/** Start a process in its own session, in the folder dir, with its output
 * appended to the file `output`. env: NULL-terminated list of "NAME=VALUE", or
 * NULL. Returns -1 if the process cannot be started. */
pid_t vg_run_spawn(const char *dir, char *const *word, const char *output,
                   char *const *env);

/** Start the process of a run in its folder by vg_run_spawn and set its state
 * to `state`. VG_ERR_IO: no process was started, and the state is unchanged. */
vg_status vg_run_start(struct vg_serve_run *run, char *const *word,
                       const char *output, char *const *env,
                       enum vg_serve_state state, struct vg_error *err);

/** Start time of a live process, from /proc; 0 if it does not exist. */
unsigned long long vg_process_start(pid_t pid);

/** Stop a run so that it can be resumed; if `hard`, kill it immediately. */
void vg_run_stop(struct vg_serve_runs *r, struct vg_serve_run *run, int hard);

/** watch.c: detect runs that have ended, read the progress of the others, and
 * start queued runs. To be called often. */
void vg_runs_watch(struct vg_serve_runs *r);

/** Set the state of a run whose process or job has ended from its exit status
 * (-1: unknown) and log. */
void vg_run_ended(struct vg_serve_run *run, int exit_status);

/** Process the output of squeue, lines of the form "JOB STATE". Runs whose job
 * is not listed have ended. */
void vg_runs_take_squeue(struct vg_serve_runs *r, const char *data,
                         size_t size);

/** slurm.c: submit the run as a job; read the output of sbatch; stop the job;
 * query the states of all jobs periodically. */
vg_status vg_slurm_submit(struct vg_serve_runs *r, struct vg_serve_run *run,
                          struct vg_error *err);
void vg_slurm_submitted(struct vg_serve_run *run, int exit_status);
void vg_slurm_stop(struct vg_serve_run *run, int hard);
void vg_slurm_watch(struct vg_serve_runs *r);

/** Read the last bytes of a file, at most size - 1, into text[size] and
 * terminate them. Returns their number, 0 if there is no file. *whole: size of
 * the file. */
size_t vg_file_tail(const char *path, char *text, size_t size, int64_t *whole);

#endif
